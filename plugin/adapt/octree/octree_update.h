#pragma once

// Updates an octree whose lattice has lost or gained links, or consists of a subset of the former cells: nodes above cells with unchanged
// links are reused. Steinemann et al. 2008, section 5.1 (cuts change the octree only near the blade). buildOctree is the reference
// implementation.

#include "adapt/octree/octree.h"

namespace pliant {

/// A change of a lattice's cells.
struct CellChange
{
	const Lattice& before;
	const Lattice& now;
	const std::vector<std::uint32_t>& cellBefore; ///< of each cell now: its number before; ascending
	std::vector<std::uint32_t> touched;           ///< cells now that lost or gained links; ascending

	/// True where all cells remain, under the same numbers.
	bool isWhole() const { return now.fill.size() == before.fill.size(); }
};

struct OctreeUpdate
{
	Octree octree;
	/// Of each node: the former node with the same cells and links; kNoNode where there was none. Of a finest cell: its former number,
	/// touched or not.
	std::vector<std::uint32_t> nodeBefore;
	std::vector<std::uint32_t> nodeNow; ///< the inverse map
};

/// Bitwise equal to buildOctree( change.now, ... ) where change.isWhole(). Otherwise the former rest centres are shifted by the difference
/// of the mass centres: equal except for rounding.
OctreeUpdate updateOctree( const Octree& before, const CellChange& change );

} // namespace pliant
