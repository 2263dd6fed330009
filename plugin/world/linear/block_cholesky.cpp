#include "world/linear/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>

namespace pliant {

namespace {

using Block = BlockCholesky::Block;
constexpr int kEdge = BlockCholesky::kEdge;

/// Replaces d, given by its lower triangle, by the inverse of its Cholesky factor; returns false if d is not positive definite.
bool invertFactor( Block& d )
{
	const Eigen::LLT<Block> factor( d );
	const Block lower = factor.matrixL();
	if ( factor.info() != Eigen::Success || !( lower.diagonal().array() > 0.0 ).all() ) // info() stays Success for NaN
	{
		return false;
	}
	d = lower.triangularView<Eigen::Lower>().solve( Block::Identity() );
	return true;
}

} // namespace

void BlockCholesky::layOut( int columns, const std::vector<Pair>& blocks )
{
	m_columns = columns;
	std::vector<Eigen::Triplet<double>> entries;
	for ( const auto& [row, column] : blocks )
	{
		entries.emplace_back( row, column, 1.0 );
		entries.emplace_back( column, row, 1.0 );
	}
	Eigen::SparseMatrix<double> graph( columns, columns );
	graph.setFromTriplets( entries.begin(), entries.end() );
	Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
	Eigen::AMDOrdering<int>()( graph, order );
	m_columnAt.assign( order.indices().data(), order.indices().data() + columns );
	m_orderOf.resize( std::size_t( columns ) );
	for ( int k = 0; k < columns; ++k )
	{
		m_orderOf[std::size_t( m_columnAt[std::size_t( k )] )] = k;
	}
	std::vector<std::vector<int>> rows( m_columnAt.size() );
	for ( const auto& [row, column] : blocks )
	{
		const auto [first, later] = std::minmax( m_orderOf[std::size_t( row )], m_orderOf[std::size_t( column )] );
		rows[std::size_t( first )].push_back( later ); // the diagonal too, which sorts first
	}
	findFill( rows );
	findTargets();
	m_blocks.resize( m_row.size() );
	m_x.resize( std::size_t( columns ) );
}

// The column of a column's first subdiagonal row inherits the rows below it.
void BlockCholesky::findFill( std::vector<std::vector<int>>& rows )
{
	m_start.assign( 1, 0 );
	m_row.clear();
	for ( int column = 0; column < m_columns; ++column )
	{
		std::vector<int>& own = rows[std::size_t( column )];
		std::sort( own.begin(), own.end() );
		own.erase( std::unique( own.begin(), own.end() ), own.end() );
		m_row.insert( m_row.end(), own.begin(), own.end() );
		m_start.push_back( int( m_row.size() ) );
		if ( own.size() > 2 )
		{
			std::vector<int>& next = rows[std::size_t( own[1] )];
			next.insert( next.end(), own.begin() + 2, own.end() );
		}
	}
}

void BlockCholesky::findTargets()
{
	m_target.clear();
	for ( int column = 0; column < m_columns; ++column )
	{
		const int end = m_start[std::size_t( column ) + 1];
		for ( int b = m_start[std::size_t( column )] + 1; b < end; ++b )
		{
			int at = m_start[std::size_t( m_row[std::size_t( b )] )];
			for ( int a = b; a < end; ++a )
			{
				while ( m_row[std::size_t( at )] != m_row[std::size_t( a )] )
				{
					++at;
				}
				m_target.push_back( at );
			}
		}
	}
}

int BlockCholesky::find( int row, int column ) const
{
	const auto begin = m_row.begin() + m_start[std::size_t( column )], end = m_row.begin() + m_start[std::size_t( column ) + 1];
	return int( std::lower_bound( begin, end, row ) - m_row.begin() );
}

BlockCholesky::Slot BlockCholesky::slot( int row, int column ) const
{
	const int r = m_orderOf[std::size_t( row )], c = m_orderOf[std::size_t( column )];
	return { find( std::max( r, c ), std::min( r, c ) ), r < c };
}

void BlockCholesky::clear()
{
	std::fill( m_blocks.begin(), m_blocks.end(), Block::Zero() );
}

// For each column: L_jj, then L_aj = A_aj L_jj^-T, then A_ab -= L_aj L_bj^T.
bool BlockCholesky::factor()
{
	const int* target = m_target.data();
	for ( int column = 0; column < m_columns; ++column )
	{
		const int begin = m_start[std::size_t( column )], end = m_start[std::size_t( column ) + 1];
		Block& diagonal = m_blocks[std::size_t( begin )];
		if ( !invertFactor( diagonal ) )
		{
			return false;
		}
		for ( int a = begin + 1; a < end; ++a )
		{
			Block& own = m_blocks[std::size_t( a )];
			own = own.lazyProduct( diagonal.transpose() ).eval();
		}
		for ( int b = begin + 1; b < end; ++b )
		{
			for ( int a = b; a < end; ++a )
			{
				m_blocks[std::size_t( *target++ )] -= m_blocks[std::size_t( a )].lazyProduct( m_blocks[std::size_t( b )].transpose() );
			}
		}
	}
	return true;
}

void BlockCholesky::solve( const double* r, double* x )
{
	for ( int k = 0; k < m_columns; ++k )
	{
		m_x[std::size_t( k )] = Eigen::Map<const Segment>( r + kEdge * m_columnAt[std::size_t( k )] );
	}
	for ( int column = 0; column < m_columns; ++column )
	{
		const int begin = m_start[std::size_t( column )], end = m_start[std::size_t( column ) + 1];
		const Segment own = m_blocks[std::size_t( begin )] * m_x[std::size_t( column )];
		m_x[std::size_t( column )] = own;
		for ( int a = begin + 1; a < end; ++a )
		{
			m_x[std::size_t( m_row[std::size_t( a )] )].noalias() -= m_blocks[std::size_t( a )] * own;
		}
	}
	for ( int column = m_columns - 1; column >= 0; --column )
	{
		const int begin = m_start[std::size_t( column )], end = m_start[std::size_t( column ) + 1];
		Segment sum = m_x[std::size_t( column )];
		for ( int a = begin + 1; a < end; ++a )
		{
			sum.noalias() -= m_blocks[std::size_t( a )].transpose() * m_x[std::size_t( m_row[std::size_t( a )] )];
		}
		m_x[std::size_t( column )].noalias() = m_blocks[std::size_t( begin )].transpose() * sum;
	}
	for ( int k = 0; k < m_columns; ++k )
	{
		Eigen::Map<Segment>( x + kEdge * m_columnAt[std::size_t( k )] ) = m_x[std::size_t( k )];
	}
}

} // namespace pliant
