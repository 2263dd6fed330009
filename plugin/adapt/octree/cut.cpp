#include "adapt/octree/cut.h"

#include <algorithm>
#include <cmath>

namespace pliant {

Cut selectCut( const Octree& octree, const std::function<bool( std::uint32_t )>& keeps )
{
	Cut cut;
	std::vector<std::uint32_t> stack;
	for ( std::uint32_t top = octree.levelStart[octree.levels]; top-- > octree.levelStart[octree.levels - 1]; )
	{
		stack.push_back( top );
	}
	while ( !stack.empty() )
	{
		const std::uint32_t node = stack.back();
		stack.pop_back();
		if ( octree.childStart[node] == octree.childStart[node + 1] || keeps( node ) )
		{
			cut.node.push_back( node );
			continue;
		}
		for ( std::uint32_t k = octree.childStart[node + 1]; k-- > octree.childStart[node]; )
		{
			stack.push_back( octree.child[k] );
		}
	}
	numberCells( octree, cut );
	return cut;
}

std::function<bool( std::uint32_t )> keepsByMass( const Octree& octree, float fraction )
{
	return [&octree, fraction](
			   std::uint32_t node ) { return octree.mass[node] >= double( fraction ) * std::ldexp( 1.0, 3 * octree.levelOf( node ) ); };
}

void numberCells( const Octree& octree, Cut& cut )
{
	cut.slotOfCell.resize( octree.cells.size() );
	for ( int slot = 0; slot < cut.count(); ++slot )
	{
		const std::uint32_t node = cut.node[slot];
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			cut.slotOfCell[octree.cells[k]] = std::uint32_t( slot );
		}
	}
}

Cut changeCut(
	const Octree& octree, const Cut& cut, const std::vector<std::uint32_t>& split, const std::vector<std::uint32_t>& merge, Cut scratch )
{
	const auto isBefore = [&octree]( std::uint32_t a, std::uint32_t b ) { return octree.cellStart[a] < octree.cellStart[b]; };
	std::vector<std::uint32_t> splits( split ), merges( merge );
	std::sort( splits.begin(), splits.end(), isBefore );
	std::sort( merges.begin(), merges.end(), isBefore );
	Cut changed = std::move( scratch );
	changed.node.clear();
	changed.node.reserve( cut.node.size() + 8 * split.size() );
	auto nextSplit = splits.begin();
	auto nextMerge = merges.begin();
	for ( std::size_t i = 0; i < cut.node.size(); )
	{
		const std::uint32_t node = cut.node[i];
		if ( nextSplit != splits.end() && *nextSplit == node )
		{
			const auto first = octree.child.begin() + octree.childStart[node], last = octree.child.begin() + octree.childStart[node + 1];
			changed.node.insert( changed.node.end(), first, last );
			++nextSplit;
			++i;
		}
		else if ( nextMerge != merges.end() && octree.cellStart[*nextMerge] == octree.cellStart[node] )
		{
			const std::uint32_t parent = *nextMerge++;
			changed.node.push_back( parent );
			i += octree.childStart[parent + 1] - octree.childStart[parent];
		}
		else
		{
			changed.node.push_back( node );
			++i;
		}
	}
	numberCells( octree, changed );
	return changed;
}

Status validate( const Cut& cut, const Octree& octree )
{
	std::uint32_t next = 0;
	for ( int slot = 0; slot < cut.count(); ++slot )
	{
		const std::uint32_t node = cut.node[slot];
		if ( node >= std::uint32_t( octree.nodeCount() ) || octree.cellStart[node] != next )
		{
			return Status{ ResultCode::BadArgument, "Cut: nodes overlap, omit cells, or are out of order." };
		}
		for ( std::uint32_t k = next; k < next + octree.cellCount[node]; ++k )
		{
			if ( cut.slotOfCell[octree.cells[k]] != std::uint32_t( slot ) )
			{
				return Status{ ResultCode::BadArgument, "Cut: a cell's slot is not the one that covers it." };
			}
		}
		next += octree.cellCount[node];
	}
	return next == octree.cells.size() ? Status{} : Status{ ResultCode::BadArgument, "Cut: cells are omitted." };
}

} // namespace pliant
