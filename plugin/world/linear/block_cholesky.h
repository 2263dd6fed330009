#pragma once

// A = L L^T of a symmetric matrix of 6 x 6 blocks, few of them in a row. A sparse factor that goes by single entries, as Eigen's, spends
// its time finding them (docs/design/implicit.md has what either takes).

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace pliant {

class BlockCholesky
{
public:
	static constexpr int kEdge = 6;
	using Block = Eigen::Matrix<double, kEdge, kEdge>;
	/// Row and column of a block, the row no smaller than the column.
	using Pair = std::pair<int, int>;

	/// Which blocks there are on and below the diagonal, each once, all of the diagonal among them. The order of elimination is found here
	/// (approximate minimum degree), and what fills up.
	void layOut( int columns, const std::vector<Pair>& blocks );
	/// Where a block of A belongs, row >= column; turned: as its transpose.
	struct Place
	{
		int block = 0;
		bool isTurned = false;
	};
	Place place( int row, int column ) const;
	/// Everything zero: before A is written, by `set`, of the diagonal's blocks what lies on and below the diagonal.
	void clear();
	template <class Matrix>
	void set( Place place, const Matrix& block );
	/// False where A is not positive definite.
	bool factor();
	/// x = A^-1 r, both of 6 numbers a column. They may be the same.
	void solve( const double* r, double* x );

private:
	using Six = Eigen::Matrix<double, kEdge, 1>;
	int find( int row, int column ) const; ///< in order of elimination
	void findFill( std::vector<std::vector<int>>& rows );
	void findTargets();

	int m_columns = 0;
	std::vector<int> m_at, m_from; ///< of each column its place in the order of elimination, and the other way round
	std::vector<int> m_start;      ///< of each column's blocks, the diagonal's first, then by row; and their end
	std::vector<int> m_row;        ///< of each block
	std::vector<int> m_target; ///< of each pair of blocks below a diagonal, in the order in which `factor` meets them: what it is taken off
	std::vector<Block, Eigen::aligned_allocator<Block>> m_blocks; ///< A, then L; of the diagonal the inverse of L's
	std::vector<Six, Eigen::aligned_allocator<Six>> m_x;
};

template <class Matrix>
void BlockCholesky::set( Place place, const Matrix& block )
{
	Block& to = m_blocks[std::size_t( place.block )];
	if ( place.isTurned )
	{
		to = block.transpose();
	}
	else
	{
		to = block;
	}
}

} // namespace pliant
