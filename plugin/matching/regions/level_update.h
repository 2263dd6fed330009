#pragma once

// What the tables of the step are made from, after links have gone or come back, or of a piece that came off: taken over where nothing
// changed. Steinemann et al. 2008, section 5.1. buildLevelBase and buildLevelRegions are the slow twins.

#include "adapt/octree/octree_update.h"
#include "matching/regions/level_tables.h"

namespace pliant {

struct LevelBaseUpdate
{
	std::shared_ptr<const LevelBase> base;
	std::vector<std::uint32_t> nodeBefore; ///< OctreeUpdate::nodeBefore
	std::vector<std::uint32_t> collected;  ///< FineUpdate::collected
};

/// What an update need not ask the system for.
struct LevelBaseScratch
{
	FineMoments moments; ///< those before, taken from there; empty: they stay there, for others look at them
	FineRegions fine;    ///< any that nobody uses any more
};

LevelBaseUpdate updateLevelBase( const LevelBase& before, LevelBaseScratch scratch, const CellChange& change );

/// How the nodes of the cut stand to those before, which had the same cells. Empty where a node above the cells is one in which links
/// changed: it may hold other cells than any before.
RelinkedNodes relinkNodes( const Cut& before, const Cut& now, const LevelBaseUpdate& update, const std::vector<std::uint32_t>& cellBefore );

} // namespace pliant
