#include "world/io/manifold_record.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

#include <algorithm>

namespace pliant {

namespace {

/// Visits all numbers of a point in one order; `Point` is a btManifoldPoint, const or not.
template <class Point, class Scalar, class Integer>
void forNumbers( Point& point, const Scalar& scalar, const Integer& integer )
{
	for ( auto* const vector : { &point.m_localPointA, &point.m_localPointB, &point.m_positionWorldOnA, &point.m_positionWorldOnB,
			  &point.m_normalWorldOnB, &point.m_lateralFrictionDir1, &point.m_lateralFrictionDir2 } )
	{
		for ( int k = 0; k < 3; ++k )
		{
			scalar( vector->m_floats[k] );
		}
	}
	for ( auto* const number : { &point.m_distance1, &point.m_combinedFriction, &point.m_combinedRollingFriction,
			  &point.m_combinedSpinningFriction, &point.m_combinedRestitution, &point.m_appliedImpulse, &point.m_prevRHS,
			  &point.m_appliedImpulseLateral1, &point.m_appliedImpulseLateral2, &point.m_contactMotion1, &point.m_contactMotion2,
			  &point.m_contactCFM, &point.m_contactERP, &point.m_frictionCFM } )
	{
		scalar( *number );
	}
	for ( auto* const number :
		{ &point.m_partId0, &point.m_partId1, &point.m_index0, &point.m_index1, &point.m_contactPointFlags, &point.m_lifeTime } )
	{
		integer( *number );
	}
}

} // namespace

void ManifoldRecord::Point::archive( Archive& archive )
{
	archive.raw( scalar, sizeof( scalar ) );
	archive.raw( integer, sizeof( integer ) );
	archive.requireFinite( scalar, kScalars );
}

ManifoldRecord ManifoldRecord::of( const btPersistentManifold& manifold, int rank, StepImpulses& impulses )
{
	ManifoldRecord record;
	record.rank = rank;
	record.count = manifold.getNumContacts();
	record.breakingThreshold = manifold.getContactBreakingThreshold();
	record.processingThreshold = manifold.getContactProcessingThreshold();
	for ( int k = 0; k < record.count; ++k )
	{
		btScalar* scalars = record.point[k].scalar;
		int* integers = record.point[k].integer;
		forNumbers(
			manifold.getContactPoint( k ), [&scalars]( const btScalar& from ) { *scalars++ = from; },
			[&integers]( const int& from ) { *integers++ = from; } );
	}
	if ( const StepImpulses::Contact* const contact = impulses.find( manifold ) )
	{
		record.hasImpulses = true;
		record.impulses = *contact;
	}
	return record;
}

void ManifoldRecord::applyTo( btPersistentManifold& manifold, StepImpulses& to ) const
{
	manifold.setNumContacts( 0 ); // it has just been made
	manifold.setContactBreakingThreshold( breakingThreshold );
	manifold.setContactProcessingThreshold( processingThreshold );
	for ( int k = 0; k < count; ++k )
	{
		btManifoldPoint made;
		const btScalar* scalars = point[k].scalar;
		const int* integers = point[k].integer;
		forNumbers(
			made, [&scalars]( btScalar& into ) { into = *scalars++; }, [&integers]( int& into ) { into = *integers++; } );
		manifold.addManifoldPoint( made );
	}
	if ( hasImpulses )
	{
		StepImpulses::Contact contact = impulses;
		contact.manifold = &manifold;
		contact.bodies[0] = manifold.getBody0();
		contact.bodies[1] = manifold.getBody1();
		to.add( contact );
	}
}

void ManifoldRecord::archive( Archive& archive )
{
	archive( rank, count, breakingThreshold, processingThreshold, hasImpulses );
	archive.require( rank >= 0 && count >= 0 && count <= MANIFOLD_CACHE_SIZE, "A contact has too many points." );
	for ( int k = 0; k < count && archive.isSound(); ++k )
	{
		archive( point[k] );
	}
	if ( hasImpulses )
	{
		archive( impulses );
	}
}

// Manifolds of another world on the same dispatcher keep their places.
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
