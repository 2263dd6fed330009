#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace pliant {

/// Moves the contact points of manifolds with their objects, and drops those that have separated.
inline void refreshContacts( const btManifoldArray& manifolds )
{
	for ( int k = 0; k < manifolds.size(); ++k )
	{
		btPersistentManifold& manifold = *manifolds[k];
		manifold.refreshContactPoints( manifold.getBody0()->getWorldTransform(), manifold.getBody1()->getWorldTransform() );
	}
}

} // namespace pliant
