#pragma once

// Kinetic energy of soft and rigid bodies, J.

#include "pliant/soft_body.h"

#include <btBulletDynamicsCommon.h>

namespace pliant::test {

inline double energyOfMotion( const SoftBody& body )
{
	double sum = 0.0;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		sum += 0.5 * double( body.nodeMass( i ) ) * double( body.nodeVelocity( i ).length2() );
	}
	return sum;
}

/// For a movable body: mass above 0.
inline double energyOfMotion( const btRigidBody& body )
{
	const btVector3 turning = body.getWorldTransform().getBasis().transpose() * body.getAngularVelocity();
	return 0.5 * double( body.getLinearVelocity().length2() / body.getInvMass() + turning.dot( body.getLocalInertia() * turning ) );
}

} // namespace pliant::test
