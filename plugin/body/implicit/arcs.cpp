// The motion of rotating parts along arcs instead of tangents.

#include "body/constants.h"
#include "body/free_rotation.h"
#include "body/implicit/implicit_motion.h"
#include "matching/constants.h"
#include "matching/regions/region_moments.h"
#include "matching/rotation.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace pliant {

// Where sound crosses a part several times within the step its elasticity turns the velocities within it, and the centrifugal force
// stretches it by a fraction of what the tangents would. With s the distance that sound travels, r the root of the mean square radius and q
// that of the distances of its material from the middle plane across the thinnest direction, d^2 / 12 of them within cells of size d:
//
//   s > n r along it,   s q > r^2 as it bends
bool ImplicitMotion::isCrossedBySound( int part ) const
{
	const double mass = m_rates.whole( part ).mass, radiusSquare = 0.5 * trace( part ) / mass;
	if ( isHeld( part ) || !hasShape( part ) || m_soundSquare <= kArcTravel * kArcTravel * radiusSquare )
	{
		return false;
	}
	const Eigen::Matrix3d second = radiusSquare * Eigen::Matrix3d::Identity() - m_inertias[std::size_t( part )] / mass;
	const double thinnest =
		Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>().computeDirect( second, Eigen::EigenvaluesOnly ).eigenvalues()[0];
	return m_soundSquare * ( thinnest + m_cellMoment ) > radiusSquare * radiusSquare;
}

// What bends in flight rotates otherwise in every part of it.
bool ImplicitMotion::rotatesAsRigid( int part, const Vector6& momentum, const Vector6& motion ) const
{
	double square = 0.0;
	parts().forNodes( part, m_nodes->count,
		[&]( int i ) { square += double( m_nodes->mass[i] ) * ( m_nodes->v.get( i ).cast<double>() - motion.head<3>() ).squaredNorm(); } );
	return momentum.tail<3>().dot( motion.tail<3>() ) > kRotatesAsRigid * square;
}

/// The rotation of a free part in a step of h, s, with the angular momentum `spin`.
Eigen::Matrix3d ImplicitMotion::turned( const Eigen::Vector3d& spin, double h, int part ) const
{
	const Eigen::Matrix3d inertia = rigidMass( part ).bottomRightCorner<3, 3>();
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( inertia );
	Eigen::Matrix3d axes = solver.eigenvectors();
	axes.col( 0 ) *= axes.determinant() < 0.0 ? -1.0 : 1.0;
	return freeRotation( solver.eigenvalues(), Eigen::Quaterniond( axes ), spin, h ).toRotationMatrix();
}

// x += h v stretches what rotates by ( h w )^2 / 2 in each step, whatever its stiffness. With the rotation R by h w the nodes go on to
//
//   x + h v + B r,   B = R - 1 - [ h w ]x
//
// r relative to the mass centre.
void ImplicitMotion::bendToArcs( double h )
{
	NodeState& nodes = *m_nodes;
	m_arcs.clear();
	for ( int p = 0; p < parts().count(); ++p )
	{
		if ( !isCrossedBySound( p ) )
		{
			continue;
		}
		const Vector6 whole = momentum( p ), motion = rigidMotion( whole, p );
		const Eigen::Vector3d turn = h * motion.tail<3>();
		if ( turn.norm() < kLeastArc || !rotatesAsRigid( p, whole, motion ) )
		{
			continue;
		}
		const Eigen::Matrix3d rotation = turned( whole.tail<3>(), h, p );
		const Eigen::Matrix3d bend = rotation - Eigen::Matrix3d::Identity() - crossMatrix( turn );
		parts().forNodes( p, nodes.count, [&]( int i ) {
			const Eigen::Vector3d x = nodes.x.get( i ).cast<double>();
			nodes.x.set( i, Eigen::Vector3d( x + bend * ( x - centre( p ) ) ).cast<float>() );
		} );
		m_arcs.push_back( Arc{ p, rotation, motion.head<3>(), whole.tail<3>() } );
	}
}

std::optional<Eigen::Matrix3d> ImplicitMotion::arcOf( int part ) const
{
	const auto found = std::find_if( m_arcs.begin(), m_arcs.end(), [part]( const Arc& arc ) { return arc.part == part; } );
	return found == m_arcs.end() ? std::nullopt : std::optional( found->rotation );
}

// Velocities turn with the positions:
//
//   v = V + R ( v - V ) + dw x r,   dw = I^-1 ( L - sum m r x R ( v - V ) )
//
// so that momentum and angular momentum L stay as they were.
void ImplicitMotion::turnVelocities()
{
	NodeState& nodes = *m_nodes;
	for ( const Arc& arc : m_arcs )
	{
		const double mass = m_rates.whole( arc.part ).mass;
		Eigen::Vector3d middle = Eigen::Vector3d::Zero(), missing = arc.spin;
		parts().forNodes(
			arc.part, nodes.count, [&]( int i ) { middle += double( nodes.mass[i] ) / mass * nodes.x.get( i ).cast<double>(); } );
		const auto armOf = [&]( int i ) { return Eigen::Vector3d( nodes.x.get( i ).cast<double>() - middle ); };
		const auto turnedVelocity = [&]( int i ) {
			return Eigen::Vector3d( arc.rotation * ( nodes.v.get( i ).cast<double>() - arc.velocity ) );
		};
		Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
		parts().forNodes( arc.part, nodes.count, [&]( int i ) {
			const Eigen::Vector3d arm = armOf( i );
			inertia += double( nodes.mass[i] ) * ( arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose() );
			missing -= double( nodes.mass[i] ) * arm.cross( turnedVelocity( i ) );
		} );
		const Eigen::Vector3d added = flooredInverse( inertia, kInertiaFloor ) * missing;
		parts().forNodes( arc.part, nodes.count, [&]( int i ) {
			nodes.v.set( i, Eigen::Vector3d( arc.velocity + turnedVelocity( i ) + added.cross( armOf( i ) ) ).cast<float>() );
		} );
	}
}

} // namespace pliant
