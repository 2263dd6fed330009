#include "adapt/octree/visibility_graph.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace pliant {

NodeBlock blockOf( const Octree& octree, std::uint32_t node )
{
	const int level = octree.levelOf( node );
	// Block c spans the cells c 2^l to ( c + 1 ) 2^l: its centre is at ( 2 c + 1 ) 2^l half cells.
	return { ( octree.coordinate[node].cast<int>() * 2 + Eigen::Vector3i::Ones() ) * ( 1 << level ), 1 << level };
}

VisibilityGraph buildVisibilityGraph( const Lattice& lattice, const Octree& octree, const Cut& cut )
{
	VisibilityGraph graph;
	graph.start.assign( 1, 0 );
	std::vector<NodeBlock> blocks;
	std::transform( cut.node.begin(), cut.node.end(), std::back_inserter( blocks ),
		[&octree]( std::uint32_t node ) { return blockOf( octree, node ); } );
	std::vector<std::uint32_t> seenFrom( cut.node.size(), kNoNode ); // of each slot: the last slot from which it was visited
	std::vector<std::pair<std::uint16_t, std::uint32_t>> row;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( cut.count() ); ++slot )
	{
		const std::uint32_t node = cut.node[slot];
		row.clear();
		seenFrom[slot] = slot;
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			const std::uint32_t cell = octree.cells[k];
			for ( std::uint32_t l = lattice.linkStart[cell]; l < lattice.linkStart[cell + 1]; ++l )
			{
				const std::uint32_t other = cut.slotOfCell[lattice.linkTo[l]];
				if ( std::exchange( seenFrom[other], slot ) != slot )
				{
					row.emplace_back( std::uint16_t( distance( blocks[slot], blocks[other] ) ), other );
				}
			}
		}
		std::sort( row.begin(), row.end() );
		for ( const auto& [length, to] : row )
		{
			graph.length.push_back( length );
			graph.to.push_back( to );
			graph.longest = std::max( graph.longest, int( length ) );
		}
		graph.start.push_back( std::uint32_t( graph.to.size() ) );
	}
	return graph;
}

} // namespace pliant
