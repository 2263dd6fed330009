// Bullet's predictive contacts, where they name a soft body.

#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

namespace pliant {

void SoftBodySystem::dropPredictiveContacts()
{
	for ( ContactProxy* body : m_predictive )
	{
		pool.release( body );
	}
	m_predictive.clear();
}

// Bullet's predictive contacts of fast rigid bodies name the soft body itself, which its solver takes for a wall. The nearest node's
// stand-in takes its place.
void SoftBodySystem::holdPredictiveContacts( btAlignedObjectArray<btPersistentManifold*>& manifolds )
{
	for ( int m = 0; m < manifolds.size(); ++m )
	{
		btPersistentManifold* const manifold = manifolds[m];
		for ( int side = 0; side < 2; ++side )
		{
			const btCollisionObject* const object = side == 0 ? manifold->getBody0() : manifold->getBody1();
			SoftBody* const soft = asSoftBody( const_cast<btCollisionObject*>( object ) );
			if ( !soft || manifold->getNumContacts() == 0 )
			{
				continue;
			}
			btManifoldPoint& point = manifold->getContactPoint( 0 );
			const btVector3 at = side == 0 ? point.getPositionWorldOnA() : point.getPositionWorldOnB();
			ContactProxy* const stand = pool.acquire( *soft, soft->nearestNode( at ) );
			m_predictive.push_back( stand );
			// Bullet takes the bullet's centre for the point where it is hit. The impulse acts at the node: what is turned by it must see
			// the same lever, or spin is lost. Where that is before MovedContacts::moveToNodes:
			const btScalar outward = soft->nodeRadius( stand->node ) + point.m_distance1;
			if ( side == 0 )
			{
				manifold->setBodies( stand, manifold->getBody1() );
				point.m_localPointA = stand->getWorldTransform().invXform( at );
				point.m_positionWorldOnB = stand->written - outward * point.m_normalWorldOnB;
			}
			else
			{
				manifold->setBodies( manifold->getBody0(), stand );
				point.m_localPointB = stand->getWorldTransform().invXform( at );
				point.m_positionWorldOnA = stand->written + outward * point.m_normalWorldOnB;
			}
		}
	}
}

} // namespace pliant
