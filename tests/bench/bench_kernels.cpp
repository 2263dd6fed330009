// One kernel at a time, 2 197 nodes of a block, w = 1: the parts of a step for sums, rotation, goals and integration.

#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"

#include <benchmark/benchmark.h>

namespace pliant {
namespace {

enum class Stage : int
{
	FrameSums,
	NodeRecords,
	BoxSums,
	Fit,     ///< sums along z or over the table, rotation, goal transforms
	Scatter, ///< sums of goal transforms, residuals, impulses
	Apply
};

const char* const kNames[] = { "frame sums", "node records", "box sums along x and y", "gather, rotation, goal", "scatter", "apply" };

void runStage( Stage stage, const Kernels& kernels, const MatchView& view, int padded, std::vector<std::uint32_t>& open )
{
	float sums[kImpulseSums] = {};
	switch ( stage )
	{
		case Stage::FrameSums: kernels.frameSums( view, 0, padded, sums ); break;
		case Stage::NodeRecords: kernels.nodeRecords( view, 0, padded ); break;
		case Stage::BoxSums:
			for ( int z = 0; z < view.gridZ; ++z )
			{
				kernels.boxPlane( view, view.nodeRecord, z );
			}
			break;
		case Stage::Fit: benchmark::DoNotOptimize( kernels.fitRegions( view, 0, padded, open.data() ) ); break;
		case Stage::Scatter: kernels.scatter( view, 0, padded, sums ); break;
		case Stage::Apply: kernels.apply( view, 0, padded ); break;
	}
	benchmark::DoNotOptimize( sums[0] );
}

void kernel( benchmark::State& state )
{
	const Stage stage = Stage( state.range( 0 ) );
	const Summation summation = Summation( state.range( 1 ) );
	const Lattice lattice = makeBlockLattice( 13, 13, 13, 1.0f / 13.0f );
	NodeState nodes = test::restNodes( lattice );
	test::Seeded random( 1 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, nodes.x0.get( i ) * 1.02f + random.inBox( 0.02f * lattice.cellSize ) );
	}
	LatticeMatcher matcher( lattice, Material{}, summation );
	matcher.accelerate( nodes, MatchStep{ 1.0f / 240.0f, 0.5f, 10.0f, 1.0f, 0.0f }, nullptr );
	MatchView view = matcher.view( nodes );
	view.frameRotation[0] = view.frameRotation[4] = view.frameRotation[8] = 1.0f;
	std::vector<std::uint32_t> open( nodes.padded );
	for ( auto _ : state )
	{
		if ( stage == Stage::BoxSums )
		{
			// In place: without new records the sums would exceed the range of float. The cost of the records has a row of its own.
			bestKernels().nodeRecords( view, 0, nodes.padded );
		}
		runStage( stage, bestKernels(), view, nodes.padded, open );
	}
	state.SetLabel( std::string( kNames[int( stage )] ) + ( stage == Stage::BoxSums ? ", node records included" : "" ) );
	state.counters["nodes"] = nodes.count;
	state.counters["ns_per_node"] = benchmark::Counter(
		double( nodes.count ) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
}
BENCHMARK( kernel )
	->ArgNames( { "stage", "sum" } )
	->ArgsProduct( { { int( Stage::FrameSums ), int( Stage::NodeRecords ), int( Stage::BoxSums ), int( Stage::Fit ), int( Stage::Scatter ),
						 int( Stage::Apply ) },
		{ int( Summation::BoxSums ) } } )
	->Args( { int( Stage::Fit ), int( Summation::Table ) } )
	->Args( { int( Stage::Scatter ), int( Summation::Table ) } );

} // namespace
} // namespace pliant
