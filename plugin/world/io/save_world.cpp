// Collects and writes the state of a world.

#include "world/io/world_snapshot.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace pliant {

void WorldSnapshot::Entry::archive( Archive& archive )
{
	archive( record, id, type, shape, state );
}

void archive( Archive& archive, PairContacts::Carried& carried )
{
	auto& [isNew, wasProcessed, numbering, parting, keys] = carried;
	archive( isNew, wasProcessed, numbering, parting, keys );
}

void WorldSnapshot::PairRecord::archive( Archive& archive )
{
	archive( ghost, first, second, hasAlgorithm, isSoft, contacts, children );
	if ( isSoft )
	{
		archive( soft );
	}
}

void archive( Archive& archive, SharedNodes& nodes )
{
	auto& [count, node, press, rub] = nodes;
	archive( count, node, press, rub );
}

void WorldSnapshot::AttachmentRecord::archive( Archive& archive )
{
	auto& [id, settings, firstPoint, secondPoint, rigidObject, rigidIndex, rigidPoint, lastForce, stepImpulse, stepTime,
		force] = attachment;
	archive( id, settings.compliance, settings.breakingForce, firstPoint.nodes, firstPoint.at, secondPoint.nodes, secondPoint.at,
		rigidPoint, lastForce, stepImpulse, stepTime, force, first, second, rigid );
}

void WorldSnapshot::OutsideRecord::archive( Archive& archive )
{
	archive( object, change );
}

void WorldSnapshot::Values::archive( Archive& archive )
{
	archive( serials, lengths.whole, lengths.substep, localTime, fixedStep, clock, nextAttachment, outside, asleep );
	archive.require( std::isfinite( lengths.whole ) && std::isfinite( lengths.substep ) && lengths.whole >= 0 && lengths.substep >= 0 &&
			std::isfinite( localTime ) && std::isfinite( fixedStep ) && ( lengths.whole == 0 || lengths.substep > 0 ),
		"A time of the world is not valid." );
}

void WorldSnapshot::write( Archive& archive, const SaveSettings& settings )
{
	collect( settings );
	writeTemplates( archive, settings.withTemplates );
	archive( m_entries, m_familySizes, m_cuts );
	std::uint64_t count = m_records.size();
	archive( count );
	for ( std::size_t k = 0; k < m_records.size(); ++k )
	{
		BodyRecord::write( archive, *m_live[k], m_records[k] );
	}
	archive( m_touched, m_attachments, m_frames, m_values );
	m_bodies.group.archive( archive );
	m_broadphase.archive( archive, int( m_entries.size() ) );
	archive( m_ghosts, m_pairs );
	writeManifolds( archive, settings.forComparison );
}

void WorldSnapshot::collect( const SaveSettings& settings )
{
	std::vector<const std::shared_ptr<int>*> families;
	std::vector<const std::shared_ptr<std::vector<CutTrace>>*> cuts;
	const auto indexIn = []( auto& known, const auto& pointer ) {
		const auto found = std::find_if( known.begin(), known.end(), [&]( const auto* one ) { return *one == pointer; } );
		const int index = int( found - known.begin() );
		found == known.end() ? known.push_back( &pointer ) : void();
		return index;
	};
	for ( SoftBody* const body : m_bodies.bodies() )
	{
		const SoftBody::Impl& impl = body->impl();
		BodyRecord record = BodyRecord::of( *body );
		record.isDrawn = record.isDrawn && !settings.forComparison; // not a part of its state
		const auto known = std::find_if( m_templates.begin(), m_templates.end(),
			[&impl]( const auto& each ) { return each->fingerprint() == impl.bodyTemplate->fingerprint(); } );
		record.bodyTemplate = int( known - m_templates.begin() );
		known == m_templates.end() ? m_templates.push_back( impl.bodyTemplate ) : void();
		record.family = impl.family ? indexIn( families, impl.family ) : -1;
		record.cuts = impl.cuts ? indexIn( cuts, impl.cuts ) : -1;
		m_records.push_back( std::move( record ) );
		m_live.push_back( body );
		m_touched.emplace_back().reserve( impl.touched.size() );
		for ( const ContactProxy* const proxy : impl.touched )
		{
			m_touched.back().push_back( proxy->node );
		}
	}
	for ( const auto* const family : families )
	{
		m_familySizes.push_back( **family );
	}
	for ( const auto* const list : cuts )
	{
		m_cuts.push_back( **list );
	}
	const btCollisionObjectArray& objects = m_step.m_parts.objects;
	int others = 0;
	for ( int k = 0; k < objects.size(); ++k )
	{
		Entry entry;
		if ( const SoftBody* const soft = asSoftBody( objects[k] ) )
		{
			entry.record = int( std::find( m_live.begin(), m_live.end(), soft ) - m_live.begin() );
		}
		else
		{
			entry.id = settings.idOf ? settings.idOf( *objects[k], settings.context ) : others;
			entry.type = objects[k]->getInternalType();
			entry.shape = objects[k]->getCollisionShape() ? objects[k]->getCollisionShape()->getShapeType() : -1;
			entry.state = ObjectState::of( *objects[k] );
			++others;
		}
		m_entries.push_back( entry );
	}
	collectValues();
	collectAttachments();
	collectFrames();
	m_broadphase = BroadphaseRecord::of( *m_step.m_parts.world.getBroadphase(), objects, !settings.forComparison );
	collectPairs();
}

