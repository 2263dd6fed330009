#pragma once

// The contacts of an island as whole bodies feel them: a small symmetric system, 6 unknowns a rigid body and 12 a soft one (its affine motions).
// It stands in front of the large one (implicit_block.h): without it a stack would learn of its floor one contact and one product at a time.

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include <map>
#include <utility>
#include <vector>

namespace pliant {

class CoarseSystem
{
public:
	using Piece = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12>;

	/// Unknowns of each body; everything zero.
	void begin( const std::vector<int>& sizes );
	/// The block of rows of `a` and columns of `b`, a >= b, to be added to.
	Piece& block( int a, int b );
	bool has( int a, int b ) const { return m_blocks.count( { a, b } ) > 0; }
	/// After the last block: false where the sum is not positive definite; `solve` then gives 0.
	bool factor();
	int size() const { return m_size; }
	int offset( int body ) const { return m_offset[std::size_t( body )]; }
	/// x = the inverse times r.
	void solve( const Eigen::VectorXd& r, Eigen::VectorXd& x ) const;

private:
	std::vector<int> m_sizes, m_offset;
	std::map<std::pair<int, int>, Piece> m_blocks;
	Eigen::LLT<Eigen::MatrixXd> m_dense;
	Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> m_sparse;
	int m_size = 0;
	bool m_isDense = true, m_isGood = false;
};

} // namespace pliant
