#pragma once

// Momentum and angular momentum of soft and rigid bodies, N s and N m s, about the world's origin.

#include "pliant/soft_body.h"

#include <btBulletDynamicsCommon.h>

namespace pliant::test {

struct Momentum
{
	btVector3 linear = btVector3( 0, 0, 0 ), angular = btVector3( 0, 0, 0 );

	Momentum& operator+=( const Momentum& other )
	{
		linear += other.linear;
		angular += other.angular;
		return *this;
	}
};

inline Momentum momentumOf( const SoftBody& body )
{
	const btVector3 linear = body.linearVelocity() * body.mass();
	return Momentum{ linear, body.massCentre().cross( linear ) + body.angularMomentum() };
}

/// For a movable body: mass above 0.
inline Momentum momentumOf( const btRigidBody& body )
{
	const btVector3 linear = body.getLinearVelocity() / body.getInvMass();
	return Momentum{
		linear, body.getCenterOfMassPosition().cross( linear ) + body.getInvInertiaTensorWorld().inverse() * body.getAngularVelocity() };
}

} // namespace pliant::test
