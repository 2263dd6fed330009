#pragma once

// The coarse level of a block's preconditioner (island_block.h): a small symmetric system in which the contacts of an island
// act on whole bodies, 6 unknowns per rigid body and 12 per soft one (its affine motions). Without it the floor's support would propagate
// through a stack by one contact per product.

#include "world/linear/block_cholesky.h"

#include <utility>
#include <vector>

namespace pliant {

class CoarseSystem
{
public:
	using Piece = Eigen::Map<Eigen::MatrixXd>;
	/// Two coupled bodies, the higher index first.
	using Pair = std::pair<int, int>;

	/// Sets the number of unknowns of each body, a multiple of 6, and the coupled pairs, in any order and with duplicates. Computes the
	/// elimination order unless both are unchanged.
	void layOut( const std::vector<int>& sizes, std::vector<Pair>& pairs );
	/// Zeroes all pieces.
	void clear();
	/// Returns the piece with the rows of `a` and the columns of `b`, a >= b, to add to. Every body has one with itself.
	Piece block( int a, int b );
	bool has( int a, int b ) const { return find( a, b ) >= 0; }
	/// Call when all pieces are complete. Returns false if the matrix is not positive definite; `solve` then yields 0.
	bool factor();
	int size() const { return m_size; }
	int offset( int body ) const { return m_offset[std::size_t( body )]; }
	/// x = A^-1 r.
	void solve( const Eigen::VectorXd& r, Eigen::VectorXd& x );

private:
	/// A piece, sorted by column, then by row.
	struct Entry
	{
		int row;   ///< body
		int value; ///< offset of the piece in m_values, column-major
	};
	/// A 6 x 6 block of a piece, and its slot in the factor.
	struct Part
	{
		int value, rows; ///< offset in m_values, and the number of rows of the piece
		BlockCholesky::Slot slot;
	};
	int find( int a, int b ) const;
	void layOutFactor();

	std::vector<int> m_sizes, m_offset;
	std::vector<Pair> m_pairs; ///< with m_sizes: the current layout
	std::vector<int> m_start;  ///< of each body's column in m_entries, and the end
	std::vector<Entry> m_entries;
	std::vector<double> m_values;
	std::vector<Part> m_parts;
	BlockCholesky m_factor;
	int m_size = 0;
	bool m_isFactored = false;
};

} // namespace pliant
