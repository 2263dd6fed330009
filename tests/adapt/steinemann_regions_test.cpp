// Regions by intervals: Steinemann et al. 2008, sections 4.2 and 5. The reference implementation is the paper's listing.

#include "adapt/regions/interval_regions.h"
#include "pliant/task_runner.h"
#include "steinemann_bodies.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>
#include <numeric>
#include <set>

namespace pliant {
namespace {

using test::makeFingers;
using test::makeRandomBlob;
using test::RandomCut;

constexpr std::uint32_t kFar = std::numeric_limits<std::uint32_t>::max();

void expectEqual( const IntervalRegions& a, const IntervalRegions& b )
{
	EXPECT_EQ( a.width, b.width );
	EXPECT_EQ( a.start, b.start );
	EXPECT_EQ( a.node, b.node );
}

/// Distances from one node to all, by passes over all edges until none shortens (Bellman and Ford).
std::vector<std::uint32_t> allDistances( const VisibilityGraph& graph, std::uint32_t source )
{
	std::vector<std::uint32_t> least( std::size_t( graph.count() ), kFar );
	least[source] = 0;
	for ( bool isShorter = true; isShorter; )
	{
		isShorter = false;
		for ( std::uint32_t i = 0; i < std::uint32_t( graph.count() ); ++i )
		{
			for ( std::uint32_t e = graph.start[i]; e < graph.start[i + 1] && least[i] != kFar; ++e )
			{
				if ( least[i] + graph.length[e] < least[graph.to[e]] )
				{
					least[graph.to[e]] = least[i] + graph.length[e];
					isShorter = true;
				}
			}
		}
	}
	return least;
}

/// The listing of section 4.2 for one owner, with [a, b] of every octree node computed.
struct PlainListing
{
	const Octree& octree;
	const Cut& cut;
	const std::vector<std::uint32_t>& distance;
	double width, eps;
	std::set<std::uint32_t> slots;

	bool isSimulated( std::uint32_t node ) const { return cut.node[slotsUnder( octree, cut, node ).first] == node; }

	std::pair<double, double> interval( std::uint32_t node ) const
	{
		double a = std::numeric_limits<double>::infinity(), b = 0.0;
		const SlotSpan span = slotsUnder( octree, cut, node );
		for ( std::uint32_t slot = span.first; slot < span.end; ++slot )
		{
			const double d = distance[slot] == kFar ? std::numeric_limits<double>::infinity() : double( distance[slot] );
			a = std::min( a, d );
			b = std::max( b, d );
		}
		return { a, b };
	}

	void visit( std::uint32_t node )
	{
		const auto [a, b] = interval( node );
		if ( a > width )
		{
			return;
		}
		if ( b < ( 1.0 + eps ) * width ||
			b <= width ) // the second condition: at eps 0 a node at distance w is inside, as in a lattice (3.2)
		{
			const SlotSpan span = slotsUnder( octree, cut, node );
			for ( std::uint32_t slot = span.first; slot < span.end; ++slot )
			{
				slots.insert( slot );
			}
			return;
		}
		for ( std::uint32_t k = octree.childStart[node]; k < octree.childStart[node + 1]; ++k )
		{
			visit( octree.child[k] );
		}
	}

