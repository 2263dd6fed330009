#pragma once

// The contacts of an island as whole bodies feel them: a small symmetric system, 6 unknowns a rigid body and 12 a soft one (its affine
// motions). It stands in front of the large one (implicit_block.h): without it a stack would learn of its floor one contact and one product
// at a time.

#include "world/linear/block_cholesky.h"

#include <utility>
#include <vector>

namespace pliant {

class CoarseSystem
{
public:
	using Piece = Eigen::Map<Eigen::MatrixXd>;
	/// Two bodies that feel each other, the later one first.
	using Pair = std::pair<int, int>;

	/// Unknowns of each body, a multiple of 6, and which of them feel each other, in any order and as often as it happens. The order in
	/// which it is solved is found here, once for as many sums as follow, and not again while both are what they were.
	void layOut( const std::vector<int>& sizes, std::vector<Pair>& pairs );
	/// Everything zero.
	void clear();
	/// The piece of rows of `a` and columns of `b`, a >= b, to be added to. Every body has one with itself, others as they were laid out.
	Piece block( int a, int b );
	bool has( int a, int b ) const { return find( a, b ) >= 0; }
	/// After the last piece: false where the sum is not positive definite; `solve` then gives 0.
	bool factor();
	int size() const { return m_size; }
	int offset( int body ) const { return m_offset[std::size_t( body )]; }
	/// x = the inverse times r.
	void solve( const Eigen::VectorXd& r, Eigen::VectorXd& x );

private:
	/// By column, then by row: what a column of the matrix goes through.
	struct Place
	{
		int row;   ///< body
		int value; ///< where its piece begins, column by column
	};
	/// A 6 x 6 part of a piece, and where the factor wants it.
	struct Part
	{
		int value, rows; ///< where it begins, and how many rows its piece has
		BlockCholesky::Place to;
	};
	int find( int a, int b ) const;
	void layOutFactor();

	std::vector<int> m_sizes, m_offset;
	std::vector<Pair> m_pairs; ///< with m_sizes: what it was laid out for
	std::vector<int> m_start;  ///< of each body's column among the places, and their end
	std::vector<Place> m_positions;
	std::vector<double> m_values;
	std::vector<Part> m_parts;
	BlockCholesky m_factor;
	int m_size = 0;
	bool m_isGood = false;
};

} // namespace pliant
