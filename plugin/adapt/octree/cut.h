#pragma once

// The simulated nodes of the octree: a cut through it, so that each finest cell is under exactly one of them. Steinemann et al. 2008,
// section 4.1 (leaves of an adaptive octree); Ohta et al. 2009, "Preprocessing" (selection by mass).

#include "adapt/octree/octree.h"

#include <functional>

namespace pliant {

/// Simulation nodes in the octree's depth-first order. The arrays depend only on the set of nodes in the cut, not on its history.
struct Cut
{
	std::vector<std::uint32_t> node;       ///< octree node of each slot
	std::vector<std::uint32_t> slotOfCell; ///< slot that covers a finest cell

	int count() const { return int( node.size() ); }
};

/// From the highest level down: a node is in the cut where `keeps` holds, else its children are tested. Finest cells are always kept.
Cut selectCut( const Octree& octree, const std::function<bool( std::uint32_t node )>& keeps );

/// Ohta's rule: a node of level l is kept where its mass is at least `fraction` 8^l finest cells; otherwise its children are. In (0, 1].
std::function<bool( std::uint32_t )> keepsByMass( const Octree& octree, float fraction );

/// Fills slotOfCell from `node`, which must be a cut in depth-first order.
void numberCells( const Octree& octree, Cut& cut );

/// Returns the cut with some nodes replaced by their children (`split`) and some sets of children by their parents (`merge`). Both lists
/// contain octree nodes; a node to merge has all its children in the cut, a node to split is in the cut and has children. `scratch`: an
/// unused cut whose memory is reused.
Cut changeCut( const Octree& octree, const Cut& cut, const std::vector<std::uint32_t>& split, const std::vector<std::uint32_t>& merge,
	Cut scratch = {} );

/// Checks that the cut is in depth-first order and covers every cell once; the message names the violation.
Status validate( const Cut& cut, const Octree& octree );

} // namespace pliant
