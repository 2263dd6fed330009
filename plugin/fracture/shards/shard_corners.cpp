// Borders between shards over edges and corners of cells alone, which hold nothing once the faces beside them are open.

#include "fracture/constants.h"
#include "fracture/shards/shard_event.h"
#include "lattice/axis_neighbours.h"

#include <algorithm>
#include <cmath>

namespace pliant {

template <class Visit>
bool ShardEvent::anyNeighbour( std::uint32_t shard, bool beforeEvent, Visit&& visit ) const
{
	return std::any_of( m_bordersOf[shard].begin(), m_bordersOf[shard].end(), [&]( std::uint32_t b ) {
		const Border& border = m_borders[b];
		return ( beforeEvent ? border.hasArea : border.keepsArea ) && visit( border.shard[border.shard[0] == shard ? 1 : 0] );
	} );
}

// From both sides: the neighbours of one, then those of the other and theirs.
bool ShardEvent::areJoined( const Border& border, bool beforeEvent )
{
	const auto mark = [&]( std::uint8_t isNear ) {
		m_isNear[border.shard[1]] = isNear;
		anyNeighbour( border.shard[1], beforeEvent, [&]( std::uint32_t shard ) {
			m_isNear[shard] = isNear;
			return false;
		} );
	};
	mark( 1 );
	const auto isNear = [&]( std::uint32_t shard ) { return m_isNear[shard] != 0; };
	const bool found = anyNeighbour( border.shard[0], beforeEvent,
		[&]( std::uint32_t shard ) { return isNear( shard ) || anyNeighbour( shard, beforeEvent, isNear ); } );
	mark( 0 );
	return found;
}

// Links that never break hold a border that has opened.
void ShardEvent::findKeptAreas( const std::vector<std::uint8_t>& isCrumb )
{
	for ( std::uint32_t a = 0; a < std::uint32_t( m_shard.size() ); ++a )
	{
		for ( std::uint32_t k = m_limits.start[a]; k < m_limits.start[a + 1]; ++k )
		{
			if ( m_borderOfLink[k] == kNone )
			{
				continue;
			}
			const std::uint32_t b = m_limits.to[k];
			Border& border = m_borders[m_borderOfLink[k]];
			const bool isTough = !m_limits.toughness.empty() && std::isinf( m_limits.toughness[k] );
			const bool comesOff = !isCrumb.empty() && ( isCrumb[a] | isCrumb[b] ) != 0;
			const bool holds = isTough || ( !border.isBroken && !comesOff );
			border.keepsArea = border.keepsArea || ( holds && shareFace( m_lattice, a, b ) );
		}
	}
}

int ShardEvent::mostLostLinks( const Border& border ) const
{
	int most = 0;
	for ( const std::uint32_t shard : border.shard )
	{
		for ( const std::uint32_t b : m_bordersOf[shard] )
		{
			most = m_borders[b].hasArea && !m_borders[b].keepsArea ? std::max( most, m_borders[b].links ) : most;
		}
	}
	return most;
}

// Cells that touch along an edge or in a corner are two or three faces apart. In a slanted thin part all links of a border may run over
// edges: it is as long as others there and carries its load.
void ShardEvent::openCorners( const std::vector<std::uint8_t>& isCrumb )
{
	findKeptAreas( isCrumb );
	if ( std::none_of( m_borders.begin(), m_borders.end(), []( const Border& each ) { return each.hasArea && !each.keepsArea; } ) )
	{
		return;
	}
	m_isNear.assign( m_centre.size(), 0 );
	for ( Border& border : m_borders )
	{
		const bool isCorner = !border.isBroken && !border.keepsArea && border.links > 0 &&
			kCornerLinks * border.links <= mostLostLinks( border );
		border.isBroken = border.isBroken || ( isCorner && !areJoined( border, false ) && areJoined( border, true ) );
	}
}

} // namespace pliant
