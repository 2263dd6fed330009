#include "world/implicit/implicit_reach.h"

#include "world/bodies/prefetch.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/implicit/implicit_contacts.h"
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

unsigned char& at( std::vector<unsigned char>& flags, int index )
{
	if ( index >= int( flags.size() ) )
	{
		flags.resize( std::size_t( index ) + 1, 0 );
	}
	return flags[std::size_t( index )];
}

} // namespace

void ImplicitReach::note( const btCollisionObject& rigid, int block, bool touchesSoft )
{
	const int index = rigid.getWorldArrayIndex();
	unsigned char& isKnown = at( m_isKnown, index );
	m_bodies[std::size_t( block )] += isKnown ? 0 : 1;
	isKnown = 1;
	unsigned char& isIn = at( m_isIn, index );
	if ( touchesSoft && !isIn )
	{
		isIn = 1;
		++m_taken[std::size_t( block )];
	}
}

void ImplicitReach::look( const btPersistentManifold& manifold, const BlockPositions& positions )
{
	const btCollisionObject &a = *manifold.getBody0(), &b = *manifold.getBody1();
	const SoftBody *const softA = ownerOfContactProxy( &a ), *const softB = ownerOfContactProxy( &b );
	const bool isA = isDynamicRigid( a ), isB = isDynamicRigid( b ), touchesSoft = softA || softB;
	const int block = touchesSoft ? positions.blockOf( softA ? *softA : *softB )
								  : positions.blockOfIsland( isA ? a.getIslandTag()
											: isB                ? b.getIslandTag()
																 : -1 );
	if ( block < 0 )
	{
		return;
	}
	if ( isA )
	{
		note( a, block, touchesSoft );
	}
	if ( isB )
	{
		note( b, block, touchesSoft );
	}
	if ( isA && isB )
	{
		m_edges.push_back( Edge{ a.getWorldArrayIndex(), b.getWorldArrayIndex(), block } );
	}
}

/// What touches those that take part, in the order of the manifolds, as far as there is room. False: nothing was added.
bool ImplicitReach::addRing()
{
	constexpr unsigned char kTaken = 1, kNext = 2;
	m_next.clear();
	for ( const Edge& edge : m_edges )
	{
		const bool isInA = m_isIn[std::size_t( edge.a )] == kTaken, isInB = m_isIn[std::size_t( edge.b )] == kTaken;
		const int other = isInA ? edge.b : edge.a;
		int& taken = m_taken[std::size_t( edge.block )];
		if ( m_bodies[std::size_t( edge.block )] > kMostBlockRigid && isInA != isInB && m_isIn[std::size_t( other )] == 0 &&
			taken < kMostBlockRigid )
		{
			m_isIn[std::size_t( other )] = kNext;
			++taken;
			m_next.push_back( other );
		}
	}
	for ( const int index : m_next )
	{
		m_isIn[std::size_t( index )] = kTaken;
	}
	return !m_next.empty();
}

// Nearest first: what touches a soft body, then what touches that, and so on.
void ImplicitReach::choose( btDispatcher& dispatcher, const BlockPositions& positions, int blocks )
{
	std::fill( m_isIn.begin(), m_isIn.end(), static_cast<unsigned char>( 0 ) );
	std::fill( m_isKnown.begin(), m_isKnown.end(), static_cast<unsigned char>( 0 ) );
	m_bodies.assign( std::size_t( blocks ), 0 );
	m_taken.assign( std::size_t( blocks ), 0 );
	m_edges.clear();
	forEachManifold( dispatcher, prefetchEnd, [&]( const btPersistentManifold& manifold ) {
		if ( manifold.getNumContacts() > 0 )
		{
			look( manifold, positions );
		}
	} );
	while ( addRing() )
	{}
}

bool ImplicitReach::takesPart( int block, const btCollisionObject& rigid ) const
{
	const int index = rigid.getWorldArrayIndex();
	return m_bodies[std::size_t( block )] <= kMostBlockRigid ||
		( index >= 0 && index < int( m_isIn.size() ) && m_isIn[std::size_t( index )] == 1 );
}

} // namespace pliant
