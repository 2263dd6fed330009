// The visibility graph and the search on it: Steinemann et al. 2008, section 6. Each is compared with its reference implementation.

#include "adapt/octree/bucket_moore.h"
#include "steinemann_bodies.h"

#include <gtest/gtest.h>

#include <queue>
#include <set>

namespace pliant {
namespace {

using test::makeFingers;
using test::makeRandomBlob;
using test::makeShapeLattice;
using test::RandomCut;

constexpr std::uint32_t kFar = 0xffffffffu;

std::vector<std::uint32_t> dijkstra( const VisibilityGraph& graph, std::uint32_t source )
{
	std::vector<std::uint32_t> least( std::size_t( graph.count() ), kFar );
	std::priority_queue<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::pair<std::uint32_t, std::uint32_t>>, std::greater<>>
		queue;
	queue.push( { 0, source } );
	least[source] = 0;
	while ( !queue.empty() )
	{
		const auto [d, node] = queue.top();
		queue.pop();
		for ( std::uint32_t e = graph.start[node]; e < graph.start[node + 1]; ++e )
		{
			if ( d + graph.length[e] < least[graph.to[e]] )
			{
				least[graph.to[e]] = d + graph.length[e];
				queue.push( { least[graph.to[e]], graph.to[e] } );
			}
		}
	}
	return least;
}

TEST( VisibilityGraph, OfFinestNodesIsTheLinks )
{
	const Lattice lattice = makeRandomBlob( 3 );
	const Octree octree = buildOctree( lattice, 0 );
	const Cut cut = selectCut( octree, []( std::uint32_t ) { return true; } );
	const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	ASSERT_EQ( graph.to.size(), lattice.linkTo.size() );
	for ( std::uint32_t i = 0; i < std::uint32_t( cut.count() ); ++i )
	{
		for ( std::uint32_t e = graph.start[i]; e < graph.start[i + 1]; ++e )
		{
			const std::uint32_t a = cut.node[i], b = cut.node[graph.to[e]];
			EXPECT_TRUE( std::binary_search( &lattice.linkTo[lattice.linkStart[a]], lattice.linkTo.data() + lattice.linkStart[a + 1], b ) );
			EXPECT_EQ( graph.length[e], kUnitsPerCell );
		}
	}
}

TEST( VisibilityGraph, JoinsLinkedNodesOnce )
{
	for ( unsigned seed = 1; seed <= 6; ++seed )
	{
		const Lattice lattice = seed == 6 ? makeFingers( 8, 4, 8 ) : makeRandomBlob( seed, 18 );
		const Octree octree = buildOctree( lattice, 3 );
		const Cut cut = RandomCut( octree, seed ).cut();
		const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
		std::set<std::pair<std::uint32_t, std::uint32_t>> wanted, found;
		for ( std::uint32_t c = 0; c < std::uint32_t( lattice.cellCount() ); ++c )
		{
			for ( std::uint32_t l = lattice.linkStart[c]; l < lattice.linkStart[c + 1]; ++l )
			{
				wanted.insert( { cut.slotOfCell[c], cut.slotOfCell[lattice.linkTo[l]] } );
			}
		}
		for ( std::uint32_t i = 0; i < std::uint32_t( cut.count() ); ++i )
		{
			wanted.erase( { i, i } );
			for ( std::uint32_t e = graph.start[i]; e < graph.start[i + 1]; ++e )
			{
				EXPECT_TRUE( found.insert( { i, graph.to[e] } ).second ) << "twice";
				const NodeBlock a = blockOf( octree, cut.node[i] ), b = blockOf( octree, cut.node[graph.to[e]] );
				EXPECT_EQ( graph.length[e], distance( a, b ) );
				EXPECT_EQ( graph.length[e], a.half + b.half ); // blocks that touch
				EXPECT_LE( graph.length[e], graph.longest );
				EXPECT_TRUE( e == graph.start[i] || graph.length[e - 1] <= graph.length[e] );
			}
		}
		EXPECT_EQ( found, wanted );
	}
}

/// The paper's graph: every pair within 2^l cells of the coarser one.
VisibilityGraph paperGraph( const Octree& octree, const Cut& cut )
{
	VisibilityGraph graph;
	graph.start.push_back( 0 );
	for ( const std::uint32_t a : cut.node )
	{
		for ( std::uint32_t j = 0; j < std::uint32_t( cut.count() ); ++j )
		{
			const NodeBlock from = blockOf( octree, a ), to = blockOf( octree, cut.node[j] );
			if ( cut.node[j] != a && distance( from, to ) <= 2 * std::max( from.half, to.half ) )
			{
				graph.to.push_back( j );
				graph.length.push_back( std::uint16_t( distance( from, to ) ) );
			}
		}
		graph.start.push_back( std::uint32_t( graph.to.size() ) );
	}
	return graph;
}

/// In full material no edge crosses the surface, and omitting edges longer than one link changes no distance.
TEST( VisibilityGraph, HasTheDistancesOfThePapersEdges )
{
	const Lattice lattice = makeShapeLattice( { 16, 19, 16 }, 0.1f, []( int, int, int ) { return true; } );
	const Octree octree = buildOctree( lattice, 4 );
	std::size_t more = 0;
	for ( unsigned seed = 1; seed <= 5; ++seed )
	{
		RandomCut switches( octree, seed );
		switches.keeps[octree.levelStart[4]] = 0; // otherwise almost everything is one node
		const Cut cut = switches.cut();
		const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut ), paper = paperGraph( octree, cut );
		more += paper.to.size() - graph.to.size();
		for ( std::uint32_t source = 0; source < std::uint32_t( cut.count() ); source += 11 )
		{
			EXPECT_EQ( dijkstra( graph, source ), dijkstra( paper, source ) );
		}
	}
	EXPECT_GT( more, 1000u );
}

/// Distance between the nodes that cover two positions.
std::uint32_t distanceBetween(
	const Lattice& lattice, const Octree& octree, const Cut& cut, const Eigen::Vector3i& a, const Eigen::Vector3i& b )
{
	std::uint32_t from = kNoNode, to = kNoNode;
	for ( int c = 0; c < lattice.cellCount(); ++c )
	{
		const Eigen::Vector3i at = lattice.coordinate[std::size_t( c )].cast<int>();
		from = at == a ? cut.slotOfCell[std::size_t( c )] : from;
		to = at == b ? cut.slotOfCell[std::size_t( c )] : to;
	}
	BucketMoore search;
	for ( const BucketMoore::Reached& r : search.from( buildVisibilityGraph( lattice, octree, cut ), from, 1000 ) )
	{
		if ( r.node == to )
		{
			return r.distance;
		}
	}
	return kFar;
}

TEST( VisibilityGraph, GoesAroundConcaveCorners )
{
	// L: two arms of 16 cells, two wide. Straight from tip to tip 15 cells; through the material 15 + 14, minus one at the inner corner.
	const Lattice l = makeShapeLattice( { 16, 16, 2 }, 1.0f, []( int x, int y, int ) { return x < 2 || y < 2; } );
	// U: legs of 12 cells, two wide, two apart, on a base of two.
	const Lattice u = makeShapeLattice( { 6, 14, 2 }, 1.0f, []( int x, int y, int ) { return y < 2 || x < 2 || x >= 4; } );
	// Two fingers, two wide, one empty cell between: their level 1 blocks touch.
	const Lattice pair = makeShapeLattice( { 5, 16, 2 }, 1.0f, []( int x, int y, int ) { return y < 4 || x != 2; } );
	for ( int level = 0; level <= 2; ++level )
	{
		const auto coarsest = []( std::uint32_t ) { return true; };
		const Octree ofL = buildOctree( l, level ), ofU = buildOctree( u, level ), ofPair = buildOctree( pair, level );
		const std::uint32_t aroundL = distanceBetween( l, ofL, selectCut( ofL, coarsest ), { 15, 0, 0 }, { 0, 15, 0 } );
		const std::uint32_t aroundU = distanceBetween( u, ofU, selectCut( ofU, coarsest ), { 0, 13, 0 }, { 5, 13, 0 } );
		const std::uint32_t aroundPair = distanceBetween( pair, ofPair, selectCut( ofPair, coarsest ), { 0, 15, 0 }, { 4, 15, 0 } );
		const std::uint32_t slack = kUnitsPerCell * ( 2u << level ); // coarse centres lie inside the arms
		EXPECT_GE( aroundL + slack, 2u * 28 );
		EXPECT_LE( aroundL, 2u * 30 );
		EXPECT_GE( aroundU + slack, 2u * 24 );
		EXPECT_LE( aroundU, 2u * 28 );
		EXPECT_GE( aroundPair + slack, 2u * 24 );
		EXPECT_LE( aroundPair, 2u * 28 );
	}
}

TEST( VisibilityGraph, NoEdgeCrossesBetweenFingers )
{
	const Lattice lattice = makeFingers( 6, 4, 18 );
	const Octree octree = buildOctree( lattice, 3 );
	const auto fingerOf = [&]( std::uint32_t node ) { // -1 for the palm and the blocks that overlap it
		int finger = -1;
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			const auto& at = lattice.coordinate[octree.cells[k]];
			if ( at.z() < 8 )
			{
				return -1;
			}
			finger = at.x() / 2;
		}
		return finger;
	};
	for ( unsigned seed = 1; seed <= 5; ++seed )
	{
		const Cut cut = RandomCut( octree, seed ).cut();
		const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
		int inFingers = 0;
		for ( std::uint32_t i = 0; i < std::uint32_t( cut.count() ); ++i )
		{
			for ( std::uint32_t e = graph.start[i]; e < graph.start[i + 1]; ++e )
			{
				const int a = fingerOf( cut.node[i] ), b = fingerOf( cut.node[graph.to[e]] );
				EXPECT_TRUE( a < 0 || b < 0 || a == b ) << a << " " << b;
				inFingers += a >= 0 && a == b;
			}
		}
		EXPECT_GT( inFingers, 0 );
	}
}

