#pragma once

// Which nodes of the octree are simulated: a cut through it, so that each finest cell is under exactly one of them.
// Steinemann et al. 2008, section 4.1 (leaves of an adaptive octree); Ohta et al. 2009, "Preprocessing" (selection by mass).

#include "adapt/octree/octree.h"

#include <functional>

namespace pliant {

/// Simulation nodes in the octree's depth-first order. What the arrays hold depends on which nodes are in the cut alone,
/// never on how it came about.
struct Cut
{
	std::vector<std::uint32_t> node;       ///< octree node of each slot
	std::vector<std::uint32_t> slotOfCell; ///< slot that covers a finest cell

	int count() const { return int( node.size() ); }
};

/// From the highest level down: a node that `keeps` says yes to is in the cut, else its children are asked. Finest cells are not asked.
Cut selectCut( const Octree& octree, const std::function<bool( std::uint32_t node )>& keeps );

/// Ohta's rule: a node of level l is kept where its mass is at least `share` 8^l finest cells; else its children are. `share` in (0, 1].
std::function<bool( std::uint32_t )> keepsByMass( const Octree& octree, float fraction );

/// Nodes without a surface cell are kept.
std::function<bool( std::uint32_t )> keepsInside( const Octree& octree );

/// Fills slotOfCell from `node`, which must be a cut in depth-first order.
void numberCells( const Octree& octree, Cut& cut );

/// A cut with some nodes replaced by their children (`split`) and some parents put in the place of all their children (`merge`).
/// Both lists name octree nodes; a node to merge has all its children in the cut, a node to split is in the cut and has children.
/// `room`: a cut that nobody needs, for its memory.
Cut changeCut( const Octree& octree, const Cut& cut, const std::vector<std::uint32_t>& split, const std::vector<std::uint32_t>& merge,
	Cut scratch = {} );

/// In depth-first order, every cell covered once; the sentence names what is broken.
Status validate( const Cut& cut, const Octree& octree );

} // namespace pliant
