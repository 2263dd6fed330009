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

/// Of a deformable body: sums over its nodes; of a multibody's link: from its joints. Objects that sleep do not move.
ObjectMotion motionOf( const btCollisionObject& object );
/// The largest velocity that an object's rotation gives to one of its points, m/s.
btScalar fastestTurn( const btCollisionObject& object, const ObjectMotion& motion );
/// An upper bound of the velocity of any point of the object, m/s.
btScalar fastest( const btCollisionObject& object, const ObjectMotion& motion );
/// Returns the object's mass, kg, of a contact proxy that of its soft body; infinity if nothing moves it.
btScalar massOf( const btCollisionObject& object );
/// The pairs of objects that may meet. Keeps its scratch between calls: after warm-up a search allocates nothing.
class FastPairs
{
public:
	/// Calls visit( fast, other ) for every object faster than `least`, m/s, and every object in its reach within `h`, s, that is not
	/// faster. `speedOf`: an object's speed, m/s; 0 for objects at rest.
	template <class SpeedOf, class Visit>
	void visit( btDiscreteDynamicsWorld& world, btScalar h, btScalar least, const SpeedOf& speedOf, const Visit& visit )
	{
		const btCollisionObjectArray& objects = world.getCollisionObjectArray();
		m_speeds.clear();
		for ( int i = 0; i < objects.size(); ++i )
		{
			m_speeds.push_back( speedOf( *objects[i] ) );
		}
		for ( int i = 0; i < objects.size(); ++i )
		{
			const btScalar speed = m_speeds[std::size_t( i )];
			if ( speed <= least )
			{
				continue;
			}
			btCollisionObject& object = *objects[i];
			btVector3 low, high;
			object.getCollisionShape()->getAabb( object.getWorldTransform(), low, high );
			const btVector3 reach( speed * h, speed * h, speed * h );
			m_overlaps.found.clear();
			world.getBroadphase()->aabbTest( low - reach, high + reach, m_overlaps );
			for ( btCollisionObject* other : m_overlaps.found )
			{
				const int k = other->getWorldArrayIndex();
				const btScalar otherSpeed = m_speeds[std::size_t( k )];
				if ( other != &object && ( otherSpeed < speed || ( otherSpeed == speed && k > i ) ) )
				{
					visit( object, *other ); // else visited from the other object
				}
			}
		}
	}

private:
	struct Overlaps : btBroadphaseAabbCallback
	{
		std::vector<btCollisionObject*> found;
		bool process( const btBroadphaseProxy* proxy ) override
		{
			found.push_back( static_cast<btCollisionObject*>( proxy->m_clientObject ) );
			return true;
		}
	};

	std::vector<btScalar> m_speeds; ///< m/s, by object index in the world
	Overlaps m_overlaps;
};

} // namespace pliant
