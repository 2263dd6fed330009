#pragma once

// Memory asked for before its turn. A heap's manifolds and stand-ins are a kilobyte each and lie anywhere: waiting for them was most of
// what a contact cost.

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <cstddef>

namespace pliant {

/// Bytes that the processor fetches at once.
inline constexpr std::size_t kFetched = 64;

/// `size` bytes from `at` on: what is asked for need not be there.
inline void prefetch( const void* at, std::size_t size )
{
	const char* const from = static_cast<const char*>( at );
	for ( std::size_t k = 0; k < size; k += kFetched )
	{
		__builtin_prefetch( from + k );
	}
	__builtin_prefetch( from + size - 1 );
}

/// A manifold's bodies and counts, which lie behind the room for its points.
inline void prefetchEnd( const btPersistentManifold& manifold )
{
	constexpr std::size_t kBefore = 32; // the bodies, the number of points and the thresholds
	prefetch( reinterpret_cast<const char*>( &manifold.m_companionIdA ) - kBefore, kBefore + sizeof( int ) );
}

/// The same, and its first point.
inline void prefetchManifold( const btPersistentManifold& manifold )
{
	prefetchEnd( manifold );
	prefetch( &manifold, sizeof( btManifoldPoint ) );
}

/// Who an object is: from its shape, by its flags and island, to its surface. Of a stand-in that is a line.
inline void askWho( const btCollisionObject& object )
{
	constexpr std::size_t kToShape = 32; // from how it slips by direction, the last before it that has an address
	prefetch( reinterpret_cast<const char*>( &object.getAnisotropicFriction() ) + kToShape, kFetched );
}

/// And how it slips by direction, and of what type it is.
inline void prefetchAll( const btCollisionObject& object )
{
	prefetch( &object.getAnisotropicFriction(), 2 * kFetched - 2 * sizeof( btScalar ) );
}

/// Written at once: what is written in parts and soon read as a whole is waited for until it, and all that was written before, has reached
/// memory.
inline void setWhole( btVector3& to, btScalar x, btScalar y, btScalar z )
{
	using Whole = btScalar __attribute__( ( vector_size( 4 * sizeof( btScalar ) ), may_alias, aligned( sizeof( btScalar ) ) ) );
	*reinterpret_cast<Whole*>( to.m_floats ) = Whole{ x, y, z, 0 };
}
inline void setWhole( btVector3& to, const btVector3& from )
{
	setWhole( to, from.x(), from.y(), from.z() );
}

/// visit( manifold ) for all that the dispatcher has, in its order. `ask( manifold )`: for what of it is read.
template <class Ask, class Visit>
void forEachManifold( btDispatcher& dispatcher, const Ask& ask, Visit&& visit )
{
	constexpr int kManifolds = 12, kBodies = 6; // asked for so many turns ahead
	btPersistentManifold** const all = dispatcher.getInternalManifoldPointer();
	const int count = dispatcher.getNumManifolds();
	for ( int m = 0; m < count; ++m )
	{
		if ( m + kManifolds < count )
		{
			ask( *all[m + kManifolds] );
		}
		if ( m + kBodies < count )
		{
			askWho( *all[m + kBodies]->getBody0() );
			askWho( *all[m + kBodies]->getBody1() );
		}
		visit( *all[m] );
	}
}

} // namespace pliant
