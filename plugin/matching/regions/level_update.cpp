#include "matching/regions/level_update.h"

#include "adapt/moments/fine_update.h"

#include <utility>

namespace pliant {

LevelBaseUpdate updateLevelBase( const LevelBase& before, LevelBaseScratch scratch, const CellChange& change )
{
	OctreeUpdate tree = updateOctree( before.octree, change );
	FineUpdate fine = updateFineRegions( before.fine, change, tree, std::move( scratch.fine ) );
	auto base = std::make_shared<LevelBase>();
	if ( !scratch.moments.covariance.empty() || !before.moments.covariance.empty() )
	{
		base->moments = updateFineMoments( before.moments, std::move( scratch.moments ), change, tree, fine );
	}
	base->octree = std::move( tree.octree );
	base->fine = std::move( fine.fine );
	return LevelBaseUpdate{ std::move( base ), std::move( tree.nodeBefore ), std::move( fine.collected ) };
}

RelinkedNodes relinkNodes( const Cut& before, const Cut& now, const LevelBaseUpdate& update, const std::vector<std::uint32_t>& cellBefore )
{
	const Octree& octree = update.base->octree;
	RelinkedNodes nodes;
	nodes.now.assign( before.node.size(), kNoNode );
	nodes.before.reserve( now.node.size() );
	for ( std::uint32_t slot = 0; slot < std::uint32_t( now.count() ); ++slot )
	{
		const std::uint32_t node = now.node[slot];
		if ( update.nodeBefore[node] == kNoNode )
		{
			return {};
		}
		const std::uint32_t old = before.slotOfCell[cellBefore[octree.cells[octree.cellStart[node]]]];
		nodes.before.push_back( old );
		nodes.now[old] = slot;
	}
	nodes.isNew.assign( now.node.size(), 0 );
	for ( const std::uint32_t cell : update.collected )
	{
		nodes.isNew[now.slotOfCell[cell]] = 1;
	}
	return nodes;
}

} // namespace pliant
