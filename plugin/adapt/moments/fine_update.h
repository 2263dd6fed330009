#pragma once

// Finest regions and their moments after links have gone or come back: those near such links are made anew, the others taken over.
// buildFineRegions and buildFineMoments are the slow twins.

#include "adapt/moments/fine_moments.h"
#include "adapt/octree/octree_update.h"

namespace pliant {

struct FineUpdate
{
	FineRegions fine; ///< but for RegionSet::isFullCubes, which nobody asks of them
	std::vector<std::uint32_t>
		collected; ///< cells whose regions were made anew, ascending: all whose regions hold other cells, and all that weigh other shares
};

/// `tree`: of the same change. `room`: regions that nobody uses any more, to be written over.
FineUpdate updateFineRegions( const FineRegions& before, const CellChange& change, const OctreeUpdate& tree, FineRegions scratch = {} );

/// `taken`: those before, which then change in place; empty: they stay where they are.
FineMoments updateFineMoments(
	const FineMoments& before, FineMoments taken, const CellChange& change, const OctreeUpdate& tree, const FineUpdate& fine );

} // namespace pliant
