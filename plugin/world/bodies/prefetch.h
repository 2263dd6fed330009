#pragma once

// Memory prefetching. Manifolds and contact proxies take a kilobyte each and are scattered in memory; without prefetching, cache misses are
// most of the cost of a contact.

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <cstddef>

namespace pliant {

/// Bytes of a cache line.
inline constexpr std::size_t kCacheLine = 64;

/// Prefetches `size` bytes from `at` on; the address may be invalid.
inline void prefetch( const void* at, std::size_t size )
{
	const char* const from = static_cast<const char*>( at );
	for ( std::size_t k = 0; k < size; k += kCacheLine )
	{
		__builtin_prefetch( from + k );
	}
	__builtin_prefetch( from + size - 1 );
}

/// Prefetches a manifold's bodies and counts, which follow its array of points.
inline void prefetchEnd( const btPersistentManifold& manifold )
{
	constexpr std::size_t kBefore = 32; // the bodies, the number of points and the thresholds
	prefetch( reinterpret_cast<const char*>( &manifold.m_companionIdA ) - kBefore, kBefore + sizeof( int ) );
}

/// Prefetches a manifold's bodies and counts and its first point.
inline void prefetchManifold( const btPersistentManifold& manifold )
{
	prefetchEnd( manifold );
	prefetch( &manifold, sizeof( btManifoldPoint ) );
}

/// Prefetches the members of an object from its shape to its surface parameters; in a contact proxy they fill one cache line.
inline void prefetchIdentity( const btCollisionObject& object )
{
	constexpr std::size_t kToShape = 32; // from the anisotropic friction, the last accessible member before the shape
	prefetch( reinterpret_cast<const char*>( &object.getAnisotropicFriction() ) + kToShape, kCacheLine );
}

/// Writes a vector with a single store: a wide load soon after several narrow stores stalls until they have reached memory.
inline void setWhole( btVector3& to, btScalar x, btScalar y, btScalar z )
{
	using Whole = btScalar __attribute__( ( vector_size( 4 * sizeof( btScalar ) ), may_alias, aligned( sizeof( btScalar ) ) ) );
	*reinterpret_cast<Whole*>( to.m_floats ) = Whole{ x, y, z, 0 };
}
inline void setWhole( btVector3& to, const btVector3& from )
{
	setWhole( to, from.x(), from.y(), from.z() );
}

/// Calls visit( manifold ) for all manifolds of the dispatcher in order; fetch( manifold ) prefetches the data that `visit` reads.
template <class Fetch, class Visit>
void forEachManifold( btDispatcher& dispatcher, const Fetch& fetch, Visit&& visit )
{
	constexpr int kManifolds = 12, kBodies = 6; // prefetched so many iterations ahead
	btPersistentManifold** const all = dispatcher.getInternalManifoldPointer();
	const int count = dispatcher.getNumManifolds();
	for ( int m = 0; m < count; ++m )
	{
		if ( m + kManifolds < count )
		{
			fetch( *all[m + kManifolds] );
		}
		if ( m + kBodies < count )
		{
			prefetchIdentity( *all[m + kBodies]->getBody0() );
			prefetchIdentity( *all[m + kBodies]->getBody1() );
		}
		visit( *all[m] );
	}
}

} // namespace pliant
