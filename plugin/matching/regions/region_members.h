#pragma once

// The nodes of each region, for any storage format of the tables.

#include "matching/kernels/kernels.h"
#include "matching/regions/region_tables.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pliant {

/// Members of a region, or regions of a node: membership is symmetric, so both are the same.
class RegionMembers
{
public:
	/// Both arguments must outlive this object unchanged.
	RegionMembers( const RegionTables& tables, const MatchView& view ) : m_tables( tables ), m_view( view )
	{
		if ( tables.usesGrid )
		{
			m_nodeAt.assign( std::size_t( view.gridX ) * std::size_t( view.gridY ) * std::size_t( view.gridZ ), -1 );
			for ( int i = 0; i < view.nodeCount; ++i )
			{
				m_nodeAt[view.slot ? view.slot[i] : std::uint32_t( i )] = i;
			}
		}
	}

	/// Calls visit( index, index into the matrix's weights ).
	template <class Visit>
	void visit( std::size_t i, Visit visit ) const
	{
		if ( m_tables.matrix )
		{
			const RegionMatrix& matrix = *m_tables.matrix;
			for ( std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k )
			{
				visit( std::size_t( matrix.member[k] ), k );
			}
		}
		else if ( m_tables.usesGrid )
		{
			visitCube( int( m_view.slot ? m_view.slot[i] : std::uint32_t( i ) ), visit );
		}
		else
		{
			std::for_each( m_view.member + m_view.start[i], m_view.member + m_view.start[i + 1],
				[&visit]( std::uint32_t member ) { visit( std::size_t( member ), 0 ); } );
			m_view.addOwner ? visit( i, 0 ) : void();
		}
	}

private:
	template <class Visit>
	void visitCube( int slot, Visit visit ) const
	{
		const int w = m_view.halfWidth, x = slot % m_view.gridX, y = slot / m_view.gridX % m_view.gridY,
				  z = slot / ( m_view.gridX * m_view.gridY );
		for ( int c = std::max( 0, z - w ); c <= std::min( m_view.gridZ - 1, z + w ); ++c )
		{
			for ( int b = std::max( 0, y - w ); b <= std::min( m_view.gridY - 1, y + w ); ++b )
			{
				const std::size_t row = ( std::size_t( c ) * std::size_t( m_view.gridY ) + std::size_t( b ) ) * std::size_t( m_view.gridX );
				for ( int a = std::max( 0, x - w ); a <= std::min( m_view.gridX - 1, x + w ); ++a )
				{
					if ( const int node = m_nodeAt[row + std::size_t( a )]; node >= 0 )
					{
						visit( std::size_t( node ), 0 );
					}
				}
			}
		}
	}

	const RegionTables& m_tables;
	const MatchView& m_view;
	std::vector<int> m_nodeAt; ///< by lattice position; empty unless the tables use the grid
};

} // namespace pliant
