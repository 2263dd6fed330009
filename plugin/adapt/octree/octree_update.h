#pragma once

// An octree whose cells have lost links, or got some back, or are only some of those there were: the nodes above cells that kept
// their links are taken over. Steinemann et al. 2008, section 5.1 (cuts change the octree near the blade alone). buildOctree is the slow
// twin.

#include "adapt/octree/octree.h"

namespace pliant {

/// What became of a lattice's cells.
struct CellChange
{
	const Lattice& before;
	const Lattice& now;
	const std::vector<std::uint32_t>& cellBefore; ///< of each cell now: its number before; ascending
	std::vector<std::uint32_t> touched;           ///< cells now that lost links or got some; ascending

	/// The same cells under the same numbers.
	bool isWhole() const { return now.fill.size() == before.fill.size(); }
};

struct OctreeUpdate
{
	Octree octree;
	/// Of each node: the node before that had the same cells, linked as they are now; kNoNode where there was none. Of a finest cell: what
	/// it was, touched or not.
	std::vector<std::uint32_t> nodeBefore;
	std::vector<std::uint32_t> nodeNow; ///< the other way round
};

/// Equal to buildOctree( change.now, ... ) to the bit where change.isWhole(). Else its places are those before, moved by the difference of
/// the mass centres: equal but for rounding.
OctreeUpdate updateOctree( const Octree& before, const CellChange& change );

} // namespace pliant
