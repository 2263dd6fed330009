#include "world/block/block_reach.h"

#include "world/block/block_contacts.h"
#include "world/bodies/manifolds.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/joints/attachments.h"
#include "world/shape/contact_proxy.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>

namespace pliant {

namespace {

bool isDynamicRigid( const btCollisionObject& object )
{
	const btRigidBody* const rigid = btRigidBody::upcast( &object );
	return rigid && !ownerOfContactProxy( &object ) && !object.isStaticOrKinematicObject() && rigid->getInvMass() > 0;
}

unsigned char& flagAt( std::vector<unsigned char>& flags, int index )
{
	if ( index >= int( flags.size() ) )
	{
		flags.resize( std::size_t( index ) + 1, 0 );
	}
	return flags[std::size_t( index )];
}

} // namespace

/// Whether the first (or second) object of a manifold with contacts rests on the other.
bool BlockReach::isCarried( const btPersistentManifold& manifold, bool isFirst ) const
{
	const btScalar rise = manifold.getContactPoint( 0 ).m_normalWorldOnB.dot( m_up ); // of the first above the second
	return m_up.isZero() || ( isFirst ? rise : -rise ) > btScalar( kSupportSlope );
}

void BlockReach::addBody( const btCollisionObject& rigid, int block, bool touchesSoft, bool restsOnSoft )
{
	const int index = rigid.getWorldArrayIndex();
	unsigned char& isKnown = flagAt( m_isKnown, index );
	m_rigidCount[std::size_t( block )] += isKnown ? 0 : 1;
	isKnown = 1;
	unsigned char& takes = flagAt( m_takesPart, index );
	if ( touchesSoft && !takes )
	{
		takes = 1;
		++m_taken[std::size_t( block )];
	}
	unsigned char& carried = flagAt( m_isCarried, index );
	carried = carried || restsOnSoft ? 1 : 0;
}

/// Returns whether the manifold has a soft body or is in the island of a block.
bool BlockReach::addManifold( const btPersistentManifold& manifold, const BlockLookup& lookup )
{
	const btCollisionObject &a = *manifold.getBody0(), &b = *manifold.getBody1();
	const SoftBody *const softA = ownerOfContactProxy( &a ), *const softB = ownerOfContactProxy( &b );
	const bool isA = isDynamicRigid( a ), isB = isDynamicRigid( b ), touchesSoft = softA || softB;
	const int block = touchesSoft ? lookup.blockOf( softA ? *softA : *softB )
								  : lookup.blockOfIsland( isA ? a.getIslandTag()
											: isB             ? b.getIslandTag()
															  : -1 );
	if ( block < 0 )
	{
		return touchesSoft;
	}
	if ( isA )
	{
		addBody( a, block, touchesSoft, touchesSoft && isCarried( manifold, true ) );
	}
	if ( isB )
	{
		addBody( b, block, touchesSoft, touchesSoft && isCarried( manifold, false ) );
	}
	if ( isA && isB && !ownerOfRigidProxy( &a ) && !ownerOfRigidProxy( &b ) )
	{
		m_edges.push_back( Edge{ a.getWorldArrayIndex(), b.getWorldArrayIndex(), block, &manifold } );
	}
	return true;
}

// Adds the bodies that rest on those which a soft body carries, in the order of the manifolds, up to the limit. Returns false if none was
// added. What supports a soft body from below or beside it carries what Bullet finds, and nothing else depends on its exact solution.
bool BlockReach::addRing()
{
	constexpr unsigned char kTaken = 1, kNext = 2;
	m_next.clear();
	for ( const Edge& edge : m_edges )
	{
		const bool isInA = m_takesPart[std::size_t( edge.a )] == kTaken, isInB = m_takesPart[std::size_t( edge.b )] == kTaken;
		const int inner = isInA ? edge.a : edge.b, other = isInA ? edge.b : edge.a;
		int& taken = m_taken[std::size_t( edge.block )];
		if ( m_rigidCount[std::size_t( edge.block )] > kWholeBlockRigid && isInA != isInB && m_isCarried[std::size_t( inner )] != 0 &&
			m_takesPart[std::size_t( other )] == 0 && taken < kMostBlockRigid && isCarried( *edge.manifold, isInB ) )
		{
			m_takesPart[std::size_t( other )] = kNext;
			m_isCarried[std::size_t( other )] = 1;
			++taken;
			m_next.push_back( other );
		}
	}
	for ( const int index : m_next )
	{
		m_takesPart[std::size_t( index )] = kTaken;
	}
	return !m_next.empty();
}

// Breadth first: the bodies that touch a soft body, then those that rest on them, and so on.
void BlockReach::choose( btDispatcher& dispatcher, const Attachments& attachments, const BlockLookup& lookup, int blocks,
	const btVector3& gravity, const ManifoldFilter& taken, const std::vector<const btCollisionObject*>& onFrames )
{
	std::fill( m_isOnFrame.begin(), m_isOnFrame.end(), static_cast<unsigned char>( 0 ) );
	for ( const btCollisionObject* const object : onFrames )
	{
		flagAt( m_isOnFrame, object->getWorldArrayIndex() ) = 1;
	}
	std::fill( m_takesPart.begin(), m_takesPart.end(), static_cast<unsigned char>( 0 ) );
	std::fill( m_isKnown.begin(), m_isKnown.end(), static_cast<unsigned char>( 0 ) );
	m_rigidCount.assign( std::size_t( blocks ), 0 );
	m_taken.assign( std::size_t( blocks ), 0 );
	std::fill( m_isCarried.begin(), m_isCarried.end(), static_cast<unsigned char>( 0 ) );
	m_up = gravity.fuzzyZero() ? btVector3( 0, 0, 0 ) : -gravity.normalized();
	m_edges.clear();
	m_manifolds.clear();
	forEachManifold( dispatcher, [&]( btPersistentManifold& manifold ) {
		const bool isInBlock = manifold.getNumContacts() > 0 && addManifold( manifold, lookup );
		if ( isInBlock || taken.mayContain( manifold ) )
		{
			m_manifolds.push_back( &manifold );
		}
	} );
	for ( const Attachment& attachment : attachments.all() )
	{
		const int block = lookup.blockOf( *attachment.first.body );
		if ( block >= 0 && attachment.rigid && isDynamicRigid( *attachment.rigid ) )
		{
			addBody( *attachment.rigid, block, true, true );
		}
	}
	while ( addRing() )
	{}
}

bool BlockReach::takesPart( int block, const btCollisionObject& rigid ) const
{
	const int index = rigid.getWorldArrayIndex();
	const bool isOnFrame = index >= 0 && index < int( m_isOnFrame.size() ) && m_isOnFrame[std::size_t( index )] != 0;
	// Soft bodies in their rigid state often lie in heaps: those that touch a deformable body take part, the others do not.
	return ( m_rigidCount[std::size_t( block )] <= kWholeBlockRigid && !ownerOfRigidProxy( &rigid ) && !isOnFrame ) ||
		( index >= 0 && index < int( m_takesPart.size() ) && m_takesPart[std::size_t( index )] == 1 );
}

} // namespace pliant
