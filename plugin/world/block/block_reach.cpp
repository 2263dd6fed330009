#include "world/block/block_reach.h"

#include "world/block/block_contacts.h"
#include "world/bodies/prefetch.h"
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

void BlockReach::addBody( const btCollisionObject& rigid, int block, bool touchesSoft )
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
}

void BlockReach::addManifold( const btPersistentManifold& manifold, const BlockLookup& lookup )
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
		return;
	}
	if ( isA )
	{
		addBody( a, block, touchesSoft );
	}
	if ( isB )
	{
		addBody( b, block, touchesSoft );
	}
	if ( isA && isB && !ownerOfRigidProxy( &a ) && !ownerOfRigidProxy( &b ) )
	{
		m_edges.push_back( Edge{ a.getWorldArrayIndex(), b.getWorldArrayIndex(), block } );
	}
}

// Adds the bodies that touch those already taking part, in the order of the manifolds, up to the limit. Returns false if none was added.
bool BlockReach::addRing()
{
	constexpr unsigned char kTaken = 1, kNext = 2;
	m_next.clear();
	for ( const Edge& edge : m_edges )
	{
		const bool isInA = m_takesPart[std::size_t( edge.a )] == kTaken, isInB = m_takesPart[std::size_t( edge.b )] == kTaken;
		const int other = isInA ? edge.b : edge.a;
		int& taken = m_taken[std::size_t( edge.block )];
		if ( m_rigidCount[std::size_t( edge.block )] > kMostBlockRigid && isInA != isInB && m_takesPart[std::size_t( other )] == 0 &&
			taken < kMostBlockRigid )
		{
			m_takesPart[std::size_t( other )] = kNext;
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

// Breadth first: the bodies that touch a soft body, then those that touch them, and so on.
void BlockReach::choose( btDispatcher& dispatcher, const Attachments& attachments, const BlockLookup& lookup, int blocks )
{
	std::fill( m_takesPart.begin(), m_takesPart.end(), static_cast<unsigned char>( 0 ) );
	std::fill( m_isKnown.begin(), m_isKnown.end(), static_cast<unsigned char>( 0 ) );
	m_rigidCount.assign( std::size_t( blocks ), 0 );
	m_taken.assign( std::size_t( blocks ), 0 );
	m_edges.clear();
	forEachManifold( dispatcher, prefetchEnd, [&]( const btPersistentManifold& manifold ) {
		if ( manifold.getNumContacts() > 0 )
		{
			addManifold( manifold, lookup );
		}
	} );
	for ( const Attachment& attachment : attachments.all() )
	{
		const int block = lookup.blockOf( *attachment.first.body );
		if ( block >= 0 && attachment.rigid && isDynamicRigid( *attachment.rigid ) )
		{
			addBody( *attachment.rigid, block, true );
		}
	}
	while ( addRing() )
	{}
}

bool BlockReach::takesPart( int block, const btCollisionObject& rigid ) const
{
	const int index = rigid.getWorldArrayIndex();
	// Soft bodies in their rigid state often lie in heaps: those that touch a deformable body take part, the others do not.
	return ( m_rigidCount[std::size_t( block )] <= kMostBlockRigid && !ownerOfRigidProxy( &rigid ) ) ||
		( index >= 0 && index < int( m_takesPart.size() ) && m_takesPart[std::size_t( index )] == 1 );
}

} // namespace pliant