	/// From the top down, the first nodes all of whose slots are in the set.
	void name( std::uint32_t node, const std::set<std::uint32_t>& members, std::vector<std::uint32_t>& named ) const
	{
		const SlotSpan span = slotsUnder( octree, cut, node );
		const auto first = members.lower_bound( span.first ), end = members.lower_bound( span.end );
		if ( std::uint32_t( std::distance( first, end ) ) == span.end - span.first )
		{
			named.push_back( node );
		}
		else if ( first != end )
		{
			for ( std::uint32_t k = octree.childStart[node]; k < octree.childStart[node + 1]; ++k )
			{
				name( octree.child[k], members, named );
			}
		}
	}
};

std::vector<std::set<std::uint32_t>> plainRegions(
	const IntervalInput& input, const std::vector<std::uint32_t>& width, double eps, std::vector<std::vector<std::uint32_t>>& named )
{
	const std::size_t n = std::size_t( input.cut.count() );
	const Octree& octree = input.octree;
	const auto forEachTop = [&]( const auto& what ) {
		for ( std::uint32_t top = octree.levelStart[octree.levels - 1]; top < octree.levelStart[octree.levels]; ++top )
		{
			what( top );
		}
	};
	std::vector<std::set<std::uint32_t>> own( n );
	for ( std::uint32_t i = 0; i < n; ++i )
	{
		const std::vector<std::uint32_t> d = allDistances( input.graph, i );
		PlainListing listing{ octree, input.cut, d, double( width[i] ), eps, {} };
		forEachTop( [&]( std::uint32_t top ) { listing.visit( top ); } );
		own[i] = listing.slots;
	}
	std::vector<std::set<std::uint32_t>> both = own;
	for ( std::uint32_t i = 0; i < n; ++i )
	{
		for ( const std::uint32_t j : own[i] )
		{
			both[j].insert( i );
		}
	}
	const std::vector<std::uint32_t> none;
	named.assign( n, {} );
	for ( std::uint32_t i = 0; i < n; ++i )
	{
		const PlainListing listing{ octree, input.cut, none, 0.0, 0.0, {} };
		forEachTop( [&]( std::uint32_t top ) { listing.name( top, both[i], named[i] ); } );
	}
	return both;
}

TEST( IntervalRegions, AreThoseOfThePapersListing )
{
	for ( unsigned seed = 1; seed <= 6; ++seed )
	{
		const Lattice lattice = seed == 6 ? makeFingers( 6, 3, 8 ) : makeRandomBlob( seed, 11 );
		const Octree octree = buildOctree( lattice, 3 );
		const Cut cut = RandomCut( octree, seed ).cut();
		const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
		const IntervalInput input{ octree, cut, graph };
		const std::vector<std::uint32_t> width = intervalWidths( octree, cut, seed % 2 ? 1.0f : 1.75f );
		for ( const float eps : { 0.0f, 0.25f, 0.5f, 1.0f } )
		{
			const IntervalRegions regions = findIntervalRegions( input, width, eps );
			std::vector<std::vector<std::uint32_t>> named;
			const auto wanted = plainRegions( input, width, eps, named );
			const RegionMatrix matrix = buildIntervalRegions( octree, cut, regions, IntervalWeights::Literal );
			ASSERT_EQ( regions.count(), cut.count() );
			for ( std::uint32_t r = 0; r < std::uint32_t( cut.count() ); ++r )
			{
				std::vector<std::uint32_t> row( regions.node.begin() + regions.start[r], regions.node.begin() + regions.start[r + 1] );
				const auto isBefore = [&]( std::uint32_t a, std::uint32_t b ) { return octree.cellStart[a] < octree.cellStart[b]; };
				EXPECT_TRUE( std::is_sorted( row.begin(), row.end(), isBefore ) );
				std::sort( named[r].begin(), named[r].end(), isBefore );
				ASSERT_EQ( row, named[r] );
				const std::vector<std::uint32_t> members(
					matrix.member.begin() + matrix.start[r], matrix.member.begin() + matrix.start[r + 1] );
				ASSERT_EQ( members, std::vector<std::uint32_t>( wanted[r].begin(), wanted[r].end() ) );
			}
		}
	}
}

/// The property that the listing ensures: nodes nearer than w are inside, nodes farther than ( 1 + eps ) w outside, seen from either node.
TEST( IntervalRegions, HoldWhatIsNearAndNothingFar )
{
	const float eps = 0.5f;
	const Lattice lattice = makeRandomBlob( 8 );
	const Octree octree = buildOctree( lattice, 3 );
	const Cut cut = RandomCut( octree, 8 ).cut();
	const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	const std::vector<std::uint32_t> width = intervalWidths( octree, cut, 1.5f );
	const IntervalRegions regions = findIntervalRegions( { octree, cut, graph }, width, eps );
	const RegionMatrix matrix = buildIntervalRegions( octree, cut, regions, IntervalWeights::Literal );
	for ( std::uint32_t i = 0; i < std::uint32_t( cut.count() ); ++i )
	{
		const std::vector<std::uint32_t> d = allDistances( graph, i );
		for ( std::uint32_t j = 0; j < std::uint32_t( cut.count() ); ++j )
		{
			const bool isIn = std::binary_search( matrix.member.begin() + matrix.start[i], matrix.member.begin() + matrix.start[i + 1], j );
			const double w = std::max( width[i], width[j] ); // the larger width counts
			EXPECT_TRUE( isIn || d[j] > w );
			EXPECT_TRUE( !isIn || d[j] < ( 1.0 + eps ) * w );
		}
	}
}

/// At the finest level and eps 0 the regions are those of lattice shape matching, and the conserving weights are its m / n.
TEST( IntervalRegions, OfFinestNodesAreTheLattices )
{
	const Lattice lattice = makeRandomBlob( 2, 12 );
	const Octree octree = buildOctree( lattice, 3 );
	const Cut cut = selectCut( octree, []( std::uint32_t ) { return false; } );
	const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	for ( int w = 1; w <= 3; ++w )
	{
		const IntervalRegions regions = findIntervalRegions( { octree, cut, graph }, intervalWidths( octree, cut, float( w ) ), 0.0f );
		const RegionMatrix found = buildIntervalRegions( octree, cut, regions, IntervalWeights::Conserving );
		const RegionMatrix wanted = buildMultiplicityRegions( octree, cut, buildFineRegions( lattice, w ) );
		EXPECT_EQ( found.start, wanted.start );
		EXPECT_EQ( found.member, wanted.member );
		EXPECT_EQ( found.mass, wanted.mass );
		EXPECT_EQ( found.fraction, wanted.fraction );
		EXPECT_EQ( found.unit, wanted.unit );
		EXPECT_LT( regions.node.size(), found.member.size() ); // virtual nodes represent all of their cells
	}
}

TEST( IntervalRegions, ConservingWeightsAreTheirOwnTransposeAndFractionAllMass )
{
	const Lattice lattice = makeRandomBlob( 6 );
	const Octree octree = buildOctree( lattice, 3 );
	const Cut cut = RandomCut( octree, 6 ).cut();
	const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	const IntervalRegions regions = findIntervalRegions( { octree, cut, graph }, intervalWidths( octree, cut, 1.0f ), kIntervalEps );
	for ( const IntervalWeights weights : { IntervalWeights::Conserving, IntervalWeights::ConservingByMass } )
	{
		const RegionMatrix matrix = buildIntervalRegions( octree, cut, regions, weights );
		for ( std::uint32_t r = 0; r < std::uint32_t( cut.count() ); ++r )
		{
			double shared = 0.0;
			for ( std::uint32_t k = matrix.start[r]; k < matrix.start[r + 1]; ++k )
			{
				const auto row = matrix.member.begin() + matrix.start[matrix.member[k]],
						   end = matrix.member.begin() + matrix.start[matrix.member[k] + 1];
				const auto back = std::lower_bound( row, end, r );
				ASSERT_TRUE( back != end && *back == r );
				EXPECT_EQ( matrix.fraction[k], matrix.mass[std::size_t( back - matrix.member.begin() )] );
				shared += matrix.fraction[k] * matrix.unit[r];
			}
			EXPECT_NEAR( shared / octree.mass[cut.node[r]], 1.0, 1e-12 );
			EXPECT_NEAR( matrix.unit[r] / kMassUnit, 1.0, 1e-4 );
		}
	}
	const RegionMatrix literal = buildIntervalRegions( octree, cut, regions, IntervalWeights::Literal );
	for ( std::size_t k = 0; k < literal.member.size(); ++k )
	{
		EXPECT_NEAR( literal.mass[k] * kMassUnit, octree.mass[cut.node[literal.member[k]]], kMassUnit );
		EXPECT_EQ( literal.fraction[k], literal.mass[k] );
	}
}

/// Half-widths that vary in space (Fig. 4), given for each finest cell: the mean over the node's cells, in half cells.
std::vector<std::uint32_t> widthsOf( const Octree& octree, const Cut& cut, const std::vector<float>& halfWidthOfCell )
{
	std::vector<std::uint32_t> width;
	for ( const std::uint32_t node : cut.node )
	{
		double sum = 0.0;
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			sum += double( halfWidthOfCell[octree.cells[k]] );
		}
		const double half = std::max( 1.0, sum / octree.cellCount[node] );
		width.push_back( std::uint32_t( std::round( std::ldexp( kUnitsPerCell * half, octree.levelOf( node ) ) ) ) );
	}
	return width;
}

TEST( IntervalRegions, WidthsVaryInSpace )
{
	const Lattice lattice = test::makeShapeLattice( { 16, 4, 4 }, 0.1f, []( int, int, int ) { return true; } );
	const Octree octree = buildOctree( lattice, 2 );
	const Cut cut = selectCut( octree, [&]( std::uint32_t n ) { return octree.levelOf( n ) == 1; } );
	std::vector<float> field;
	for ( const auto& at : lattice.coordinate )
	{
		field.push_back( at.x() < 8 ? 1.0f : 2.0f );
	}
	const std::vector<std::uint32_t> width = widthsOf( octree, cut, field ), plain = intervalWidths( octree, cut, 1.0f );
	const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	const RegionMatrix soft = buildIntervalRegions(
		octree, cut, findIntervalRegions( { octree, cut, graph }, plain, 0.5f ), IntervalWeights::Literal );
	const RegionMatrix hard = buildIntervalRegions(
		octree, cut, findIntervalRegions( { octree, cut, graph }, width, 0.5f ), IntervalWeights::Literal );
	for ( std::uint32_t r = 0; r < std::uint32_t( cut.count() ); ++r )
	{
		const int x = octree.coordinate[cut.node[r]].x(); // 0 .. 7, blocks of two cells
		EXPECT_EQ( plain[r], 4u );
		EXPECT_EQ( width[r], x < 4 ? 4u : 8u );
		const std::uint32_t before = soft.start[r + 1] - soft.start[r], now = hard.start[r + 1] - hard.start[r];
		if ( x < 2 ) // out of reach of the hard half
		{
			EXPECT_EQ( now, before );
		}
		else if ( x >= 4 && x < 7 )
		{
			EXPECT_GT( now, before );
		}
	}
}

TEST( IntervalRegions, DoNotDependOnThreads )
{
	const Lattice lattice = makeRandomBlob( 12, 30 );
	const Octree octree = buildOctree( lattice, 2 );
	const Cut cut = RandomCut( octree, 12 ).cut();
	const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	const std::vector<std::uint32_t> width = intervalWidths( octree, cut, 1.0f );
	ASSERT_GT( cut.count(), 512 ); // more than one task
	const std::unique_ptr<TaskRunner> pool = createThreadPool( 3 );
	expectEqual( findIntervalRegions( { octree, cut, graph }, width, 0.5f ),
		findIntervalRegions( { octree, cut, graph }, width, 0.5f, pool.get() ) );
}

/// The same width for all, `halfWidth` finest cells, but at least the spacing of the node's own level: max( w, 2^l ), half cells.
std::vector<std::uint32_t> constantWidths( const Octree& octree, const Cut& cut, float halfWidth )
{
	std::vector<std::uint32_t> width;
	for ( const std::uint32_t node : cut.node )
	{
		const double spacing = std::ldexp( 1.0, octree.levelOf( node ) );
		width.push_back( std::uint32_t( std::round( kUnitsPerCell * std::max( spacing, double( halfWidth ) ) ) ) );
	}
	return width;
}

/// S: 6 summation nodes on average at eps 0.5, on a body whose thin features are fine and whose interior is coarse.
TEST( IntervalRegions, NeedFewSummationNodesOnThinFingers )
{
	const int palm = 16;
	const Lattice lattice = makeFingers( palm, 8, 32 );
	const Octree octree = buildOctree( lattice, 3 );
	const Cut cut = selectCut(
		octree, [&]( std::uint32_t node ) { return lattice.coordinate[octree.cells[octree.cellStart[node]]].z() < palm; } );
	const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	for ( const float w : { 1.0f, 2.0f, 4.0f, 8.0f } )
	{
		const bool isOwnLevel = w <= 2.0f; // w 2^l, else max( w, 2^l )
		double membersBefore = 0.0;
		for ( const float eps : { 0.0f, 0.25f, 0.5f, 1.0f } )
		{
			const std::vector<std::uint32_t> width = isOwnLevel ? intervalWidths( octree, cut, w ) : constantWidths( octree, cut, w );
			const IntervalRegions regions = findIntervalRegions( { octree, cut, graph }, width, eps );
			const RegionMatrix matrix = buildIntervalRegions( octree, cut, regions, IntervalWeights::Literal );
			std::uint32_t most = 0;
			for ( std::size_t r = 0; r < std::size_t( regions.count() ); ++r )
			{
				most = std::max( most, regions.start[r + 1] - regions.start[r] );
			}
			const double average = double( regions.node.size() ) / regions.count(),
						 members = double( matrix.member.size() ) / regions.count();
			std::printf(
				"%s, w %.0f, eps %.2f: %d nodes for %d cells; a region has %.1f summation nodes on average, %u at most, for %.1f nodes\n",
				isOwnLevel ? "w 2^l" : "max( w, 2^l )", double( w ), double( eps ), regions.count(), lattice.cellCount(), average, most,
				members );
			EXPECT_LE( average, members );
			EXPECT_GE( members, membersBefore );
			membersBefore = members;
		}
	}
}

} // namespace
} // namespace pliant
