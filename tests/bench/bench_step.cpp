// The core step, one thread, without Bullet and skinning: the cost of a node, by method, instruction set and size.
// Counter ns_per_node: nanoseconds a node and substep (matching, forces, integration).

#include "matching/reference/reference_matcher.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"
#include "support/memory_in_use.h"

#include <benchmark/benchmark.h>

#include <vector>

namespace pliant {
namespace {

constexpr float kStep = 1.0f / 240.0f;

/// A block that flies, spins and vibrates: no node at rest, no rotation converged.
NodeState lively( const Lattice& lattice )
{
	NodeState nodes = test::restNodes( lattice );
	test::Seeded random( 1 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.v.set( i, Vec3( 0, 0, 1 ).cross( nodes.x0.get( i ) ) );
		nodes.x.set( i, nodes.x0.get( i ) * 1.02f + random.inBox( 0.02f * lattice.cellSize ) );
	}
	return nodes;
}

void reportPerNode( benchmark::State& state, int nodes )
{
	state.counters["nodes"] = nodes;
	state.counters["ns_per_node"] = benchmark::Counter(
		double( nodes ) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
}

void stepMatcher( benchmark::State& state, int cells, const Material& material, Summation summation, KernelTarget target )
{
	const Kernels* kernels = findKernels( target );
	if ( !kernels )
	{
		state.SkipWithError( "this processor lacks the instruction set" );
		return;
	}
	const Lattice lattice = makeBlockLattice( cells, cells, cells, 1.0f / float( cells ) );
	NodeState nodes = lively( lattice );
	const std::size_t memoryBefore = test::memoryInUse();
	LatticeMatcher matcher( lattice, material, summation, *kernels );
	const MatchStep step{ kStep, 0.5f, 10.0f, 1.0f, 0.0f };
	for ( auto _ : state )
	{
		matcher.accelerate( nodes, step, nullptr );
		for ( int i = 0; i < nodes.padded; ++i )
		{
			nodes.x.x[i] += kStep * nodes.v.x[i];
			nodes.x.y[i] += kStep * nodes.v.y[i];
			nodes.x.z[i] += kStep * nodes.v.z[i];
		}
	}
	reportPerNode( state, nodes.count );
	state.counters["bytes_per_node"] = double( test::memoryInUse() - memoryBefore ) / nodes.count;
}

void coreStep( benchmark::State& state )
{
	Material material = test::explicitMaterial();
	material.regionHalfWidth = int( state.range( 1 ) );
	stepMatcher( state, int( state.range( 0 ) ), material, Summation( state.range( 2 ) ), KernelTarget( state.range( 3 ) ) );
}

void registerSteps( benchmark::internal::Benchmark* b )
{
	b->ArgNames( { "edge", "w", "sum", "isa" } );
	for ( int edge : { 6, 13, 27 } )
	{
		for ( int w : { 1, 2, 3 } )
		{
			for ( Summation summation : { Summation::Table, Summation::BoxSums } )
			{
				b->Args( { edge, w, int( summation ), int( KernelTarget::Avx512 ) } );
			}
		}
		for ( KernelTarget target : { KernelTarget::Baseline, KernelTarget::Avx2 } )
		{
			b->Args( { edge, 1, int( Summation::BoxSums ), int( target ) } );
			b->Args( { edge, 1, int( Summation::Table ), int( target ) } );
		}
	}
}
BENCHMARK( coreStep )->Apply( registerSteps );

/// The cost of the comparison modes, literal weights and rotations from F. Fused operations are never used, so that bits are equal.
void comparisonMode( benchmark::State& state )
{
	Material material = test::explicitMaterial();
	material.weights = state.range( 0 ) == 1 ? Weights::Literal : Weights::Conserving;
	material.rotationFrom = state.range( 0 ) == 2 ? RotationFrom::F : RotationFrom::Apq;
	material.beta = state.range( 0 ) == 3 ? 0.5f : 0.0f;
	stepMatcher( state, 13, material, Summation::Automatic, KernelTarget::Avx512 );
	static const char* const names[] = { "conserving", "literal weights", "rotation from F", "beta 0.5" };
	state.SetLabel( names[state.range( 0 )] );
}
BENCHMARK( comparisonMode )->DenseRange( 0, 3 );

/// The step of a simple implementation: one 27-point cluster for each node, brute force, double precision, no shared sums.
void bruteForce27( benchmark::State& state )
{
	const int cells = int( state.range( 0 ) );
	const Lattice lattice = makeBlockLattice( cells, cells, cells, 1.0f / float( cells ) );
	NodeState nodes = lively( lattice );
	ReferenceMatcher matcher( lattice, Material{} );
	for ( auto _ : state )
	{
		matcher.accelerate( nodes, MatchStep{ kStep, 0.5f, 10.0f, 1.0f, 0.0f }, nullptr );
	}
	reportPerNode( state, nodes.count );
}
BENCHMARK( bruteForce27 )->Arg( 6 )->Arg( 13 )->Arg( 27 );

/// Forces, matching, integration and the check for finite numbers: a whole substep of a body.
void wholeBodyStep( benchmark::State& state )
{
	const int cells = int( state.range( 0 ) );
	const auto body = test::makeBlock( cells, cells, cells, 1.0f / float( cells ) );
	body->nodes().v.x[0] = 1.0f;
	for ( auto _ : state )
	{
		test::substep( *body, kStep, 0.5f, Vec3( 0, -1e-3f, 0 ) );
	}
	reportPerNode( state, body->nodeCount() );
}
BENCHMARK( wholeBodyStep )->Arg( 6 )->Arg( 13 )->Arg( 27 );

} // namespace
} // namespace pliant
