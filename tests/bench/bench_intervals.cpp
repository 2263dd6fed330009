// Steinemann et al. 2008: the cost of distances and regions for each node, and of a fast sum for each region.

#include "adapt/octree/bucket_moore.h"
#include "support/breadth_sum.h"
#include "support/shapes.h"

#include <benchmark/benchmark.h>

#include <cstddef>

namespace {

using namespace pliant;

/// A blob with a fine surface and a coarse inside, with the data that its regions are built from.
struct BlobOfLevels
{
	Lattice lattice = test::makeBlobLattice( 34, 0.1f, 5, 6 );
	Octree octree = buildOctree( lattice, 3 );
	Cut cut = selectCut( octree, keepsByMass( octree, 0.99f ) );
	VisibilityGraph graph = buildVisibilityGraph( lattice, octree, cut );
	std::vector<std::uint32_t> width;

	explicit BlobOfLevels( double w ) : width( intervalWidths( octree, cut, float( w ) ) ) {}
	IntervalInput input() const { return { octree, cut, graph }; }
};

void report( benchmark::State& state, double items )
{
	state.counters["ns_per_node"] = benchmark::Counter(
		items * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
	state.counters["count"] = items;
}

void distances( benchmark::State& state )
{
	const BlobOfLevels blob( double( state.range( 0 ) ) );
	BucketMoore search;
	std::size_t reached = 0;
	for ( auto _ : state )
	{
		reached = 0;
		for ( std::uint32_t i = 0; i < std::uint32_t( blob.cut.count() ); ++i )
		{
			reached += search.from( blob.graph, i, blob.width[i] * 3 / 2 ).size();
		}
		benchmark::DoNotOptimize( reached );
	}
	report( state, blob.cut.count() );
	state.counters["reached"] = double( reached ) / blob.cut.count();
}

void regionsFromNothing( benchmark::State& state )
{
	const BlobOfLevels blob( double( state.range( 0 ) ) );
	std::size_t terms = 0;
	for ( auto _ : state )
	{
		const IntervalRegions regions = findIntervalRegions( blob.input(), blob.width, kIntervalEps );
		terms = regions.node.size();
		benchmark::DoNotOptimize( terms );
	}
	report( state, blob.cut.count() );
	state.counters["summation_nodes"] = double( terms ) / blob.cut.count();
}

void graphFromNothing( benchmark::State& state )
{
	const BlobOfLevels blob( 1.0 );
	for ( auto _ : state )
	{
		benchmark::DoNotOptimize( buildVisibilityGraph( blob.lattice, blob.octree, blob.cut ).longest );
	}
	report( state, blob.cut.count() );
}

void fastSum( benchmark::State& state )
{
	const BlobOfLevels blob( double( state.range( 0 ) ) );
	const IntervalRegions regions = findIntervalRegions( blob.input(), blob.width, kIntervalEps );
	const SumPlan plan = planSums( blob.octree, blob.cut, regions );
	std::vector<float> records( std::size_t( plan.records() ) * kSumFloats, 1.0f ), sums( std::size_t( plan.slots ) * kSumFloats );
	for ( auto _ : state )
	{
		depthSum( plan, records.data() );
		test::breadthSum( plan, records.data(), sums.data() );
		benchmark::DoNotOptimize( sums.data() );
	}
	report( state, plan.slots );
	state.counters["summation_nodes"] = double( plan.term.size() ) / plan.slots;
	state.counters["virtual_nodes"] = plan.virtualNodes;
}

BENCHMARK( distances )->Name( "intervals/distances" )->Arg( 1 )->Arg( 2 )->Unit( benchmark::kMicrosecond );
BENCHMARK( regionsFromNothing )->Name( "intervals/regions" )->Arg( 1 )->Arg( 2 )->Unit( benchmark::kMicrosecond );
BENCHMARK( graphFromNothing )->Name( "intervals/graph" )->Unit( benchmark::kMicrosecond );
BENCHMARK( fastSum )->Name( "intervals/sum" )->Arg( 1 )->Arg( 2 )->Unit( benchmark::kMicrosecond );

} // namespace
