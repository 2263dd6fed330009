#pragma once

// Regions by intervals of distance, as sums over octree nodes. Steinemann et al. 2008, sections 4.2, 5.2 and 5.3.
//
// A node within w_i of i is in its region, one beyond ( 1 + eps ) w_i is not; nodes in between are optional. A virtual node whose
// simulation nodes all lie within ( 1 + eps ) w_i, and at least one of them within w_i, therefore represents all of them: a summation node.

#include "adapt/constants.h"
#include "adapt/octree/visibility_graph.h"
#include "adapt/regions/region_matrix.h"

namespace pliant {

class TaskRunner;

/// Returns w_i of each slot, half cells: `halfWidth` cells of the node's own level, w 2^l, at least 1 to include its neighbours.
std::vector<std::uint32_t> intervalWidths( const Octree& octree, const Cut& cut, float halfWidth );

struct IntervalRegions
{
	float eps = kIntervalEps;
	std::vector<std::uint32_t> width; ///< w_i of each slot, half cells

	/// Summation nodes of each slot, ids of octree nodes in depth-first order: i is in the region of j exactly when j is in that of i. The
	/// union of both relations is taken: only then is every node within w_i in region i, and a fine node is coupled to the adjacent coarse
	/// one, which is farther than the fine node's own ( 1 + eps ) w. The rows list the largest octree nodes whose simulation nodes are all
	/// in the region.
	std::vector<std::uint32_t> start, node;

	int count() const { return start.empty() ? 0 : int( start.size() ) - 1; }
};

/// Input of the region search.
struct IntervalInput
{
	const Octree& octree;
	const Cut& cut;
	const VisibilityGraph& graph;
};

/// `runner` may be null. The result stores the widths.
IntervalRegions findIntervalRegions(
	const IntervalInput& input, std::vector<std::uint32_t> width, float eps, TaskRunner* runner = nullptr );

/// Simulation nodes under an octree node: slots first .. end - 1. Only for nodes of the cut and above it.
struct SlotSpan
{
	std::uint32_t first, end;
};
inline SlotSpan slotsUnder( const Octree& octree, const Cut& cut, std::uint32_t node )
{
	const std::uint32_t start = octree.cellStart[node];
	return { cut.slotOfCell[octree.cells[start]], cut.slotOfCell[octree.cells[start + octree.cellCount[node] - 1]] + 1 };
}

/// The same for all nodes of the cut and above it at once, for traversals of many rows.
std::vector<SlotSpan> slotSpans( const Octree& octree, const Cut& cut );

/// Mass weights where regions are plain sets of nodes; n_a regions hold node a, and M_a is the mass of their owners.
enum class IntervalWeights : int
{
	Literal,         ///< eq. 6 to 8: m_a in sums, m_r in goals
	Conserving,      ///< u( a, r ) = m_a / n_a, goals by the transpose
	ConservingByMass ///< u( a, r ) = m_a m_r / M_a, goals by the transpose: they are those of eq. 8
};

/// Returns the regions with all their simulation nodes, for a step without virtual nodes.
RegionMatrix buildIntervalRegions( const Octree& octree, const Cut& cut, const IntervalRegions& intervals, IntervalWeights weights );

} // namespace pliant
