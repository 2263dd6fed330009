// Bullet's predictive contacts with soft bodies.

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

// Bullet's predictive contacts refer to the soft body itself, which its solver takes for static. The nearest node's proxy replaces it.
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
			if ( soft->impl().rigidProxy )
			{
				continue; // showRigidProxies
			}
			btManifoldPoint& point = manifold->getContactPoint( 0 );
			const btVector3 at = side == 0 ? point.getPositionWorldOnA() : point.getPositionWorldOnB();
			ContactProxy* const proxy = pool.acquire( *soft, soft->nearestNode( at ) );
			m_predictive.push_back( proxy );
			// Bullet uses the centre of the fast body as the contact point on it. The impulse acts at the node: every body that it rotates
			// must have the same lever arm, or angular momentum is lost. The position before MovedContacts::moveToNodes:
			const btScalar outward = soft->nodeRadius( proxy->node ) + point.m_distance1;
			if ( side == 0 )
			{
				manifold->setBodies( proxy, manifold->getBody1() );
				point.m_localPointA = proxy->getWorldTransform().invXform( at );
				point.m_positionWorldOnB = proxy->written - outward * point.m_normalWorldOnB;
			}
			else
			{
				manifold->setBodies( manifold->getBody0(), proxy );
				point.m_localPointB = proxy->getWorldTransform().invXform( at );
				point.m_positionWorldOnA = proxy->written + outward * point.m_normalWorldOnB;
			}
		}
	}
}

} // namespace pliant
