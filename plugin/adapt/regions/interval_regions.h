#pragma once

// Regions by intervals of distance, as sums over octree nodes. Steinemann et al. 2008, sections 4.2, 5.2 and 5.3.
//
// A node nearer to i than w_i is in its region, one farther than ( 1 + eps ) w_i is not; what lies between may be. So a virtual node
// whose simulation nodes all lie within ( 1 + eps ) w_i, at least one of them within w_i, stands for all of them: a summation node.

#include "adapt/octree/visibility_graph.h"
#include "adapt/regions/region_matrix.h"

namespace pliant {

class TaskRunner;

/// The paper's choice; smaller keeps closer to w, larger takes fewer summation nodes.
inline constexpr float kIntervalEps = 0.5f;

/// w_i of each slot, half cells: `halfWidth` cells of the node's own level, w 2^l. At least 1 such cell: a node keeps its neighbours.
std::vector<std::uint32_t> intervalWidths( const Octree& octree, const Cut& cut, float halfWidth );

/// The same for a half-width that varies in space (Fig. 4), given for each finest cell: the mean over those of the node.
std::vector<std::uint32_t> intervalWidths( const Octree& octree, const Cut& cut, const std::vector<float>& halfWidthOfCell );

/// The same width for all, `halfWidth` finest cells, but not less than the spacing of the node's own level: max( w, 2^l ).
std::vector<std::uint32_t> constantWidths( const Octree& octree, const Cut& cut, float halfWidth );

struct IntervalRegions
{
	float eps = kIntervalEps;
	std::vector<std::uint32_t> width; ///< w_i of each slot, half cells

	/// Steps 1 and 2, before symmetry: summation nodes of slot i, ids of octree nodes in depth-first order.
	std::vector<std::uint32_t> ownStart, own;

	/// Step 3: i is in the region of j exactly when j is in that of i. The larger of both regions decides (the union): only so is
	/// everything nearer than w_i in region i, and a fine node coupled to the coarse one beside it, which lies farther off than the fine
	/// node's own ( 1 + eps ) w. The rows name the largest octree nodes all of whose simulation nodes are in.
	std::vector<std::uint32_t> start, node;

	int count() const { return start.empty() ? 0 : int( start.size() ) - 1; }
	std::size_t bytes() const
	{
		return ( width.size() + ownStart.size() + own.size() + start.size() + node.size() ) * sizeof( std::uint32_t );
	}
};

/// What regions are found in.
struct IntervalInput
{
	const Octree& octree;
	const Cut& cut;
	const VisibilityGraph& graph;
};

/// `runner` may be null. Widths are kept within the result.
IntervalRegions findIntervalRegions(
	const IntervalInput& input, std::vector<std::uint32_t> width, float eps, TaskRunner* runner = nullptr );

struct IntervalUpdate
{
	IntervalRegions regions;             ///< equal to those found from nothing
	std::vector<std::uint32_t> searched; ///< slots whose steps 1 and 2 were done anew, ascending
};

/// N_update. The paper names new nodes and those whose region held a removed one (5.2). That leaves out nodes which a removed node's
/// edges served on the way, between w and ( 1 + eps ) w, and those a new node has come within reach of: here all are searched anew that
/// had a removed node, or have a new one, nearer than ( 1 + eps ) w_i, besides those whose width is not what it was.
IntervalUpdate updateIntervalRegions( const IntervalInput& from, const IntervalInput& to, const CutChange& change,
	const IntervalRegions& old, std::vector<std::uint32_t> width, TaskRunner* runner = nullptr );

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

/// The same for all nodes of the cut and above it at once, for walks over many rows.
std::vector<SlotSpan> slotSpans( const Octree& octree, const Cut& cut );

/// How masses enter where regions are plain sets of nodes; n_a regions hold node a, and M_a is the mass of their owners.
enum class IntervalWeights : int
{
	Literal,         ///< eq. 6 to 8: m_a in sums, m_r in goals
	Conserving,      ///< u( a, r ) = m_a / n_a, goals by the transpose
	ConservingByMass ///< u( a, r ) = m_a m_r / M_a, goals by the transpose: they are those of eq. 8
};

/// The regions with all their simulation nodes, for a step that knows nothing of virtual ones.
RegionMatrix buildIntervalRegions( const Octree& octree, const Cut& cut, const IntervalRegions& intervals, IntervalWeights weights );

} // namespace pliant
