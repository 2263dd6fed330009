#pragma once

// The motions of a world's objects at the start of a game step, and the pairs of them that may meet within it.

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <vector>

namespace pliant {

struct ObjectMotion
{
	btVector3 centre, velocity, angularVelocity;

	btVector3 at( const btVector3& point ) const { return velocity + angularVelocity.cross( point - centre ); }
};

/// Of a deformable body: sums over its nodes. Objects that sleep do not move.
ObjectMotion motionOf( const btCollisionObject& object );
/// The largest velocity that an object's rotation gives to one of its points, m/s.
btScalar fastestTurn( const btCollisionObject& object, const ObjectMotion& motion );
/// An upper bound of the velocity of any point of the object, m/s.
btScalar fastest( const btCollisionObject& object, const ObjectMotion& motion );
/// Returns the object's mass, kg; infinity if nothing moves it.
btScalar massOf( const btCollisionObject& object );
/// Whether the boxes of two objects come within `reach`, m, of each other while the first moves by `displacement`.
bool comeNear( const btCollisionObject& a, const btCollisionObject& b, const btVector3& displacement, btScalar reach );

/// Appends all objects whose box in the broadphase overlaps a box.
struct OverlapsOfBox : btBroadphaseAabbCallback
{
	std::vector<btCollisionObject*> found;
	bool process( const btBroadphaseProxy* proxy ) override
	{
		found.push_back( static_cast<btCollisionObject*>( proxy->m_clientObject ) );
		return true;
	}
};

/// Calls visit( fast, other ) for every object faster than `least`, m/s, and every object in its reach within `h`, s, that is not faster.
/// `speedOf`: an object's speed, m/s; 0 for objects at rest.
template <class SpeedOf, class Visit>
void visitFastPairs( btDiscreteDynamicsWorld& world, btScalar h, btScalar least, const SpeedOf& speedOf, const Visit& visit )
{
	const btCollisionObjectArray& objects = world.getCollisionObjectArray();
	std::vector<btScalar> speeds;
	speeds.reserve( std::size_t( objects.size() ) );
	for ( int i = 0; i < objects.size(); ++i )
	{
		speeds.push_back( speedOf( *objects[i] ) );
	}
	OverlapsOfBox overlaps;
	for ( int i = 0; i < objects.size(); ++i )
	{
		const btScalar speed = speeds[std::size_t( i )];
		if ( speed <= least )
		{
			continue;
		}
		btCollisionObject& object = *objects[i];
		btVector3 low, high;
		object.getCollisionShape()->getAabb( object.getWorldTransform(), low, high );
		const btVector3 reach( speed * h, speed * h, speed * h );
		overlaps.found.clear();
		world.getBroadphase()->aabbTest( low - reach, high + reach, overlaps );
		for ( btCollisionObject* other : overlaps.found )
		{
			const int k = other->getWorldArrayIndex();
			const btScalar otherSpeed = speeds[std::size_t( k )];
			if ( other != &object && ( otherSpeed < speed || ( otherSpeed == speed && k > i ) ) )
			{
				visit( object, *other ); // else visited from the other object
			}
		}
	}
}

} // namespace pliant
