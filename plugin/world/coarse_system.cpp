#include "world/coarse_system.h"

namespace pliant {

namespace {

/// Up to as many unknowns a dense factor is faster than a sparse one: eight soft bodies.
constexpr int kLargestDense = 96;

} // namespace

void CoarseSystem::begin( const std::vector<int>& sizes )
{
	m_sizes = sizes;
	m_offset.clear();
	m_blocks.clear();
	m_size = 0;
	for ( const int size : sizes )
	{
		m_offset.push_back( m_size );
		m_size += size;
	}
}

CoarseSystem::Piece& CoarseSystem::block( int a, int b )
{
	const auto [place, isNew] = m_blocks.try_emplace( { a, b } );
	if ( isNew )
	{
		place->second = Piece::Zero( m_sizes[std::size_t( a )], m_sizes[std::size_t( b )] );
	}
	return place->second;
}

bool CoarseSystem::factor()
{
	m_isDense = m_size <= kLargestDense;
	if ( m_size == 0 )
	{
		return m_isGood = false;
	}
	if ( m_isDense )
	{
		Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero( m_size, m_size );
		for ( const auto& [at, piece] : m_blocks )
		{
			matrix.block( offset( at.first ), offset( at.second ), piece.rows(), piece.cols() ) = piece;
		}
		m_dense.compute( matrix );
		return m_isGood = m_dense.info() == Eigen::Success;
	}
	std::vector<Eigen::Triplet<double>> entries;
	for ( const auto& [at, piece] : m_blocks )
	{
		for ( int col = 0; col < int( piece.cols() ); ++col )
		{
			for ( int row = at.first == at.second ? col : 0; row < int( piece.rows() ); ++row )
			{
				entries.emplace_back( offset( at.first ) + row, offset( at.second ) + col, piece( row, col ) );
			}
		}
	}
	Eigen::SparseMatrix<double> matrix( m_size, m_size );
	matrix.setFromTriplets( entries.begin(), entries.end() );
	m_sparse.compute( matrix );
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
