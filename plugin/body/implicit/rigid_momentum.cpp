// Momentum and rigid motions of a body's parts in an implicit substep.

#include "body/implicit/implicit_motion.h"
#include "matching/constants.h"

namespace pliant {

Matrix6 ImplicitMotion::rigidMass( int part ) const
{
	Matrix6 mass = Matrix6::Zero();
	mass.topLeftCorner<3, 3>() = m_rates.whole( part ).mass * Eigen::Matrix3d::Identity();
	// A rod has no inertia about its own axis, and nothing that could rotate about it.
	mass.bottomRightCorner<3, 3>() = m_inertias[std::size_t( part )] + kInertiaFloor * trace( part ) * Eigen::Matrix3d::Identity();
	return mass;
}

Vector6 ImplicitMotion::rigidMotion( const Vector6& momentum, int part ) const
{
	const Matrix6 mass = rigidMass( part );
	Vector6 motion;
	motion.head<3>() = momentum.head<3>() / mass( 0, 0 );
	motion.tail<3>() = Eigen::Matrix3d( mass.bottomRightCorner<3, 3>() ).inverse() * momentum.tail<3>();
	return motion;
}

Vector6 ImplicitMotion::momentum( int part ) const
{
	const NodeState& nodes = *m_nodes;
	Vector6 sum = Vector6::Zero();
	parts().forNodes( part, nodes.count, [&]( int i ) {
		const Eigen::Vector3d value = double( nodes.mass[i] ) * nodes.v.get( i ).cast<double>();
		sum.head<3>() += value;
		sum.tail<3>() += ( nodes.x.get( i ).cast<double>() - centre( part ) ).cross( value );
	} );
	return sum;
}

// Q^T b = Q^T m v*, but b contains elastic impulses that cancel in the sum only up to float rounding: v* is more accurate.
Vector6 ImplicitMotion::missingMomentum( int part ) const
{
	return m_freeMomentum[std::size_t( part )] - momentum( part );
}

void ImplicitMotion::addMotion( const Vector6& motion, int part )
{
	NodeState& nodes = *m_nodes;
	const Eigen::Vector3d shift = motion.head<3>(), turn = motion.tail<3>();
	parts().forNodes( part, nodes.count, [&]( int i ) {
		const Eigen::Vector3d position = nodes.x.get( i ).cast<double>() - centre( part );
		const Eigen::Vector3d velocity = nodes.v.get( i ).cast<double>() + double( nodes.freedom[i] ) * ( shift + turn.cross( position ) );
		nodes.v.set( i, velocity.cast<float>() );
	} );
}

void ImplicitMotion::giveMomentum( const float* impulse, float* velocity ) const
{
	const NodeState& nodes = *m_nodes;
	const int padded = nodes.padded;
	const auto armOf = [&]( int i, int part ) { return Eigen::Vector3d( nodes.x.get( i ).cast<double>() - centre( part ) ); };
	for ( int p = 0; p < parts().count(); ++p )
	{
		if ( isHeld( p ) )
		{
			continue;
		}
		Vector6 missing = Vector6::Zero();
		parts().forNodes( p, nodes.count, [&]( int i ) {
			const Eigen::Vector3d own = nodeVector( impulse, padded, i ) - double( nodes.mass[i] ) * nodeVector( velocity, padded, i );
			missing.head<3>() += own;
			missing.tail<3>() += armOf( i, p ).cross( own );
		} );
		const Vector6 motion = rigidMotion( missing, p );
		const Eigen::Vector3d shift = motion.head<3>(), turn = motion.tail<3>();
		parts().forNodes( p, nodes.count, [&]( int i ) {
			const Eigen::Vector3d sum = nodeVector( velocity, padded, i ) + shift + turn.cross( armOf( i, p ) );
			for ( int k = 0; k < 3; ++k )
			{
				velocity[k * padded + i] = float( sum[k] );
			}
		} );
	}
}

} // namespace pliant
