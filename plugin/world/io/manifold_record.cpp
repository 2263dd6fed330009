#include "world/io/manifold_record.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace pliant {

namespace {

constexpr int kVectors = 7, kScalars = 14, kIntegers = 6; // of a point; user data are the game's
constexpr std::size_t kVectorBytes = 3 * sizeof( btScalar );
constexpr std::size_t kNumbers = 3 * kVectors + kScalars;
constexpr std::size_t kPointBytes = kNumbers * sizeof( btScalar ) + kIntegers * sizeof( int );
constexpr std::size_t kImpulseBytes = 4 * sizeof( btScalar );

/// The vectors and scalars of a point in one order, as a step reads them from memory; `Point` is a btManifoldPoint, const or not.
template <class Point>
auto vectorsOf( Point& point )
{
	return std::array{ &point.m_localPointA, &point.m_localPointB, &point.m_positionWorldOnB, &point.m_positionWorldOnA,
		&point.m_normalWorldOnB, &point.m_lateralFrictionDir1, &point.m_lateralFrictionDir2 };
}

template <class Point>
auto scalarsOf( Point& point )
{
	return std::array{ &point.m_distance1, &point.m_combinedFriction, &point.m_combinedRollingFriction, &point.m_combinedSpinningFriction,
		&point.m_combinedRestitution, &point.m_appliedImpulse, &point.m_prevRHS, &point.m_appliedImpulseLateral1,
		&point.m_appliedImpulseLateral2, &point.m_contactMotion1, &point.m_contactMotion2, &point.m_contactCFM, &point.m_contactERP,
		&point.m_frictionCFM };
}

template <class Point>
auto integersOf( Point& point )
{
	return std::array{
		&point.m_partId0, &point.m_partId1, &point.m_index0, &point.m_index1, &point.m_contactPointFlags, &point.m_lifeTime };
}

template <class List>
std::byte* writeEach( std::byte* to, const List& list )
{
	for ( const auto* const number : list )
	{
		std::memcpy( to, number, sizeof( *number ) );
		to += sizeof( *number );
	}
	return to;
}

template <class List>
const std::byte* readEach( const std::byte* from, const List& list )
{
	for ( auto* const number : list )
	{
		std::memcpy( number, from, sizeof( *number ) );
		from += sizeof( *number );
	}
	return from;
}

std::byte* writePoint( std::byte* to, const btManifoldPoint& point )
{
	// A vector has a fourth number, which the next one overwrites.
	for ( const btVector3* const vector : vectorsOf( point ) )
	{
		std::memcpy( to, vector->m_floats, sizeof( vector->m_floats ) );
		to += kVectorBytes;
	}
	return writeEach( writeEach( to, scalarsOf( point ) ), integersOf( point ) );
}

const std::byte* readPoint( const std::byte* from, btManifoldPoint& point )
{
	for ( btVector3* const vector : vectorsOf( point ) )
	{
		std::memcpy( vector->m_floats, from, kVectorBytes );
		from += kVectorBytes;
	}
	return readEach( readEach( from, scalarsOf( point ) ), integersOf( point ) );
}

} // namespace

void ManifoldRecord::write( Archive& archive, const btPersistentManifold& manifold, int rank, const StepImpulses::Contact* impulses )
{
	Head head;
	head.rank = rank;
	head.count = std::int16_t( manifold.getNumContacts() );
	head.impulses = std::int16_t( impulses ? impulses->points : -1 );
	head.sum = impulses ? impulses->sum : 0.0;
	head.breakingThreshold = manifold.getContactBreakingThreshold();
	head.processingThreshold = manifold.getContactProcessingThreshold();
	const std::size_t points = std::size_t( head.count ), shown = std::size_t( std::max<int>( head.impulses, 0 ) );
	std::byte* to = archive.extend( sizeof( Head ) + points * kPointBytes + shown * kImpulseBytes );
	std::memcpy( to, &head, sizeof( Head ) );
	to += sizeof( Head );
	for ( int k = 0; k < head.count; ++k )
	{
		to = writePoint( to, manifold.getContactPoint( k ) );
	}
	for ( std::size_t k = 0; k < shown; ++k )
	{
		const StepImpulses::PointImpulse& last = impulses->last[k];
		to = writeEach( to, std::array{ &last.normal, &last.lateral1, &last.lateral2, &impulses->shown[k] } );
	}
}

void ManifoldRecord::archive( Archive& archive )
{
	archive.raw( &m_head, sizeof( Head ) );
	archive.require( m_head.rank >= 0 && m_head.count >= 0 && m_head.count <= MANIFOLD_CACHE_SIZE && m_head.impulses >= -1 &&
			m_head.impulses <= StepImpulses::kMostPoints,
		"A contact has too many points." );
	m_points = archive.isSound() ? archive.take( std::size_t( m_head.count ) * kPointBytes ) : nullptr;
	m_impulses = archive.isSound() ? archive.take( std::size_t( std::max<int>( m_head.impulses, 0 ) ) * kImpulseBytes ) : nullptr;
	for ( int k = 0; k < m_head.count && archive.isSound() && !archive.isTrusted(); ++k )
	{
		btScalar numbers[kNumbers];
		std::memcpy( numbers, m_points + std::size_t( k ) * kPointBytes, sizeof( numbers ) );
		archive.requireFinite( numbers, kNumbers );
	}
}

void ManifoldRecord::applyTo( btPersistentManifold& manifold, StepImpulses& to ) const
{
	manifold.setNumContacts( 0 ); // it has just been made
	manifold.setContactBreakingThreshold( m_head.breakingThreshold );
	manifold.setContactProcessingThreshold( m_head.processingThreshold );
	const std::byte* from = m_points;
	for ( int k = 0; k < m_head.count; ++k )
	{
		btManifoldPoint made;
		from = readPoint( from, made );
		manifold.addManifoldPoint( made );
	}
	if ( m_head.impulses >= 0 )
	{
		StepImpulses::Contact contact{ &manifold, { manifold.getBody0(), manifold.getBody1() }, m_head.sum, m_head.impulses };
		from = m_impulses;
		for ( int k = 0; k < contact.points; ++k )
		{
			StepImpulses::PointImpulse& last = contact.last[k];
			from = readEach( from, std::array{ &last.normal, &last.lateral1, &last.lateral2, &contact.shown[k] } );
		}
		to.add( contact );
	}
}

// Manifolds of another world on the same dispatcher keep their indices.
void ManifoldOrder::applyTo( btDispatcher& dispatcher )
{
	btPersistentManifold** const all = dispatcher.getInternalManifoldPointer();
	std::vector<int> places;
	for ( const Known& known : m_known )
	{
		places.push_back( known.manifold->m_index1a );
	}
	std::sort( places.begin(), places.end() );
	std::stable_sort( m_known.begin(), m_known.end(), []( const Known& a, const Known& b ) { return a.rank < b.rank; } );
	for ( std::size_t k = 0; k < m_known.size(); ++k )
	{
		all[places[k]] = m_known[k].manifold;
		m_known[k].manifold->m_index1a = places[k];
	}
}

} // namespace pliant
