#include "world/linear/coarse_system.h"

#include <algorithm>

namespace pliant {

void CoarseSystem::layOut( const std::vector<int>& sizes, std::vector<Pair>& pairs )
{
	for ( std::size_t body = 0; body < sizes.size(); ++body )
	{
		pairs.emplace_back( int( body ), int( body ) );
	}
	std::sort( pairs.begin(), pairs.end(),
		[]( const Pair& a, const Pair& b ) { return std::pair( a.second, a.first ) < std::pair( b.second, b.first ); } );
	pairs.erase( std::unique( pairs.begin(), pairs.end() ), pairs.end() );
	if ( !m_start.empty() && sizes == m_sizes && pairs == m_pairs )
	{
		clear(); // the coupling rarely changes at rest
		return;
	}
	m_sizes = sizes;
	m_pairs = pairs;
	m_offset.clear();
	m_size = 0;
	for ( const int size : sizes )
	{
		m_offset.push_back( m_size );
		m_size += size;
	}
	m_start.assign( 1, 0 );
	m_entries.clear();
	int values = 0;
	for ( const auto& [row, column] : pairs )
	{
		m_start.resize( std::size_t( column ) + 2 );
		m_entries.push_back( Entry{ row, values } );
		m_start.back() = int( m_entries.size() );
		values += sizes[std::size_t( row )] * sizes[std::size_t( column )];
	}
	m_values.assign( std::size_t( values ), 0.0 );
	layOutFactor();
}

// Lists the 6 x 6 blocks of the pieces that lie on and below the diagonal.
void CoarseSystem::layOutFactor()
{
	constexpr int edge = BlockCholesky::kEdge;
	std::vector<BlockCholesky::Pair> blocks;
	m_parts.clear();
	for ( int b = 0; b < int( m_sizes.size() ); ++b )
	{
		for ( int p = m_start[std::size_t( b )]; p < m_start[std::size_t( b ) + 1]; ++p )
		{
			const Entry& entry = m_entries[std::size_t( p )];
			const int rows = m_sizes[std::size_t( entry.row )];
			for ( int j = 0; j < m_sizes[std::size_t( b )]; j += edge )
			{
				for ( int i = entry.row == b ? j : 0; i < rows; i += edge )
				{
					blocks.emplace_back( ( offset( entry.row ) + i ) / edge, ( offset( b ) + j ) / edge );
					m_parts.push_back( Part{ entry.value + j * rows + i, rows, {} } );
				}
			}
		}
	}
	m_factor.layOut( m_size / edge, blocks );
	for ( std::size_t k = 0; k < blocks.size(); ++k )
	{
		m_parts[k].slot = m_factor.slot( blocks[k].first, blocks[k].second );
	}
}

void CoarseSystem::clear()
{
	std::fill( m_values.begin(), m_values.end(), 0.0 );
}

int CoarseSystem::find( int a, int b ) const
{
	for ( int p = m_start[std::size_t( b )]; p < m_start[std::size_t( b ) + 1]; ++p )
	{
		if ( m_entries[std::size_t( p )].row == a )
		{
			return m_entries[std::size_t( p )].value;
		}
	}
	return -1;
}

CoarseSystem::Piece CoarseSystem::block( int a, int b )
{
	return { m_values.data() + find( a, b ), m_sizes[std::size_t( a )], m_sizes[std::size_t( b )] };
}

bool CoarseSystem::factor()
{
	m_factor.clear();
	for ( const Part& part : m_parts )
	{
		m_factor.set( part.slot,
			Eigen::Map<const BlockCholesky::Block, 0, Eigen::OuterStride<>>(
				m_values.data() + part.value, Eigen::OuterStride<>( part.rows ) ) );
	}
	return m_isFactored = m_factor.factor();
}

void CoarseSystem::solve( const Eigen::VectorXd& r, Eigen::VectorXd& x )
{
	x.setZero( m_size );
	if ( m_isFactored )
	{
		m_factor.solve( r.data(), x.data() );
	}
}

} // namespace pliant
