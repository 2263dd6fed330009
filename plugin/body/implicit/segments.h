#pragma once

// The segments of a large elastic body: connected groups of neighbouring cells, each of which moves as a rigid body in the coarse system of
// a block's preconditioner. A stiff body's bending is far from any affine motion of the whole, and would spread by a few cells per product.
//
// Regions between two segments resist their relative velocity at a link, D. Of a full lattice with regions of n layers of cells,
//   E = 1/2 s |D|^2,   s = G m ( n^2 - 1 ) / ( 8 n )
// a link to a face neighbour, the mean of the directions of D. docs/design/implicit.md, Segments.

#include "lattice/lattice.h"
#include "matching/aligned_array.h"
#include "matching/node_state.h"

#include <Eigen/Geometry>

#include <vector>

namespace pliant {

class Segments
{
public:
	using Vector6 = Eigen::Matrix<double, 6, 1>;
	using Matrix6 = Eigen::Matrix<double, 6, 6>;
	/// Two segments that links connect, first > second.
	struct Pair
	{
		int first = 0, second = 0;
		int linkStart = 0, linkEnd = 0; ///< in m_links
		Matrix6 coupling = Matrix6::Zero();
	};

	/// Divides the cells of a lattice into cubes, and these into connected segments.
	void layOut( const Lattice& lattice );
	/// Measures masses and couplings at the current positions. `resistance`: of each node, in G m, as StrainRates::diagonal; so the links
	/// of soft cells resist less, and those at the surface. `stiffness`: G.
	void measure( const NodeState& nodes, double cellSize, const float* resistance, double stiffness );

	/// Lets a held node of a segment resist its motion with `resistance`, kg.
	void hold( int node, double resistance );

	int count() const { return m_count; }
	int of( int node ) const { return m_of[std::size_t( node )]; }
	const Eigen::Vector3d& centre( int segment ) const { return m_centre[std::size_t( segment )]; }
	/// The body's operator restricted to motions ( V, Omega ) of a segment about its centre.
	const Matrix6& own( int segment ) const { return m_own[std::size_t( segment )]; }
	const std::vector<Pair>& pairs() const { return m_pairs; }

	/// Sets `sums` to the forces and torques of `r` on the segments, six each.
	void sum( const NodeState& nodes, const float* r, double* sums ) const;
	/// z += the segments' motions, at free nodes.
	void addMotions( const NodeState& nodes, const double* motions, float* z ) const;

private:
	void divide( const Lattice& lattice, int edge );
	void listLinks( const Lattice& lattice );

	/// Consecutive nodes of one segment.
	struct Run
	{
		int begin = 0, end = 0, segment = 0;
	};
	int m_count = 0;
	std::vector<int> m_of; ///< segment of each node
	std::vector<Run> m_runs;
	std::vector<std::pair<int, int>> m_links; ///< between segments, sorted by pair: a cell of Pair::first, a cell of Pair::second
	std::vector<Pair> m_pairs;
	AlignedArray<float> m_arm[3];          ///< of each node from its segment's centre, m
	std::vector<Eigen::Vector3d> m_centre; ///< relative to the nodes' origin, m
	std::vector<Matrix6> m_own;
};

} // namespace pliant
