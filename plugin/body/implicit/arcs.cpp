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
	if ( !hasShape( part ) || m_soundSquare <= kArcTravel * kArcTravel * radiusSquare )
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

bool ImplicitMotion::isDrawn( int part ) const
{
	bool isAny = false;
	m_pull ? parts().forNodes( part, m_nodes->count, [&]( int i ) { isAny = isAny || gainOf( i ) > 0.0f; } ) : void();
	return isAny;
}

ImplicitMotion::Pins ImplicitMotion::pinsOf( int part ) const
{
	Pins pins;
	parts().forNodes( part, m_nodes->count, [&]( int i ) {
		const double own = m_nodes->freedom[i] == 0.0f ? 1.0 : 0.0;
		pins.middle += own * m_nodes->x.get( i ).cast<double>();
		pins.velocity += own * m_nodes->v.get( i ).cast<double>();
		pins.count += own;
	} );
	pins.middle /= pins.count;
	pins.velocity /= pins.count;
	return pins;
}

// Pins on a line let a part rotate about it, by h w. Others take it along, by the angle that they turn by themselves, exactly. What does
// not rotate with its pins bends.
std::optional<Eigen::Matrix3d> ImplicitMotion::turnedByPins( int part, const Pins& pins, const Eigen::Vector3d& turn, double h ) const
{
	const double angle = turn.norm();
	const Eigen::Vector3d axis = turn / angle;
	double along = 0.0, across = 0.0;
	parts().forNodes( part, m_nodes->count, [&]( int i ) {
		const double own = m_nodes->freedom[i] == 0.0f ? 1.0 : 0.0;
		const Eigen::Vector3d arm = m_nodes->x.get( i ).cast<double>() - pins.middle, lever = arm - arm.dot( axis ) * axis;
		const Eigen::Vector3d moved = lever + h * ( m_nodes->v.get( i ).cast<double>() - pins.velocity );
		along += own * lever.dot( moved );
		across += own * axis.cross( lever ).dot( moved );
	} );
	if ( std::hypot( along, across ) < kLeastPinnedMoment * pins.count * m_secondMoment )
	{
		return rotationBy( turn ).toRotationMatrix();
	}
	const double pinned = std::atan2( across, along );
	return std::abs( pinned - angle ) > kTurnsWithPins * angle ? std::nullopt
															   : std::optional( rotationBy( pinned * axis ).toRotationMatrix() );
}

// x += h v stretches what rotates by ( h w )^2 / 2 in each step, whatever its stiffness. With the rotation R by h w the nodes go on to
//
//   x + h v + B r,   B = R - 1 - [ h w ]x
//
// r relative to the mass centre, or to the middle of the pinned nodes, which go where their pins do.
void ImplicitMotion::bendToArcs( double h, double least )
{
	NodeState& nodes = *m_nodes;
	m_arcs.clear();
	for ( int p = 0; p < parts().count(); ++p )
	{
		if ( !isCrossedBySound( p ) || isDrawn( p ) )
		{
			continue;
		}
		const Vector6 whole = momentum( p ), motion = rigidMotion( whole, p );
		const Eigen::Vector3d turn = h * motion.tail<3>();
		if ( turn.norm() < least || !rotatesAsRigid( p, whole, motion ) )
		{
			continue;
		}
		const std::optional<Pins> pins = isHeld( p ) ? std::optional( pinsOf( p ) ) : std::nullopt;
		const std::optional<Eigen::Matrix3d> rotation = pins ? turnedByPins( p, *pins, turn, h ) : turned( whole.tail<3>(), h, p );
		if ( !rotation )
		{
			continue;
		}
		const Eigen::Matrix3d bend = *rotation - Eigen::Matrix3d::Identity() - crossMatrix( turn );
		const Eigen::Vector3d pivot = pins ? pins->middle : centre( p );
		parts().forNodes( p, nodes.count, [&]( int i ) {
			const Eigen::Vector3d x = nodes.x.get( i ).cast<double>();
			nodes.x.set( i, Eigen::Vector3d( x + double( nodes.freedom[i] ) * ( bend * ( x - pivot ) ) ).cast<float>() );
		} );
		pins ? m_arcs.push_back( Arc{ p, *rotation, pins->velocity, std::nullopt } )
			 : m_arcs.push_back( Arc{ p, *rotation, motion.head<3>(), whole.tail<3>() } );
	}
}

std::optional<Eigen::Matrix3d> ImplicitMotion::arcOf( int part ) const
{
	const auto found = std::find_if( m_arcs.begin(), m_arcs.end(), [part]( const Arc& arc ) { return arc.part == part; } );
	return found == m_arcs.end() ? std::nullopt : std::optional( found->rotation );
}

// The angular velocity about the mass centre by which a part lacks some of its spin L once its velocities have turned:
//
//   dw = I^-1 ( L - sum m r x R ( v - V ) )
Eigen::Vector3d ImplicitMotion::missingTurn( const Arc& arc, const Eigen::Vector3d& middle ) const
{
	const NodeState& nodes = *m_nodes;
	Eigen::Vector3d missing = *arc.spin;
	Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
	parts().forNodes( arc.part, nodes.count, [&]( int i ) {
		const Eigen::Vector3d arm = nodes.x.get( i ).cast<double>() - middle;
		inertia += double( nodes.mass[i] ) * ( arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose() );
		missing -= double( nodes.mass[i] ) * arm.cross( arc.rotation * ( nodes.v.get( i ).cast<double>() - arc.velocity ) );
	} );
	return flooredInverse( inertia, kInertiaFloor ) * missing;
}

// Velocities turn with the positions:
//
//   v = V + R ( v - V ) + dw x r
//
// with V of the mass centre and dw so that momentum and angular momentum of a free part stay as they were; with V of the pins' middle and
// dw = 0 for a part with pins, which take what turns its momentum.
void ImplicitMotion::turnVelocities()
{
	NodeState& nodes = *m_nodes;
	for ( const Arc& arc : m_arcs )
	{
		const double mass = m_rates.whole( arc.part ).mass;
		Eigen::Vector3d middle = Eigen::Vector3d::Zero();
		parts().forNodes(
			arc.part, nodes.count, [&]( int i ) { middle += double( nodes.mass[i] ) / mass * nodes.x.get( i ).cast<double>(); } );
		const Eigen::Vector3d added = arc.spin ? missingTurn( arc, middle ) : Eigen::Vector3d( Eigen::Vector3d::Zero() );
		parts().forNodes( arc.part, nodes.count, [&]( int i ) {
			const Eigen::Vector3d turned = arc.rotation * ( nodes.v.get( i ).cast<double>() - arc.velocity ),
								  arm = nodes.x.get( i ).cast<double>() - middle;
			if ( nodes.freedom[i] != 0.0f )
			{
				nodes.v.set( i, Eigen::Vector3d( arc.velocity + turned + added.cross( arm ) ).cast<float>() );
			}
		} );
	}
}

} // namespace pliant