TEST( BucketMoore, FindsTheDistancesOfDijkstra )
{
	BucketMoore search; // one scratch memory for all graphs and sources
	for ( unsigned seed = 1; seed <= 6; ++seed )
	{
		const Lattice lattice = makeRandomBlob( seed );
		const Octree octree = buildOctree( lattice, int( seed % 4 ) );
		const Cut cut = RandomCut( octree, seed ).cut();
		const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
		for ( std::uint32_t source = 0; source < std::uint32_t( graph.count() ); source += 7 )
		{
			const std::vector<std::uint32_t> wanted = dijkstra( graph, source );
			for ( const std::uint32_t limit : { 0u, 1u, 3u, 8u, 13u, 1000u } )
			{
				std::vector<std::uint32_t> found( wanted.size(), kFar );
				std::uint32_t last = 0;
				for ( const BucketMoore::Reached& r : search.from( graph, source, limit ) )
				{
					EXPECT_EQ( found[r.node], kFar ) << "twice";
					EXPECT_GE( r.distance, last );
					found[r.node] = last = r.distance;
				}
				for ( std::size_t i = 0; i < wanted.size(); ++i )
				{
					ASSERT_EQ( found[i], wanted[i] < limit ? wanted[i] : kFar );
				}
			}
		}
	}
}

} // namespace
} // namespace pliant
