#include "adapt/regions/slot_change.h"

#include <algorithm>

namespace pliant {

SlotChange slotChange( const Octree& octree, const Cut& from, const Cut& to )
{
	SlotChange change;
	change.now.assign( from.node.size(), kNoNode );
	change.before.assign( to.node.size(), kNoNode );
	change.wasMerged.assign( to.node.size(), 0 );
	std::size_t i = 0, j = 0;
	while ( i < from.node.size() )
	{
		const std::uint32_t old = from.node[i], now = to.node[j];
		const std::uint32_t oldEnd = octree.cellStart[old] + octree.cellCount[old], nowEnd = octree.cellStart[now] + octree.cellCount[now];
		if ( old == now )
		{
			change.now[i] = std::uint32_t( j );
			change.before[j] = std::uint32_t( i );
		}
		else if ( octree.cellCount[now] >= octree.cellCount[old] ) // merged
		{
			change.now[i] = std::uint32_t( j );
			change.wasMerged[j] = 1;
		}
		i += oldEnd <= nowEnd ? 1 : 0;
		j += nowEnd <= oldEnd ? 1 : 0;
	}
	return change;
}

SlotChange slotChange( const RelinkedNodes& nodes )
{
	SlotChange change;
	change.now = nodes.now;
	change.before = nodes.before;
	change.wasMerged.assign( nodes.before.size(), 0 );
	for ( std::size_t slot = 0; slot < nodes.before.size(); ++slot )
	{
		if ( nodes.isNew[slot] != 0 )
		{
			change.now[nodes.before[slot]] = kNoNode;
			change.before[slot] = kNoNode;
		}
	}
	return change;
}

std::vector<std::uint32_t> slotsOutOfOrder( const std::vector<std::uint32_t>& now )
{
	std::vector<std::uint32_t> lowest( now.size() + 1, kNoNode ), moved; // lowest[i]: minimum of the numbers from i on; kNoNode exceeds all
	for ( std::size_t i = now.size(); i-- > 0; )
	{
		lowest[i] = std::min( lowest[i + 1], now[i] );
	}
	std::uint32_t highest = 0;
	for ( std::size_t i = 0; i < now.size(); ++i )
	{
		if ( now[i] != kNoNode )
		{
			if ( now[i] < highest || now[i] > lowest[i] )
			{
				moved.push_back( std::uint32_t( i ) );
			}
			highest = std::max( highest, now[i] );
		}
	}
	return moved;
}

} // namespace pliant
