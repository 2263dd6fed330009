// The cost of plasticity in a step, as a ratio to the same elastic body: off, on but never yielding, and with flow in every region.

#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <benchmark/benchmark.h>

namespace pliant {
namespace {

enum class Flow : int
{
	Off,
	Watched, ///< a yield strain that is never reached
	Flowed,  ///< every region has flowed, none does now
	Flowing  ///< every region flows in every step
};

const char* const kFeatureNames[] = { "elastic", "plastic, below yield", "plastic, has flowed", "plastic, all flowing" };

void plasticity( benchmark::State& state )
{
	const Flow flow = Flow( state.range( 0 ) );
	const Lattice lattice = makeBlockLattice( 13, 13, 13, 1.0f / 13.0f );
	NodeState nodes = test::restNodes( lattice );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.x[i] *= 1.3f; // held at these positions: x += h v is not called
	}
	Material material = test::explicitMaterial();
	material.yieldStrain = flow == Flow::Off ? 0.0f : 0.01f;
	LatticeMatcher matcher( lattice, material );
	MatchStep step{ 1.0f / 240.0f, 0.5f, 10.0f, 1.0f };
	step.plastic = PlasticLaw{ flow == Flow::Off ? 0.0f : flow == Flow::Watched ? 10.0f : 0.01f, 10.0f, 0.05f };
	matcher.accelerate( nodes, step, nullptr );
	if ( flow == Flow::Flowed )
	{
		step.plastic.yieldStrain = 10.0f;
	}
	for ( auto _ : state )
	{
		matcher.accelerate( nodes, step, nullptr );
	}
	state.SetLabel( kFeatureNames[int( flow )] );
	state.counters["nodes"] = nodes.count;
	state.counters["ns_per_node"] = benchmark::Counter(
		double( nodes.count ) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
}
BENCHMARK( plasticity )->ArgNames( { "flow" } )->DenseRange( 0, 3 );

} // namespace
} // namespace pliant
