#pragma once

// Updates the base of the step's tables after links were removed or restored, or for a piece that came off; unchanged data is reused.
// Steinemann et al. 2008, section 5.1. buildLevelBase and buildLevelRegions are the reference implementations.

#include "adapt/octree/octree_update.h"
#include "matching/regions/level_tables.h"

namespace pliant {

struct LevelBaseUpdate
{
	std::shared_ptr<const LevelBase> base;
	std::vector<std::uint32_t> nodeBefore; ///< OctreeUpdate::nodeBefore
	std::vector<std::uint32_t> collected;  ///< FineUpdate::collected
};

/// Memory that an update can reuse.
struct LevelBaseScratch
{
	FineMoments moments; ///< the previous ones, moved from there; empty: they stay in place because others read them
	FineRegions fine;    ///< any unused ones
};

LevelBaseUpdate updateLevelBase( const LevelBase& before, LevelBaseScratch scratch, const CellChange& change );

/// Maps the nodes of the cut to those of the previous cut, which had the same cells. Empty where a node above the cells contains changed
/// links: it may hold other cells than any previous one.
RelinkedNodes relinkNodes( const Cut& before, const Cut& now, const LevelBaseUpdate& update, const std::vector<std::uint32_t>& cellBefore );

} // namespace pliant
