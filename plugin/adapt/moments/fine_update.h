#pragma once

// Updates the finest regions and their moments after links were removed or added: those near such links are rebuilt, the others reused.
// buildFineRegions and buildFineMoments are the reference implementations.

#include "adapt/moments/fine_moments.h"
#include "adapt/octree/octree_update.h"

namespace pliant {

struct FineUpdate
{
	FineRegions fine; ///< without RegionSet::isFullCubes, which is not needed for them
	/// Cells whose regions were rebuilt, ascending: those whose regions hold other cells or whose weight changed.
	std::vector<std::uint32_t> collected;
};

/// `tree`: of the same change. `scratch`: unused regions whose memory is overwritten.
FineUpdate updateFineRegions( const FineRegions& before, const CellChange& change, const OctreeUpdate& tree, FineRegions scratch = {} );

/// `reused`: the former moments, which are modified in place; if empty, `before` is copied instead.
FineMoments updateFineMoments(
	const FineMoments& before, FineMoments reused, const CellChange& change, const OctreeUpdate& tree, const FineUpdate& fine );

} // namespace pliant
