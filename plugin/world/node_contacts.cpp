#include "world/node_contacts.h"

#include "world/ahead.h"
#include "world/constants.h"
#include "world/soft_body_impl.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <algorithm>
#include <new>

namespace pliant {

namespace {

/// The soft body itself only: a node's stand-in meeting a compound is Bullet's business.
SoftBody* softOf( const btCollisionObjectWrapper* wrapper )
{
	return asSoftBody( const_cast<btCollisionObject*>( wrapper->getCollisionObject() ) );
}

/// What the two surfaces make of each other, through Bullet's (and the game's) own combination rules.
void combineSurfaces( const btCollisionObject* body0, const btCollisionObject* body1, btManifoldPoint& point )
{
	point.m_combinedFriction = gCalculateCombinedFrictionCallback( body0, body1 );
	point.m_combinedRestitution = gCalculateCombinedRestitutionCallback( body0, body1 );
	point.m_combinedRollingFriction = gCalculateCombinedRollingFrictionCallback( body0, body1 );
	point.m_combinedSpinningFriction = gCalculateCombinedSpinningFrictionCallback( body0, body1 );
	const int flags = body0->getCollisionFlags() | body1->getCollisionFlags();
	if ( flags & btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING )
	{
		point.m_combinedContactDamping1 = gCalculateCombinedContactDampingCallback( body0, body1 );
		point.m_combinedContactStiffness1 = gCalculateCombinedContactStiffnessCallback( body0, body1 );
		point.m_contactPointFlags |= BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
	}
	if ( flags & btCollisionObject::CF_HAS_FRICTION_ANCHOR )
	{
		point.m_contactPointFlags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
	}
	btPlaneSpace1( point.m_normalWorldOnB, point.m_lateralFrictionDir1, point.m_lateralFrictionDir2 );
}

/// In the body's own axes. Most stand-ins have the world's: what would be read of those lies in a line of its own.
btVector3 placeIn( const btCollisionObject& body, const btVector3& at )
{
	const bool isStraight = ownerOfNodeBody( &body ) && !static_cast<const NodeBody&>( body ).isDirected;
	return isStraight ? at - body.getWorldTransform().getOrigin() : body.getWorldTransform().invXform( at );
}

/// The hit as Bullet's solver wants it: the points on both surfaces, the normal on the second object, who it is. What a point is given besides when it
/// is made is given again; its age, its impulses and the game's pointer stay.
void fillPoint( const btPersistentManifold& manifold, const NodeBody& node, const NodeHit& hit, bool nodeIsFirst, btManifoldPoint& point )
{
	const btScalar radius = node.radius(), distance = btScalar( hit.touch.distance );
	const btVector3 outward = toBt( hit.touch.normal );
	setWhole( nodeIsFirst ? point.m_positionWorldOnA : point.m_positionWorldOnB, node.written - outward * radius );
	setWhole( nodeIsFirst ? point.m_positionWorldOnB : point.m_positionWorldOnA, node.written - outward * distance );
	setWhole( point.m_localPointA, placeIn( *manifold.getBody0(), point.m_positionWorldOnA ) );
	setWhole( point.m_localPointB, placeIn( *manifold.getBody1(), point.m_positionWorldOnB ) );
	setWhole( point.m_normalWorldOnB, nodeIsFirst ? outward : -outward );
	point.m_distance1 = distance - radius;
	point.m_partId0 = nodeIsFirst ? -1 : hit.part;
	point.m_index0 = nodeIsFirst ? node.node : hit.index;
	point.m_partId1 = nodeIsFirst ? hit.part : -1;
	point.m_index1 = nodeIsFirst ? hit.index : node.node;
	point.m_contactPointFlags = 0;
	point.m_contactMotion1 = point.m_contactMotion2 = 0;
	point.m_contactCFM = point.m_contactERP = point.m_frictionCFM = 0;
	combineSurfaces( manifold.getBody0(), manifold.getBody1(), point );
}

/// Where it lies: what a copy would be made of has just been written in parts, and would be waited for.
void renewPoint( btPersistentManifold& manifold, const NodeBody& node, const NodeHit& hit, bool nodeIsFirst, int at )
{
	btManifoldPoint& point = manifold.getContactPoint( at );
	// It bounces once a touch: a node that is pressed on, and struck in each substep, would bring in more than it takes.
	const bool hasBounced = point.m_appliedImpulse > 0;
	if ( ( manifold.getBody0()->getCollisionFlags() | manifold.getBody1()->getCollisionFlags() ) & btCollisionObject::CF_HAS_FRICTION_ANCHOR )
	{
		btManifoldPoint anchored; // Bullet says whether it stays where it was
		fillPoint( manifold, node, hit, nodeIsFirst, anchored );
		anchored.m_combinedRestitution = hasBounced ? btScalar( 0 ) : anchored.m_combinedRestitution;
		manifold.replaceContactPoint( anchored, at );
	}
	else
	{
		fillPoint( manifold, node, hit, nodeIsFirst, point );
		point.m_combinedRestitution = hasBounced ? btScalar( 0 ) : point.m_combinedRestitution;
	}
	++point.m_lifeTime;
}

/// The game may change a new or renewed point, as with any contact of Bullet's.
void tellAdded( const btPersistentManifold& manifold, btManifoldPoint& point )
{
	const btCollisionObject* const body0 = manifold.getBody0();
	const btCollisionObject* const body1 = manifold.getBody1();
	const int flags = body0->getCollisionFlags() | body1->getCollisionFlags();
	if ( gContactAddedCallback && ( flags & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK ) != 0 )
	{
		const btCollisionObjectWrapper wrap0( nullptr, body0->getCollisionShape(), body0, body0->getWorldTransform(), point.m_partId0, point.m_index0 );
		const btCollisionObjectWrapper wrap1( nullptr, body1->getCollisionShape(), body1, body1->getWorldTransform(), point.m_partId1, point.m_index1 );
		gContactAddedCallback( point, &wrap0, point.m_partId0, point.m_index0, &wrap1, point.m_partId1, point.m_index1 );
	}
}

/// The old point that a hit carries on: of the same triangle or part. A manifold of one point keeps it wherever it slides.
int findPoint( const btPersistentManifold& manifold, const NodeHit& hit, int hitCount, bool nodeIsFirst )
{
	const int count = manifold.getNumContacts();
	if ( count == 1 && hitCount == 1 )
	{
		return 0;
	}
	for ( int k = 0; k < count; ++k )
	{
		const btManifoldPoint& point = manifold.getContactPoint( k );
		if ( ( nodeIsFirst ? point.m_index1 : point.m_index0 ) == hit.index && ( nodeIsFirst ? point.m_partId1 : point.m_partId0 ) == hit.part )
		{
			return k;
		}
	}
	return -1;
}

} // namespace

PairContacts::~PairContacts()
{
	m_scratch.last = m_scratch.last == this ? nullptr : m_scratch.last;
	for ( NodeContact& contact : m_contacts )
	{
		// What the pair held up falls when it goes: wake it, for Bullet does not look at sleeping bodies when a floor is taken away.
		const bool held = contact.manifold->getNumContacts() > 0;
		if ( held )
		{
			contact.first->owner->activate();
			if ( contact.second )
			{
				contact.second->owner->activate();
			}
		}
		drop( contact );
	}
}

void PairContacts::drop( NodeContact& contact )
{
	// Manifolds before the bodies they name.
	m_dispatcher.releaseManifold( contact.manifold );
	m_pool.release( contact.first );
	m_pool.release( contact.second );
	contact = NodeContact{};
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
	SoftBody* const soft0 = softOf( &body0 );
	SoftBody* const soft1 = softOf( &body1 );
	askFor( m_after, sizeof( PairContacts ) );
	if ( m_scratch.last )
	{
		m_scratch.last->m_after = this;
	}
	m_scratch.last = this;
	askFor( m_contacts.data(), kFetched );
	followNodes( soft0, soft1 );
	SoftBody* const soft = soft0 ? soft0 : soft1;
	SoftBody* const otherSoft = soft0 ? soft1 : nullptr;
	const btCollisionObjectWrapper& other = soft0 ? body1 : body0;
	std::vector<NodeHit>& hits = otherSoft ? m_scratch.search.againstSoft( *soft, *otherSoft, step ) : m_scratch.search.againstRigid( *soft, other, step );
	m_parting.follow( *soft, *other.getCollisionObject(), otherSoft, m_isNew, step, hits );
	m_isNew = false;
	matchHits( Pair{ soft, otherSoft, otherSoft ? nullptr : other.getCollisionObject(), soft == soft0 }, hits );
}

void PairContacts::processSelf( SoftBody& soft, SelfSearch& search, double step )
{
	followNodes( &soft, nullptr );
	matchHits( Pair{ &soft, &soft, nullptr, true }, search.find( soft, step ) );
}

// After a change of levels: the contacts of nodes that are still there carry on under their new numbers, impulses and all. Nodes keep
// their order, and so do the keys.
void PairContacts::followNodes( const SoftBody* soft0, const SoftBody* soft1 )
{
	// Either number only ever grows: the sum is the same only where both are.
	const unsigned numbering = ( soft0 ? soft0->impl().numbering : 0u ) + ( soft1 ? soft1->impl().numbering : 0u );
	if ( numbering == m_numbering )
	{
		return;
	}
	m_numbering = numbering;
	std::size_t kept = 0;
	for ( std::size_t k = 0; k < m_contacts.size(); ++k )
	{
		NodeContact contact = m_contacts[k];
		if ( contact.first->node < 0 || ( contact.second && contact.second->node < 0 ) )
		{
			drop( contact );
			continue;
		}
		const std::uint64_t other = contact.second ? std::uint64_t( contact.second->node ) : contact.key & 0xffffffffu;
		contact.key = std::uint64_t( contact.first->node ) << 32 | other;
		m_contacts[kept++] = contact;
	}
	m_contacts.resize( kept );
	// Nodes keep their order through changes of levels; what a crack leaves of a block may stand in another.
	const auto isBefore = []( const NodeContact& a, const NodeContact& b ) { return a.key < b.key; };
	if ( !std::is_sorted( m_contacts.begin(), m_contacts.end(), isBefore ) )
	{
		std::sort( m_contacts.begin(), m_contacts.end(), isBefore );
	}
}

void PairContacts::askAhead( std::size_t contact ) const
{
	if ( contact >= m_contacts.size() )
	{
		return;
	}
	const NodeContact& ahead = m_contacts[contact];
	askForManifold( *ahead.manifold );
	NodeBodyPool::askAhead( *ahead.first );
	if ( ahead.second )
	{
		NodeBodyPool::askAhead( *ahead.second );
	}
}

// Carries on the contacts that still have a hit, drops the others, opens new ones, all in the order of the keys.
void PairContacts::matchHits( const Pair& pair, const std::vector<NodeHit>& hits )
{
	std::vector<NodeContact>& next = m_scratch.contacts;
	next.clear();
	for ( std::size_t k = 0; k <= kContactsAhead && !hits.empty(); ++k )
	{
		askAhead( k );
	}
	std::size_t old = 0;
	for ( std::size_t start = 0, end = 0; start < hits.size(); start = end )
	{
		const std::uint64_t key = hits[start].key;
		for ( end = start; end < hits.size() && hits[end].key == key; ++end )
		{
		}
		for ( ; old < m_contacts.size() && m_contacts[old].key < key; ++old )
		{
			drop( m_contacts[old] );
		}
		NodeContact contact;
		contact.key = key;
		if ( old < m_contacts.size() && m_contacts[old].key == key )
		{
			contact = m_contacts[old++];
			askAhead( old + kContactsAhead );
			m_pool.refresh( *contact.first );
			if ( contact.second )
			{
				m_pool.refresh( *contact.second );
			}
		}
		else
		{
			open( pair, contact );
		}
		write( pair, contact, &hits[start], int( end - start ) );
		next.push_back( contact );
	}
	for ( ; old < m_contacts.size(); ++old )
	{
		drop( m_contacts[old] );
	}
	m_contacts.assign( next.begin(), next.end() );
}

void PairContacts::open( const Pair& pair, NodeContact& contact )
{
	const NodeHit hit{ contact.key, {}, -1, -1 };
	contact.first = m_pool.acquire( *pair.soft, hit.node() );
	const btCollisionObject* other = pair.other;
	if ( pair.otherSoft )
	{
		contact.second = m_pool.acquire( *pair.otherSoft, hit.other() );
		other = contact.second;
	}
	contact.manifold = pair.softIsFirst ? m_dispatcher.getNewManifold( contact.first, other ) : m_dispatcher.getNewManifold( other, contact.first );
}

void PairContacts::write( const Pair& pair, NodeContact& contact, const NodeHit* hits, int count )
{
	btPersistentManifold& manifold = *contact.manifold;
	const btScalar radius = contact.first->radius();
	const bool isNew = manifold.getNumContacts() == 0;
	// Hits come nearest first; Bullet keeps what lies within the threshold.
	manifold.setContactBreakingThreshold( btMax( btScalar( hits[count - 1].touch.distance ) - radius, btScalar( 0 ) ) + kContactSlop * radius );

	unsigned renewed = 0; // bit k: old point k is carried on
	int places[MANIFOLD_CACHE_SIZE];
	for ( int h = 0; h < count; ++h )
	{
		places[h] = findPoint( manifold, hits[h], count, pair.softIsFirst );
		renewed |= places[h] < 0 ? 0u : 1u << places[h];
	}
	for ( int k = manifold.getNumContacts(); k-- > 0; )
	{
		if ( ( renewed & 1u << k ) == 0 )
		{
			// The last point moves into the gap.
			manifold.removeContactPoint( k );
			std::replace( places, places + count, manifold.getNumContacts(), k );
		}
	}
	for ( int h = 0; h < count; ++h )
	{
		if ( places[h] >= 0 )
		{
			renewPoint( manifold, *contact.first, hits[h], pair.softIsFirst, places[h] );
		}
		else
		{
			btManifoldPoint point;
			fillPoint( manifold, *contact.first, hits[h], pair.softIsFirst, point );
			places[h] = manifold.addManifoldPoint( point );
		}
		btManifoldPoint& kept = manifold.getContactPoint( places[h] );
		tellAdded( manifold, kept );
		if ( gContactProcessedCallback )
		{
			gContactProcessedCallback( kept, const_cast<btCollisionObject*>( manifold.getBody0() ), const_cast<btCollisionObject*>( manifold.getBody1() ) );
		}
	}
	if ( isNew && gContactStartedCallback )
	{
		btPersistentManifold* const started = &manifold;
		gContactStartedCallback( started );
	}
}

NodeAlgorithm::NodeAlgorithm( const btCollisionAlgorithmConstructionInfo& info, NodeBodyPool& pool, PairScratch& scratch ) :
	btCollisionAlgorithm( info ), m_contacts( new PairContacts( *info.m_dispatcher1, pool, scratch ) )
{
}

NodeAlgorithm::~NodeAlgorithm()
{
	delete m_contacts;
}

void NodeAlgorithm::processCollision( const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
	const btDispatcherInfo& info, btManifoldResult* )
{
	m_contacts->process( *body0, *body1, double( info.m_timeStep ) );
}

btCollisionAlgorithm* NodeCreateFunc::CreateCollisionAlgorithm(
	btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1 )
{
	if ( !softOf( body0 ) && !softOf( body1 ) )
	{
		return m_before->CreateCollisionAlgorithm( info, body0, body1 );
	}
	void* const room = info.m_dispatcher1->allocateCollisionAlgorithm( sizeof( NodeAlgorithm ) );
	return new ( room ) NodeAlgorithm( info, m_pool, m_scratch );
}

} // namespace pliant
