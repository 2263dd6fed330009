#pragma once

#include "world/shape/contact_proxy.h"

#include "pliant/soft_body.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace pliant {

/// Returns the object of a contact, for a contact proxy its soft body.
inline btCollisionObject& ownerOf( const btCollisionObject& object )
{
	SoftBody* const owner = ownerOfContactProxy( &object );
	return owner ? static_cast<btCollisionObject&>( *owner ) : const_cast<btCollisionObject&>( object );
}

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
