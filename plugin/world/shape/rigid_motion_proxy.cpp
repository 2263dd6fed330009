#include "world/shape/rigid_motion_proxy.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace pliant {

RigidMotionProxy::RigidMotionProxy( btCollisionObject* object )
{
	soft = asSoftBody( object );
	rigid = soft ? nullptr : btRigidBody::upcast( object );
	if ( soft )
	{
		measure();
	}
	else if ( rigid && ( !rigid->isStaticObject() || rigid->isKinematicObject() ) )
	{
		angularVelocity = toVec3d( rigid->getAngularVelocity() );
		inverseInertia = rigid->isKinematicObject() ? Eigen::Matrix3d( Eigen::Matrix3d::Zero() )
													: toMatrix3d( rigid->getInvInertiaTensorWorld() );
	}
}

// Held and sleeping bodies do not rotate rigidly.
void RigidMotionProxy::measure()
{
	const NodeState& nodes = soft->impl().body->nodes();
	const BodySums sums = soft->impl().body->sums();
	const auto freedoms = nodes.freedom.begin();
	if ( !soft->isActive() || !soft->isHealthy() || std::find( freedoms, freedoms + nodes.count, 0.0f ) != freedoms + nodes.count )
	{
		return;
	}
	Vec3d moments = Vec3d::Zero(), products = Vec3d::Zero(); // about x, y, z; of y z, z x, x y
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d p = nodes.x.get( i ).cast<double>() - sums.centre;
		const double mass = double( nodes.mass[i] ), square = p.squaredNorm();
		for ( int k = 0; k < 3; ++k )
		{
			moments[k] += mass * ( square - p[k] * p[k] );
			products[k] += mass * ( p[( k + 1 ) % 3] * p[( k + 2 ) % 3] );
		}
	}
	Eigen::Matrix3d inertia;
	inertia << moments[0], -products[2], -products[1], -products[2], moments[1], -products[0], -products[1], -products[0], moments[2];
	// Collinear nodes have no inertia about their line, and nearly collinear ones too little: their cells would add sum m d^2 / 6.
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes( inertia );
	const double cell = soft->impl().body->lattice().cellSize, thin = kRollingInertia * sums.mass * cell * cell / 6.0;
	Vec3d inverses = Vec3d::Zero();
	for ( int k = 0; k < 3; ++k )
	{
		const double moment = axes.eigenvalues()[k];
		inverses[k] = moment > thin ? 1.0 / moment : 0.0;
	}
	inverseInertia = axes.eigenvectors() * inverses.asDiagonal() * axes.eigenvectors().transpose();
	angularVelocity = inverseInertia * sums.spin;
	centre = sums.centre;
}

void RigidMotionProxy::turn( const Vec3d& impulse )
{
	const Vec3d change = inverseInertia * impulse;
	angularVelocity += change;
	if ( rigid && !inverseInertia.isZero( 0.0 ) )
	{
		rigid->setAngularVelocity( rigid->getAngularVelocity() + toBt( change ) * rigid->getAngularFactor() );
	}
	if ( soft && !inverseInertia.isZero( 0.0 ) )
	{
		NodeState& nodes = soft->impl().body->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3d p = nodes.x.get( i ).cast<double>() - centre;
			nodes.v.set( i, nodes.v.get( i ) + change.cross( p ).cast<float>() );
		}
	}
}

bool areSolved( const btCollisionObject& first, const btCollisionObject& second )
{
	return ( first.isActive() || second.isActive() ) && first.hasContactResponse() && second.hasContactResponse();
}

} // namespace pliant
