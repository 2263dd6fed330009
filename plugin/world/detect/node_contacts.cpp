#include "world/detect/node_contacts.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/search/contact_points.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <algorithm>

namespace pliant {

namespace {

/// Notes whether a sleeping body is touched by an object that keeps its island awake.
void noteHit( SoftBody& body, const btCollisionObject& other )
{
	const int state = other.getActivationState();
	const bool isAwake = !other.isStaticOrKinematicObject() && ( state == ACTIVE_TAG || state == DISABLE_DEACTIVATION );
	body.impl().isHit = body.impl().isHit ||
		( isAwake && body.getActivationState() == ISLAND_SLEEPING && body.hasContactResponse() && other.hasContactResponse() );
}

/// Above the key of any contact.
constexpr std::uint64_t kAllKeys = ~std::uint64_t( 0 );

constexpr std::size_t kNotListed = ~std::size_t( 0 );

/// The soft body itself only: Bullet handles contact proxies that meet a compound, and bodies in their rigid state.
SoftBody* softOf( const btCollisionObjectWrapper* wrapper )
{
	SoftBody* const soft = asSoftBody( const_cast<btCollisionObject*>( wrapper->getCollisionObject() ) );
	return soft && !soft->impl().rigidProxy ? soft : nullptr;
}

} // namespace

PairContacts::PairContacts( btDispatcher& dispatcher, ContactProxyPool& pool, PairScratch& scratch ) :
	m_dispatcher( dispatcher ), m_pool( pool ), m_scratch( scratch ), m_position( kNotListed )
{}

// Not in the constructor, which several threads may call at a time.
void PairContacts::enlist()
{
	if ( m_position == kNotListed )
	{
		m_position = m_scratch.all.size();
		m_scratch.all.push_back( this );
	}
}

PairContacts::~PairContacts()
{
	if ( m_position != kNotListed )
	{
		m_scratch.all[m_position] = m_scratch.all.back();
		m_scratch.all[m_position]->m_position = m_position;
		m_scratch.all.pop_back();
	}
	if ( m_postponed[0] )
	{
		std::replace( m_scratch.postponed.begin(), m_scratch.postponed.end(), this, static_cast<PairContacts*>( nullptr ) );
	}
	if ( m_scratch.matching == this ) // a callback of the game has removed one of the two
	{
		m_scratch.matching = nullptr;
		m_contacts.erase( m_contacts.begin(), m_contacts.begin() + std::ptrdiff_t( m_scratch.old ) );
		m_contacts.insert( m_contacts.end(), m_scratch.contacts.begin(), m_scratch.contacts.end() );
		m_scratch.contacts.clear();
	}
	for ( const NodeContact& contact : m_contacts )
	{
		// Objects that the pair supported fall now and are woken: Bullet does not check sleeping bodies when a floor is removed.
		if ( contact.manifold->getNumContacts() > 0 )
		{
			wakeBoth( contact );
		}
		drop( contact );
	}
}

void PairContacts::wakeBoth( const NodeContact& contact ) const
{
	for ( const btCollisionObject* object : { contact.manifold->getBody0(), contact.manifold->getBody1() } )
	{
		SoftBody* const owner = ownerOfContactProxy( object );
		const_cast<btCollisionObject*>( owner ? owner : object )->activate();
	}
}

// Releases manifolds before the bodies they refer to. A callback of the game may destroy this pair meanwhile.
void PairContacts::drop( const NodeContact& contact )
{
	ContactProxyPool& pool = m_pool;
	ContactProxy *const first = contact.first, *const second = contact.second;
	m_dispatcher.releaseManifold( contact.manifold );
	pool.release( first );
	pool.release( second );
}

void PairContacts::releaseIfRefused()
{
	if ( m_contacts.empty() || m_phase == 0 || m_phase == m_pool.phase() )
	{
		return;
	}
	const auto isActive = []( const btCollisionObject* object ) {
		const SoftBody* const owner = ownerOfContactProxy( object );
		return owner ? owner->isActive() : object->isActive();
	};
	const btPersistentManifold& any = *m_contacts.front().manifold;
	if ( !isActive( any.getBody0() ) && !isActive( any.getBody1() ) )
	{
		return; // Bullet does not process sleeping pairs
	}
	for ( const NodeContact& contact : m_contacts )
	{
		wakeBoth( contact );
	}
	startMatching();
	dropBefore( kAllKeys );
	endMatching();
}

void PairContacts::collectManifolds( btManifoldArray& manifolds ) const
{
	for ( const NodeContact& contact : m_contacts )
	{
		manifolds.push_back( contact.manifold );
	}
}

void PairContacts::process( const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1, double step )
{
	enlist();
	SoftBody* const soft0 = softOf( &body0 );
	SoftBody* const soft1 = softOf( &body1 );
	m_phase = m_pool.phase();
	if ( !followNodes( soft0, soft1 ) )
	{
		return;
	}
	SoftBody* const soft = soft0 ? soft0 : soft1;
	SoftBody* const otherSoft = soft0 ? soft1 : nullptr;
	if ( body0.getCollisionObject()->isStaticOrKinematicObject() && body1.getCollisionObject()->isStaticOrKinematicObject() )
	{
		matchHits( Pair{ soft, nullptr, nullptr, true }, {} ); // neither moves the other
		return;
	}
	const btCollisionObjectWrapper& other = soft0 ? body1 : body0;
	otherSoft ? void() : notePressed( *soft, step );
	std::vector<NodeHit>& hits = otherSoft ? m_scratch.search.againstSoft( *soft, *otherSoft, step )
										   : m_scratch.search.againstRigid( *soft, other, step );
	if ( !hits.empty() )
	{
		noteHit( *soft, *other.getCollisionObject() );
		otherSoft ? noteHit( *otherSoft, *soft ) : void();
	}
	m_parting.follow( *soft, *other.getCollisionObject(), otherSoft, m_isNew, step, hits );
	m_isNew = false;
	matchHits( Pair{ soft, otherSoft, otherSoft ? nullptr : other.getCollisionObject(), soft == soft0 }, hits );
}

void PairContacts::processSelf( SoftBody& soft, SelfSearch& search, double step )
{
	enlist();
	if ( !followNodes( &soft, nullptr ) )
	{
		return;
	}
	matchHits( Pair{ &soft, &soft, nullptr, true }, search.find( soft, step ) );
}

// While contacts are matched, callbacks of the game may remove any object: `matching` is this pair as long as it exists.

void PairContacts::startMatching()
{
	m_scratch.matching = this;
	m_scratch.old = 0;
	m_scratch.contacts.clear();
}

void PairContacts::endMatching()
{
	if ( m_scratch.matching == this )
	{
		m_scratch.matching = nullptr;
		m_contacts.assign( m_scratch.contacts.begin(), m_scratch.contacts.end() );
		m_scratch.contacts.clear();
	}
}

/// Drops the contacts before `key`. False: this pair no longer exists.
bool PairContacts::dropBefore( std::uint64_t key )
{
	PairScratch& scratch = m_scratch;
	while ( scratch.old < m_contacts.size() && m_contacts[scratch.old].key < key )
	{
		drop( m_contacts[scratch.old++] );
		if ( scratch.matching != this )
		{
			return false;
		}
	}
	return true;
}

// Carries contacts of remaining nodes over to their new numbers after a change of levels, with impulses. Nodes keep their order, and so do
// the keys. False: this pair no longer exists.
bool PairContacts::followNodes( const SoftBody* soft0, const SoftBody* soft1 )
{
	// Either counter only grows: the sum is equal only where both are.
	const unsigned numbering = ( soft0 ? soft0->impl().numbering : 0u ) + ( soft1 ? soft1->impl().numbering : 0u );
	if ( numbering == m_numbering )
	{
		return true;
	}
	m_numbering = numbering;
	std::vector<NodeContact> gone;
	std::size_t kept = 0;
	for ( NodeContact contact : m_contacts )
	{
		if ( contact.first->node < 0 || ( contact.second && contact.second->node < 0 ) )
		{
			gone.push_back( contact );
			continue;
		}
		const std::uint64_t other = contact.second ? std::uint64_t( contact.second->node ) : contact.key & 0xffffffffu;
		contact.key = std::uint64_t( contact.first->node ) << 32 | other;
		m_contacts[kept++] = contact;
	}
	m_contacts.resize( kept );
	// Nodes keep their order in changes of levels, but not where a crack removes part of a block.
	const auto isBefore = []( const NodeContact& a, const NodeContact& b ) { return a.key < b.key; };
	if ( !std::is_sorted( m_contacts.begin(), m_contacts.end(), isBefore ) )
	{
		std::sort( m_contacts.begin(), m_contacts.end(), isBefore );
	}
	m_contacts.swap( gone );
	startMatching();
	m_scratch.contacts.assign( gone.begin(), gone.end() );
	for ( NodeContact& contact : m_contacts )
	{
		contact.key = 0;
	}
	const bool exists = dropBefore( kAllKeys );
	if ( exists )
	{
		endMatching();
	}
	return exists;
}

// Continues the contacts that still have a hit, drops the others and creates new ones, in the order of the keys.
void PairContacts::matchHits( const Pair& pair, const std::vector<NodeHit>& hits )
{
	std::size_t& old = m_scratch.old;
	startMatching();
	for ( std::size_t start = 0, end = 0; start < hits.size(); start = end )
	{
		const std::uint64_t key = hits[start].key;
		for ( end = start; end < hits.size() && hits[end].key == key; ++end )
		{}
		if ( !dropBefore( key ) )
		{
			return;
		}
		NodeContact contact;
		contact.key = key;
		if ( old < m_contacts.size() && m_contacts[old].key == key )
		{
			contact = m_contacts[old++];
			m_pool.refresh( *contact.first );
			if ( contact.second )
			{
				m_pool.refresh( *contact.second );
			}
		}
		else
		{
			create( pair, contact );
		}
		m_scratch.contacts.push_back( contact );
		if ( !write( pair, contact, &hits[start], int( end - start ) ) )
		{
			return;
		}
	}
	if ( dropBefore( kAllKeys ) )
	{
		endMatching();
	}
}

void PairContacts::create( const Pair& pair, NodeContact& contact )
{
	const NodeHit hit{ contact.key, {}, -1, -1 };
	contact.first = m_pool.acquire( *pair.soft, hit.node() );
	const btCollisionObject* other = pair.other;
	if ( pair.otherSoft )
	{
		contact.second = m_pool.acquire( *pair.otherSoft, hit.other() );
		other = contact.second;
	}
	contact.manifold = pair.softIsFirst ? m_dispatcher.getNewManifold( contact.first, other )
										: m_dispatcher.getNewManifold( other, contact.first );
}

/// False: this pair no longer exists.
bool PairContacts::write( const Pair& pair, const NodeContact& contact, const NodeHit* hits, int count )
{
	const PairScratch& scratch = m_scratch;
	btPersistentManifold& manifold = *contact.manifold;
	const ContactProxy& node = *contact.first;
	const btScalar radius = node.radius();
	const bool isNew = manifold.getNumContacts() == 0;
	// Hits are sorted by distance; Bullet keeps points within the threshold.
	manifold.setContactBreakingThreshold(
		btMax( btScalar( hits[count - 1].touch.distance ) - radius, btScalar( 0 ) ) + kContactSlop * radius );

	unsigned renewed = 0; // bit k: old point k is continued
	int positions[MANIFOLD_CACHE_SIZE];
	for ( int h = 0; h < count; ++h )
	{
		positions[h] = findPoint( manifold, hits[h], count, pair.softIsFirst );
		renewed |= positions[h] < 0 ? 0u : 1u << positions[h];
	}
	for ( int k = manifold.getNumContacts(); k-- > 0; )
	{
		if ( ( renewed & 1u << k ) == 0 )
		{
			// The last point moves into the gap.
			manifold.removeContactPoint( k );
			if ( scratch.matching != this )
			{
				return false;
			}
			std::replace( positions, positions + count, manifold.getNumContacts(), k );
		}
	}
	for ( int h = 0; h < count; ++h )
	{
		if ( positions[h] >= 0 )
		{
			renewPoint( manifold, node, hits[h], pair.softIsFirst, positions[h] );
		}
		else
		{
			btManifoldPoint point;
			fillPoint( manifold, node, hits[h], pair.softIsFirst, point );
			positions[h] = manifold.addManifoldPoint( point );
		}
		if ( hasContactCallback() && !notify( manifold, positions[h], hits[h].other() ) )
		{
			return false;
		}
	}
	if ( isNew && gContactStartedCallback )
	{
		btPersistentManifold* const started = &manifold;
		gContactStartedCallback( started );
	}
	return scratch.matching == this;
}

/// False: this pair no longer exists.
bool PairContacts::notify( btPersistentManifold& manifold, int index, int leaf )
{
	const PairScratch& scratch = m_scratch;
	btManifoldPoint& point = manifold.getContactPoint( index );
	notifyAdded( manifold, point, leaf );
	if ( scratch.matching == this && gContactProcessedCallback )
	{
		gContactProcessedCallback(
			point, const_cast<btCollisionObject*>( manifold.getBody0() ), const_cast<btCollisionObject*>( manifold.getBody1() ) );
	}
	return scratch.matching == this;
}

} // namespace pliant
