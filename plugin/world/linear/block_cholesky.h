#pragma once

// Sparse Cholesky factorisation A = L L^T of a symmetric matrix of 6 x 6 blocks. A factorisation by single entries, such as Eigen's, spends
// its time on indices (timings of both: docs/design/implicit.md).

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace pliant {

class BlockCholesky
{
public:
	static constexpr int kEdge = 6;
	using Block = Eigen::Matrix<double, kEdge, kEdge>;
	/// Row and column of a block, row >= column.
	using Pair = std::pair<int, int>;

	/// Sets the nonzero blocks on and below the diagonal, each once, with all diagonal blocks. Computes the elimination order (approximate
	/// minimum degree) and the fill-in.
	void layOut( int columns, const std::vector<Pair>& blocks );
	/// Storage of a block of A, row >= column.
	struct Slot
	{
		int block = 0;
		bool isTransposed = false;
	};
	Slot slot( int row, int column ) const;
	/// Zeroes all blocks. Call before A is written by `set`; of diagonal blocks only the lower triangle is read.
	void clear();
	template <class Matrix>
	void set( Slot slot, const Matrix& block );
	/// Returns false if A is not positive definite.
	bool factor();
	/// x = A^-1 r, 6 values per column each. x and r may be the same.
	void solve( const double* r, double* x );

private:
	using Segment = Eigen::Matrix<double, kEdge, 1>;
	int find( int row, int column ) const; ///< both in elimination order
	void findFill( std::vector<std::vector<int>>& rows );
	void findTargets();

	int m_columns = 0;
	std::vector<int> m_orderOf, m_columnAt; ///< the position of each column in the elimination order, and the inverse
	std::vector<int> m_start;               ///< of each column's blocks, the diagonal first, then by row; and the end
	std::vector<int> m_row;                 ///< of each block
	std::vector<int>
		m_target; ///< by pair of subdiagonal blocks of a column, in the order of `factor`: the block that their product is subtracted from
	std::vector<Block, Eigen::aligned_allocator<Block>> m_blocks; ///< A, then L; on the diagonal the inverse of L's block
	std::vector<Segment, Eigen::aligned_allocator<Segment>> m_x;
};

template <class Matrix>
void BlockCholesky::set( Slot slot, const Matrix& block )
{
	Block& to = m_blocks[std::size_t( slot.block )];
	if ( slot.isTransposed )
	{
		to = block.transpose();
	}
	else
	{
		to = block;
	}
}

} // namespace pliant
