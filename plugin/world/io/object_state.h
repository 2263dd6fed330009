#pragma once

// Bullet's part of an object's state: motion, sleep, and the properties of contact.

#include "archive/archive.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btTransform.h>

#include <cstring>

namespace pliant {

/// Whether an object of a polymorphic class of Bullet's is of exactly the class of `known`: by the tables of their virtual functions, since
/// Bullet may be built without run-time type information.
template <class Base, class Known>
bool isSameClass( const Base& object, const Known& known )
{
	return std::memcmp( static_cast<const void*>( &object ), static_cast<const void*>( &known ), sizeof( void* ) ) == 0;
}

void archive( Archive& archive, btVector3& vector );
void archive( Archive& archive, btTransform& transform );

/// The data of an object that a step changes. Of a link of a multibody, transforms and velocities keep their values.
struct ObjectState
{
	btTransform transform = btTransform::getIdentity(), interpolation = btTransform::getIdentity();
	btVector3 linear = btVector3( 0, 0, 0 ), angular = btVector3( 0, 0, 0 );
	btVector3 interpolationLinear = btVector3( 0, 0, 0 ), interpolationAngular = btVector3( 0, 0, 0 );
	btVector3 force = btVector3( 0, 0, 0 ), torque = btVector3( 0, 0, 0 ); ///< N, N m, as Bullet sums them
	int activation = ACTIVE_TAG, islandTag = -1;
	btScalar deactivationTime = btScalar( 0 );

	static ObjectState of( const btCollisionObject& object );
	void applyTo( btCollisionObject& object ) const;
	/// Only the island, which a game cannot set.
	void applyTag( btCollisionObject& object ) const { object.setIslandTag( islandTag ); }
	void archive( Archive& archive );
};

/// Settings of a soft body as of any collision object.
struct ObjectSettings
{
	int flags = 0, frictionMode = 0, userIndex[3] = {};
	btVector3 anisotropicFriction = btVector3( 1, 1, 1 );
	btScalar friction = 0, restitution = 0, rolling = 0, spinning = 0, stiffness = 0, damping = 0, threshold = 0, hitFraction = 1,
			 ccdRadius = 0, ccdThreshold = 0;

	static ObjectSettings of( const btCollisionObject& object );
	void applyTo( btCollisionObject& object ) const;
	void archive( Archive& archive );
};

} // namespace pliant
