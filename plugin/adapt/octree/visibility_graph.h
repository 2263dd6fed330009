#pragma once

// Determines which nodes of a cut see one another, and their distances. Steinemann et al. 2008, section 6.1.
//
// The paper joins a node of level l to all others within d = 2^l finest cells, in max norm between centres, and then cuts the "edges that
// cross the surface at concave regions". Here the links determine them: the graph has exactly one edge for each pair of nodes with a finest
// link between their cells:
//   - linked nodes have touching blocks, so their centres are half an edge of each apart, which is within d;
//   - a pair within d whose blocks do not touch has, in full material, a chain of linked nodes in between that is no longer than the edge
//     (these nodes fill the gap exactly, and max norm ignores lateral offsets): the edge would change no distance;
//   - where there is no such chain, the edge crosses the surface or a crack and must be removed.
// So the graph is connected where the material is, distances are those of the paper's graph, and at the finest level edges are the links.
//
// Centres of different levels differ by half cells: lengths are integers in half cells, exact and equal from both sides.

#include "adapt/octree/cut.h"

#include <Eigen/Core>

namespace pliant {

/// Lengths are in half cells.
inline constexpr int kUnitsPerCell = 2;

struct VisibilityGraph
{
	/// Edges of slot i: start[i] .. start[i + 1], each stored once from either side, by length, then by slot.
	std::vector<std::uint32_t> start, to;
	std::vector<std::uint16_t> length; ///< half cells, at least 2
	int longest = 0;                   ///< of all edges

	int count() const { return start.empty() ? 0 : int( start.size() ) - 1; }
};

VisibilityGraph buildVisibilityGraph( const Lattice& lattice, const Octree& octree, const Cut& cut );

/// Centre of a node's block and half its edge, half cells.
struct NodeBlock
{
	Eigen::Vector3i centre = Eigen::Vector3i::Zero();
	int half = 1;
};

NodeBlock blockOf( const Octree& octree, std::uint32_t node );

/// Distance of centres in max norm, half cells.
inline int distance( const NodeBlock& a, const NodeBlock& b )
{
	return ( a.centre - b.centre ).cwiseAbs().maxCoeff();
}

} // namespace pliant
