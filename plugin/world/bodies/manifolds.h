#pragma once

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace pliant {

/// Calls visit( manifold ) for all manifolds of the dispatcher in order.
template <class Visit>
void forEachManifold( btDispatcher& dispatcher, Visit&& visit )
{
	btPersistentManifold** const all = dispatcher.getInternalManifoldPointer();
	const int count = dispatcher.getNumManifolds();
	for ( int m = 0; m < count; ++m )
	{
		visit( *all[m] );
	}
}

} // namespace pliant
