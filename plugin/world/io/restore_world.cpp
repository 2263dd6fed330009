// Replaces the state of a world by one that was read.

#include "world/detect/node_algorithm.h"
#include "world/io/world_snapshot.h"
#include "world/query/surface_tests.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <algorithm>

namespace pliant {

namespace {

/// Removes the points of manifolds that are removed. No contact has ended, so that the game is not notified; the data that it has stored in
/// them is returned to it.
void emptyManifolds( const btManifoldArray& manifolds )
{
	for ( int m = 0; m < manifolds.size(); ++m )
	{
		for ( int k = 0; k < manifolds[m]->getNumContacts(); ++k )
		{
			manifolds[m]->clearUserCache( manifolds[m]->getContactPoint( k ) );
		}
		manifolds[m]->setNumContacts( 0 );
	}
}

} // namespace

void WorldSnapshot::commit( RestoredWorld& report )
{
	for ( Entry& entry : m_entries )
	{
		if ( entry.object && !m_movesRigid )
		{
			const int tag = entry.state.islandTag;
			entry.state = ObjectState::of( *entry.object ); // the calls below wake objects
			entry.state.islandTag = tag;
		}
	}
	endContacts();
	removeOthers( report );
	for ( const Entry& entry : m_entries )
	{
		entry.object ? entry.state.applyTo( *entry.object ) : void();
	}
	placeBodies( report );
	endContacts(); // new bodies have found some; pairs are hashed by their ids, which may be others now
	orderObjects();
	m_broadphase.applyTo( *m_step.m_parts.world.getBroadphase(), m_step.m_parts.objects, m_step.m_parts.dispatcher );
	endContacts(); // another broadphase than btDbvtBroadphase has found pairs of its own
	restoreReferences();
	restoreFrames();
	restorePairs();
	restoreValues();
	for ( const Entry& entry : m_entries )
	{
		entry.record < 0 ? entry.state.applyTo( *entry.object ) : void();
	}
}

void WorldSnapshot::endContacts()
{
	m_step.m_stages.releasePredictiveContacts();
	m_bodies.dropPredictiveContacts();
	btCollisionObjectArray& objects = m_step.m_parts.objects;
	for ( int k = 0; k < objects.size(); ++k )
	{
		btOverlappingPairCache* const cache = cacheOf( *objects[k] );
		cache ? endPairs( *cache ) : void();
	}
	endPairs( *m_step.m_parts.world.getPairCache() );
	for ( SoftBody* const body : m_bodies.bodies() )
	{
		if ( SelfCollision* const self = body->impl().self.get(); self && self->contacts )
		{
			btManifoldArray manifolds;
			self->contacts->collectManifolds( manifolds );
			emptyManifolds( manifolds );
			self->contacts.reset();
		}
	}
	m_step.m_impulses.clear();
}

void WorldSnapshot::endPairs( btOverlappingPairCache& cache )
{
	for ( int k = cache.getNumOverlappingPairs(); k-- > 0; )
	{
		const btBroadphasePair& last = cache.getOverlappingPairArrayPtr()[k];
		btManifoldArray manifolds;
		last.m_algorithm ? last.m_algorithm->getAllContactManifolds( manifolds ) : void();
		emptyManifolds( manifolds );
		btBroadphaseProxy *const first = last.m_pProxy0, *const second = last.m_pProxy1;
		cache.removeOverlappingPair( first, second, m_step.m_parts.dispatcher );
	}
}

void WorldSnapshot::removeOthers( RestoredWorld& report )
{
	m_bodies.events.clear(); // they point to fragments
	m_bodies.attachments.events.clear();
	m_bodies.attachments.all().clear();
	const std::vector<SoftBody*> all = m_bodies.bodies();
	for ( SoftBody* const body : all )
	{
		if ( std::find( m_live.begin(), m_live.end(), body ) != m_live.end() )
		{
			continue;
		}
		if ( body->impl().isWorldOwned )
		{
			delete body;
			continue;
		}
		m_step.m_parts.world.removeCollisionObject( body );
		report.removed.push_back( body );
	}
}

void WorldSnapshot::placeBodies( RestoredWorld& report )
{
	for ( std::size_t k = 0; k < m_records.size(); ++k )
	{
		BodyRecord& record = m_records[k];
		if ( SoftBody* const live = m_live[k] )
		{
			record.applyTo( *live );
			btBroadphaseProxy& proxy = *live->getBroadphaseHandle();
			proxy.m_collisionFilterGroup = record.group;
			proxy.m_collisionFilterMask = record.mask;
		}
		else
		{
			SoftBody* const made = SoftBody::Impl::blank().release();
			record.applyTo( *made );
			m_step.addSoftBody( made, record.group, record.mask );
			made->impl().isWorldOwned = true;
			m_bodies.owned.push_back( made );
			report.created.push_back( made );
			m_live[k] = made;
		}
		m_live[k]->impl().serial = record.serial;
	}
	std::sort( m_bodies.m_bodies.begin(), m_bodies.m_bodies.end(),
		[]( const SoftBody* a, const SoftBody* b ) { return a->impl().serial < b->impl().serial; } );
	for ( Entry& entry : m_entries )
	{
		entry.object = entry.record >= 0 ? m_live[std::size_t( entry.record )] : entry.object;
	}
}

void WorldSnapshot::orderObjects()
{
	btCollisionObjectArray& objects = m_step.m_parts.objects;
	for ( int k = 0; k < objects.size(); ++k )
	{
		objects[k] = m_entries[std::size_t( k )].object;
		objects[k]->setWorldArrayIndex( k );
	}
}

/// Pins, families, cuts and attachments.
void WorldSnapshot::restoreReferences()
{
	std::vector<std::shared_ptr<int>> families;
	std::vector<std::shared_ptr<std::vector<CutTrace>>> cuts;
	std::transform( m_familySizes.begin(), m_familySizes.end(), std::back_inserter( families ),
		[]( int size ) { return std::make_shared<int>( size ); } );
	std::transform( m_cuts.begin(), m_cuts.end(), std::back_inserter( cuts ),
		[]( std::vector<CutTrace>& list ) { return std::make_shared<std::vector<CutTrace>>( std::move( list ) ); } );
	for ( std::size_t k = 0; k < m_records.size(); ++k )
	{
		const BodyRecord& record = m_records[k];
		SoftBody::Impl& impl = m_live[k]->impl();
		impl.family = record.family >= 0 ? families[std::size_t( record.family )] : nullptr;
		impl.cuts = record.cuts >= 0 ? cuts[std::size_t( record.cuts )] : nullptr;
		impl.pins.clear();
		for ( const BodyRecord::StoredPin& from : record.pins )
		{
			Pin pin{ from.node, from.kind, nullptr, -1, -1, from.point, from.hasTarget };
			if ( from.kind == PinKind::FollowsBody )
			{
				pin.body = btRigidBody::upcast( m_entries[std::size_t( from.object )].object );
				pin.bodyIndex = from.object;
				pin.bodyProxy = pin.body->getBroadphaseHandle()->getUid();
			}
			impl.pins.push_back( pin );
		}
	}
	const auto objectAt = [this]( int index ) { return index >= 0 ? m_entries[std::size_t( index )].object : nullptr; };
	for ( const AttachmentRecord& record : m_attachments )
	{
		Attachment attachment = record.attachment;
		attachment.first.body = asSoftBody( objectAt( record.first ) );
		attachment.second.body = asSoftBody( objectAt( record.second ) );
		attachment.rigid = objectAt( record.rigid );
		attachment.rigidIndex = record.rigid;
		m_bodies.attachments.all().push_back( attachment );
	}
	m_bodies.attachments.nextId() = m_values.nextAttachment;
}

void WorldSnapshot::restorePairs()
{
	for ( const Entry& entry : m_entries )
	{
		// Bullet makes no manifold for two objects that sleep. Their states follow.
		entry.record < 0 ? entry.object->forceActivationState( ACTIVE_TAG ) : void();
	}
	const ManifoldRecord* contacts = m_contacts.data();
	for ( const bool areGhosts : { false, true } )
	{
		areGhosts ? restoreGhosts() : void(); // the world's pairs have filled their lists in another order
		for ( const PairRecord& record : m_pairs )
		{
			if ( ( record.ghost >= 0 ) == areGhosts )
			{
				record.first == record.second ? restoreSelfContacts( record, contacts ) : restorePair( record, contacts );
				contacts += record.contacts;
			}
		}
	}
	m_order.applyTo( *m_step.m_parts.dispatcher );
	for ( SoftBody* const body : m_live )
	{
		orderTouched( *body );
	}
}

void WorldSnapshot::restoreSelfContacts( const PairRecord& record, const ManifoldRecord* contacts )
{
	SoftBody& soft = *asSoftBody( m_entries[std::size_t( record.first )].object );
	SelfCollision* const self = soft.impl().self.get();
	if ( self )
	{
		self->contacts = std::make_unique<PairContacts>( m_bodies.m_dispatcher, m_bodies.pool, m_bodies.pairScratch );
		self->contacts->carrySelf( record.soft, soft );
		btManifoldArray manifolds;
		self->contacts->collectManifolds( manifolds );
		fillManifolds( record, contacts, manifolds );
	}
}

// Bullet's own algorithms make their manifolds when they first process a pair, here at the saved positions of the objects; the manifolds
// are then filled with the saved contents.
void WorldSnapshot::restorePair( const PairRecord& record, const ManifoldRecord* stored )
{
	btCollisionObject *const first = m_entries[std::size_t( record.first )].object,
							 *const second = m_entries[std::size_t( record.second )].object;
	btOverlappingPairCache& cache = record.ghost >= 0 ? *cacheOf( *m_entries[std::size_t( record.ghost )].object )
													  : *m_step.m_parts.world.getPairCache();
	btBroadphasePair* const pair = cache.addOverlappingPair( first->getBroadphaseHandle(), second->getBroadphaseHandle() );
	if ( !pair || !record.hasAlgorithm )
	{
		return; // the game's filter refuses it now, or it was never processed
	}
	const WrappedPair wrapped( *first, *second );
	pair->m_algorithm = m_step.m_parts.dispatcher->findAlgorithm( &wrapped.first, &wrapped.second, nullptr, BT_CONTACT_POINT_ALGORITHMS );
	if ( !pair->m_algorithm )
	{
		return;
	}
	btManifoldArray manifolds;
	if ( record.isSoft &&
		( SurfaceTest::isSurface( wrapped.first ) || SurfaceTest::isSurface( wrapped.second ) ) ) // the dispatcher has made ours
	{
		PairContacts& contacts = static_cast<NodeAlgorithm*>( pair->m_algorithm )->contacts();
		contacts.carry( record.soft, *first, *second );
		contacts.collectManifolds( manifolds );
	}
	else if ( !record.isSoft )
	{
		makeManifolds( *pair->m_algorithm, record.children, wrapped, *m_step.m_parts.dispatcher, m_step.m_parts.world.getDispatchInfo() );
		pair->m_algorithm->getAllContactManifolds( manifolds );
	}
	fillManifolds( record, stored, manifolds );
}

void WorldSnapshot::fillManifolds( const PairRecord& record, const ManifoldRecord* contacts, const btManifoldArray& manifolds )
{
	for ( int k = 0; k < std::min( manifolds.size(), record.contacts ); ++k )
	{
		contacts[k].applyTo( *manifolds[k], m_step.m_impulses );
		m_order.add( contacts[k].rank(), *manifolds[k] );
	}
}

/// Puts the touched nodes in the order that they had.
void WorldSnapshot::orderTouched( SoftBody& body ) const
{
	SoftBody::Impl& impl = body.impl();
	const auto record = std::size_t( std::find( m_live.begin(), m_live.end(), &body ) - m_live.begin() );
	impl.wasTouched = !impl.touched.empty();
	std::vector<ContactProxy*> ordered;
	for ( const int node : m_touched[record] )
	{
		ContactProxy* const proxy = impl.hasNode( node ) ? impl.proxyOfNode[std::size_t( node )] : nullptr;
		proxy ? ordered.push_back( proxy ) : void();
	}
	if ( ordered.size() != impl.touched.size() )
	{
		return;
	}
	impl.touched = std::move( ordered );
	for ( std::size_t k = 0; k < impl.touched.size(); ++k )
	{
		impl.touched[k]->touchedIndex = int( k );
	}
}

void WorldSnapshot::restoreValues()
{
	m_bodies.m_serials = m_values.serials;
	m_bodies.m_clock = m_values.clock;
	m_step.m_lengths = m_values.lengths;
	m_step.m_parts.localTime = m_values.localTime;
	m_step.m_parts.fixedStep = m_values.fixedStep;
	m_bodies.group = m_group;
	for ( int pass = 0; pass < 2; ++pass )
	{
		std::vector<OutsideImpulse> carried;
		for ( const OutsideRecord& outside : m_values.outside[pass] )
		{
			const btCollisionObject* const object = m_entries[std::size_t( outside.object )].object;
			const SoftBody* const soft = SoftBody::upcast( object );
			const bool isRigid = soft && soft->impl().rigidProxy;
			carried.push_back( OutsideImpulse{ isRigid ? soft->impl().rigidProxy.get() : object, outside.change } );
		}
		m_bodies.m_implicit[pass].carry( std::move( carried ) );
	}
	m_bodies.m_inBlocks.addAll();
	m_bodies.m_asleep.clear();
	for ( const unsigned serial : m_values.asleep )
	{
		SoftBody* const body = serial > 0 ? m_bodies.bodyAfter( serial - 1 ) : nullptr;
		body && body->impl().serial == serial ? m_bodies.m_asleep.push_back( body ) : void();
	}
}

} // namespace pliant
