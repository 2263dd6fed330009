#include "world/coarse_system.h"

#include <algorithm>

namespace pliant {

namespace {

/// Up to as many unknowns a dense factor is faster than a sparse one: eight soft bodies.
constexpr int kLargestDense = 96;

} // namespace

void CoarseSystem::layOut( const std::vector<int>& sizes, std::vector<Pair>& pairs )
{
	m_sizes = sizes;
	m_offset.clear();
	m_size = 0;
	for ( std::size_t body = 0; body < sizes.size(); ++body )
	{
		m_offset.push_back( m_size );
		m_size += sizes[body];
		pairs.emplace_back( int( body ), int( body ) );
	}
	std::sort( pairs.begin(), pairs.end(), []( const Pair& a, const Pair& b ) { return std::pair( a.second, a.first ) < std::pair( b.second, b.first ); } );
	pairs.erase( std::unique( pairs.begin(), pairs.end() ), pairs.end() );
	m_start.assign( 1, 0 );
	m_places.clear();
	int values = 0;
	for ( const auto& [row, column] : pairs )
	{
		m_start.resize( std::size_t( column ) + 2 );
		m_places.push_back( Place{ row, values } );
		m_start.back() = int( m_places.size() );
		values += sizes[std::size_t( row )] * sizes[std::size_t( column )];
	}
	m_values.assign( std::size_t( values ), 0.0 );
	m_isDense = m_size <= kLargestDense;
	if ( !m_isDense )
	{
		layOutSparse();
	}
}

/// Places for what lies on and below the diagonal, in the order in which `factor` fills them: by column, then by row.
void CoarseSystem::layOutSparse()
{
	std::vector<Eigen::Triplet<double>> entries;
	for ( std::size_t b = 0; b < m_sizes.size(); ++b )
	{
		for ( int p = m_start[b]; p < m_start[b + 1]; ++p )
		{
			const int row = m_places[std::size_t( p )].row;
			for ( int k = 0; k < m_sizes[b]; ++k )
			{
				for ( int i = row == int( b ) ? k : 0; i < m_sizes[std::size_t( row )]; ++i )
				{
					entries.emplace_back( offset( row ) + i, offset( int( b ) ) + k, 0.0 );
				}
			}
		}
	}
	m_matrix.resize( m_size, m_size );
	m_matrix.setFromTriplets( entries.begin(), entries.end() );
	m_sparse.analyzePattern( m_matrix );
}

void CoarseSystem::clear()
{
	std::fill( m_values.begin(), m_values.end(), 0.0 );
}

int CoarseSystem::find( int a, int b ) const
{
	for ( int p = m_start[std::size_t( b )]; p < m_start[std::size_t( b ) + 1]; ++p )
	{
		if ( m_places[std::size_t( p )].row == a )
		{
			return m_places[std::size_t( p )].value;
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
	if ( m_size == 0 )
	{
		return m_isGood = false;
	}
	if ( m_isDense )
	{
		m_whole.setZero( m_size, m_size );
		for ( int b = 0; b < int( m_sizes.size() ); ++b )
		{
			for ( int p = m_start[std::size_t( b )]; p < m_start[std::size_t( b ) + 1]; ++p )
			{
				const int a = m_places[std::size_t( p )].row;
				const Piece piece = block( a, b );
				m_whole.block( offset( a ), offset( b ), piece.rows(), piece.cols() ) = piece;
			}
		}
		m_dense.compute( m_whole );
		return m_isGood = m_dense.info() == Eigen::Success;
	}
	double* to = m_matrix.valuePtr();
	for ( std::size_t b = 0; b < m_sizes.size(); ++b )
	{
		for ( int k = 0; k < m_sizes[b]; ++k )
		{
			for ( int p = m_start[b]; p < m_start[b + 1]; ++p )
			{
				const Place& place = m_places[std::size_t( p )];
				const int rows = m_sizes[std::size_t( place.row )], first = place.row == int( b ) ? k : 0;
				const double* const column = m_values.data() + place.value + k * rows;
				to = std::copy( column + first, column + rows, to );
			}
		}
	}
	m_sparse.factorize( m_matrix );
	return m_isGood = m_sparse.info() == Eigen::Success;
}

void CoarseSystem::solve( const Eigen::VectorXd& r, Eigen::VectorXd& x ) const
{
	if ( !m_isGood )
	{
		x = Eigen::VectorXd::Zero( m_size );
	}
	else if ( m_isDense )
	{
		x = m_dense.solve( r );
	}
	else
	{
		x = m_sparse.solve( r );
	}
}

} // namespace pliant
