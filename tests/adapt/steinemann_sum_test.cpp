// The hierarchical fast summation against sums over all nodes of a region: Steinemann et al. 2008, section 4.3.

#include "adapt/regions/hierarchical_sum.h"
#include "steinemann_bodies.h"
#include "support/breadth_sum.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

using test::makeRandomBlob;
using test::RandomCut;

TEST( HierarchicalSum, IsTheSumOverAllNodesOfTheRegion )
{
	int virtualNodes = 0;
	for ( unsigned seed = 1; seed <= 5; ++seed )
	{
		const Lattice lattice = makeRandomBlob( seed );
		const Octree octree = buildOctree( lattice, 3 );
		const Cut cut = RandomCut( octree, seed ).cut();
		const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
		const IntervalRegions regions = findIntervalRegions(
			{ octree, cut, graph }, intervalWidths( octree, cut, float( 1 + seed % 3 ) ), 0.5f );
		const RegionMatrix matrix = buildIntervalRegions( octree, cut, regions, IntervalWeights::Literal );
		const SumPlan plan = planSums( octree, cut, regions );
		virtualNodes += plan.virtualNodes;
		ASSERT_EQ( plan.slots, cut.count() );

		std::mt19937 random( seed );
		std::vector<float> records( std::size_t( plan.records() ) * kSumFloats, std::nanf( "" ) );
		for ( std::size_t k = 0; k < std::size_t( plan.slots ) * kSumFloats; ++k )
		{
			records[k] = float( random() % 2001 ) / 1000.0f - 1.0f;
		}
		std::vector<float> sums( std::size_t( plan.slots ) * kSumFloats );
		depthSum( plan, records.data() );
		test::breadthSum( plan, records.data(), sums.data() );
		for ( std::uint32_t r = 0; r < std::uint32_t( plan.slots ); ++r )
		{
			for ( std::size_t k = 0; k < kSumFloats; ++k )
			{
				double wanted = 0.0, size = 0.0;
				for ( std::uint32_t m = matrix.start[r]; m < matrix.start[r + 1]; ++m )
				{
					wanted += records[matrix.member[m] * kSumFloats + k];
					size += std::abs( records[matrix.member[m] * kSumFloats + k] );
				}
				ASSERT_NEAR( sums[r * kSumFloats + k], wanted, 1e-6 * ( 1.0 + size ) );
			}
		}
	}
	EXPECT_GT( virtualNodes, 100 );
}

/// Eq. 8: the same operator takes regions to nodes, because i is in region j when j is in region i.
TEST( HierarchicalSum, ScattersAsItGathers )
{
	const Lattice lattice = makeRandomBlob( 9 );
	const Octree octree = buildOctree( lattice, 2 );
	const Cut cut = RandomCut( octree, 9 ).cut();
	const VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	const IntervalRegions regions = findIntervalRegions( { octree, cut, graph }, intervalWidths( octree, cut, 1.0f ), 0.5f );
	const RegionMatrix matrix = buildIntervalRegions( octree, cut, regions, IntervalWeights::Literal );
	const SumPlan plan = planSums( octree, cut, regions );
	std::vector<float> ofRegion( std::size_t( plan.records() ) * kSumFloats ), ofNode( std::size_t( plan.slots ) * kSumFloats );
	std::vector<float> wanted( ofNode.size() );
	for ( std::uint32_t r = 0; r < std::uint32_t( plan.slots ); ++r )
	{
		ofRegion[r * kSumFloats] = float( r + 1 ); // whole numbers: sums are exact
		for ( std::uint32_t m = matrix.start[r]; m < matrix.start[r + 1]; ++m )
		{
			wanted[matrix.member[m] * kSumFloats] += float( r + 1 );
		}
	}
	depthSum( plan, ofRegion.data() );
	test::breadthSum( plan, ofRegion.data(), ofNode.data() );
	EXPECT_EQ( ofNode, wanted );
}

} // namespace
} // namespace pliant