void WorldSnapshot::writeTemplates( Archive& archive, bool areStored )
{
	std::uint64_t count = m_templates.size();
	archive( count );
	for ( const std::shared_ptr<const BodyTemplate>& each : m_templates )
	{
		std::uint64_t fingerprint = each->fingerprint();
		archive( fingerprint, areStored );
		if ( areStored )
		{
			const std::size_t part = archive.open();
			archive.write( *each );
			archive.close( part );
		}
	}
}

void WorldSnapshot::collectValues()
{
	m_values.serials = m_bodies.m_serials;
	m_values.lengths = m_step.m_lengths;
	m_values.localTime = m_step.m_parts.localTime;
	m_values.fixedStep = m_step.m_parts.fixedStep;
	m_values.clock = m_bodies.m_clock;
	m_values.nextAttachment = m_bodies.attachments.nextId();
	for ( int pass = 0; pass < 2; ++pass )
	{
		for ( const OutsideImpulse& outside : m_bodies.m_implicit[pass].carried() )
		{
			int index = -1; // the object may have been deleted since
			const auto& all = m_bodies.bodies();
			const auto owner = std::find_if( all.begin(), all.end(),
				[&outside]( const SoftBody* body ) { return body->impl().rigidProxy.get() == outside.object && outside.object; } );
			const btCollisionObject* const object = owner == all.end() ? outside.object : *owner;
			m_bodies.holds( object, index ) ? m_values.outside[pass].push_back( { index, outside.change } ) : void();
		}
	}
	for ( const SoftBody* const body : m_bodies.m_asleep )
	{
		m_values.asleep.push_back( body->impl().serial );
	}
}

void WorldSnapshot::collectAttachments()
{
	for ( const Attachment& attachment : m_bodies.attachments.all() )
	{
		m_attachments.push_back(
			{ attachment, indexOf( attachment.first.body ), indexOf( attachment.second.body ), indexOf( attachment.rigid ) } );
	}
}

void WorldSnapshot::addPair( PairRecord&& record, const PairContacts* soft, btCollisionAlgorithm* algorithm )
{
	const std::size_t before = m_manifolds.size();
	if ( soft )
	{
		record.isSoft = true;
		record.soft = soft->carried();
		for ( const NodeContact& contact : soft->contacts() )
		{
			m_manifolds.push_back( contact.manifold );
		}
	}
	else if ( algorithm )
	{
		record.children = childrenOf( *algorithm );
		btManifoldArray manifolds;
		algorithm->getAllContactManifolds( manifolds );
		for ( int k = 0; k < manifolds.size(); ++k )
		{
			m_manifolds.push_back( manifolds[k] );
		}
	}
	record.contacts = int( m_manifolds.size() - before );
	m_pairs.push_back( std::move( record ) );
}

void WorldSnapshot::collectPairs()
{
	m_ours.assign( m_bodies.pairScratch.all.begin(), m_bodies.pairScratch.all.end() );
	std::sort( m_ours.begin(), m_ours.end(),
		[]( const PairContacts* a, const PairContacts* b ) { return std::less<>()( a->algorithm, b->algorithm ); } );
	collectPairsOf( *m_step.m_parts.world.getPairCache(), -1 );
	for ( const SoftBody* const body : m_bodies.bodies() )
	{
		if ( body->impl().self && body->impl().self->contacts )
		{
			PairRecord record;
			record.first = record.second = indexOf( body );
			addPair( std::move( record ), body->impl().self->contacts.get(), nullptr );
		}
	}
	collectGhosts();
}

void WorldSnapshot::collectPairsOf( btOverlappingPairCache& cache, int ghost )
{
	for ( int k = 0; k < cache.getNumOverlappingPairs(); ++k )
	{
		const btBroadphasePair& pair = cache.getOverlappingPairArrayPtr()[k];
		PairRecord record;
		record.ghost = ghost;
		record.first = indexOf( static_cast<const btCollisionObject*>( pair.m_pProxy0->m_clientObject ) );
		record.second = indexOf( static_cast<const btCollisionObject*>( pair.m_pProxy1->m_clientObject ) );
		record.hasAlgorithm = pair.m_algorithm != nullptr;
		const auto found = std::lower_bound( m_ours.begin(), m_ours.end(), pair.m_algorithm,
			[]( const PairContacts* each, const btCollisionAlgorithm* sought ) { return std::less<>()( each->algorithm, sought ); } );
		const bool isOurs = record.hasAlgorithm && found != m_ours.end() && ( *found )->algorithm == pair.m_algorithm;
		addPair( std::move( record ), isOurs ? *found : nullptr, pair.m_algorithm );
	}
}

// The dispatcher's list has manifolds of others too, such as of another world: where states are compared, only the order of those
// that are written counts.
void WorldSnapshot::writeManifolds( Archive& archive, bool areNumbered )
{
	std::vector<int> rankAt( areNumbered ? std::size_t( m_step.m_parts.dispatcher->getNumManifolds() ) : 0, 0 );
	if ( areNumbered )
	{
		for ( const btPersistentManifold* const manifold : m_manifolds )
		{
			rankAt[std::size_t( manifold->m_index1a )] = 1;
		}
		std::exclusive_scan( rankAt.begin(), rankAt.end(), rankAt.begin(), 0 );
	}
	for ( const btPersistentManifold* const manifold : m_manifolds )
	{
		const int rank = areNumbered ? rankAt[std::size_t( manifold->m_index1a )] : manifold->m_index1a;
		ManifoldRecord::write( archive, *manifold, rank, m_step.m_impulses.find( *manifold ) );
	}
}

} // namespace pliant
