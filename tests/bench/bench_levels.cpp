// Levels of detail: the cost of a step compared with the uniform lattice of the same finest cells, naive and fast, and the cost of changes.
// Bodies: 0 a Glob of about the bunny's 2 248 cells (Ohta et al. 2009), 1 a palm with five thin fingers (Steinemann et al. 2008, Fig. 1).

#include "body/body.h"
#include "body/levels/levels.h"
#include "matching/implicit/strain_rates.h"
#include "matching/reference/reference_matcher.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/memory_in_use.h"
#include "support/shapes.h"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace pliant {
namespace {

constexpr float kLevelStep = 1.0f / 240.0f;

/// A palm of 32^3 cells and five fingers of 2 x 2 x 24, which stand across the blocks so that they stay finest.
Lattice makePalm()
{
	return test::makeShapeLattice( { 32, 32, 56 }, 1.0f, []( int x, int y, int z ) {
		const bool isFinger = ( y == 15 || y == 16 ) && x % 6 >= 1 && x % 6 <= 2 && x < 30;
		return z < 32 || ( isFinger && z < 56 );
	} );
}

std::shared_ptr<const Lattice> bodyLattice( int body )
{
	return std::make_shared<const Lattice>( body == 0 ? test::makeBlobLattice( 27, 1.0f, 1 ) : makePalm() );
}

void reportLevelsPerNode( benchmark::State& state, int nodes )
{
	state.counters["nodes"] = nodes;
	state.counters["ns_per_node"] = benchmark::Counter(
		double( nodes ) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
}

Material wide( benchmark::State& state )
{
	Material material = test::explicitMaterial();
	material.regionHalfWidth = int( state.range( 1 ) );
	return material;
}

std::unique_ptr<Body> makeBody( std::shared_ptr<const Lattice> lattice, const Material& material, int levels )
{
	Adaptivity adaptivity;
	adaptivity.coarseLevels = levels;
	std::unique_ptr<Body> body = std::move( Body::create( std::move( lattice ), material, {}, nullptr, adaptivity ).value );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->nodes().v.set( i, 0.1f * body->nodes().x0.get( i ) );
	}
	return body;
}

/// Brute force, in double: every region sums its members independently.
void levelsNaive( benchmark::State& state )
{
	const auto lattice = bodyLattice( int( state.range( 0 ) ) );
	NodeState nodes = test::restNodes( *lattice );
	ReferenceMatcher matcher( *lattice, wide( state ) );
	for ( auto _ : state )
	{
		matcher.accelerate( nodes, MatchStep{ kLevelStep, 0.5f, 10.0f }, nullptr );
	}
	reportLevelsPerNode( state, nodes.count );
}

void stepLevels( benchmark::State& state, int levels )
{
	const std::shared_ptr<const Lattice> lattice = bodyLattice( int( state.range( 0 ) ) );
	const std::size_t memoryBefore = test::memoryInUse();
	const std::unique_ptr<Body> body = makeBody( lattice, wide( state ), levels );
	for ( auto _ : state )
	{
		body->accelerateTowardGoals( kLevelStep, 0.5f, nullptr );
		body->integrate( kLevelStep );
	}
	reportLevelsPerNode( state, body->nodeCount() );
	state.counters["bytes_per_node"] = double( test::memoryInUse() - memoryBefore ) / body->nodeCount();
}

void levelsUniform( benchmark::State& state )
{
	stepLevels( state, 0 );
}
void levelsAdaptive( benchmark::State& state )
{
	stepLevels( state, state.range( 0 ) == 0 ? 2 : 3 );
}

void arguments( benchmark::internal::Benchmark* b )
{
	b->ArgNames( { "body", "w" } )->Args( { 0, 1 } )->Args( { 0, 2 } )->Args( { 1, 1 } )->Args( { 1, 2 } )->Unit( benchmark::kMicrosecond );
}
BENCHMARK( levelsNaive )->Apply( arguments );
BENCHMARK( levelsUniform )->Apply( arguments );
BENCHMARK( levelsAdaptive )->Apply( arguments );

/// One product of the implicit step.
void levelsProduct( benchmark::State& state )
{
	const std::unique_ptr<Body> body = makeBody(
		bodyLattice( int( state.range( 0 ) ) ), test::explicitMaterial(), state.range( 0 ) == 0 ? 2 : 3 );
	LatticeMatcher matcher( body->lattice(), body->material(), body->levels()->tables() );
	StrainRates rates;
	rates.prepare( matcher, body->nodes(), nullptr );
	const std::size_t padded = std::size_t( body->nodes().padded );
	AlignedArray<float> v( 3 * padded ), to( 3 * padded );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			v[k * padded + std::size_t( i )] = body->nodes().v.get( i )[Eigen::Index( k )];
		}
	}
	for ( auto _ : state )
	{
		rates.resist( v.data(), 30.0f, to.data(), nullptr );
	}
	reportLevelsPerNode( state, body->nodeCount() );
}
BENCHMARK( levelsProduct )->ArgName( "body" )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

/// About `count` new nodes at once in a Glob of 41 000 cells, and the merge; the label has the number of rows rebuilt.
void levelsSplit( benchmark::State& state )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 70, 1.0f, 1 ) );
	const std::unique_ptr<Body> body = makeBody( lattice, test::explicitMaterial(), 3 );
	const Octree& octree = body->levels()->octree();
	std::vector<std::uint32_t> split;
	int brought = 0;
	for ( const std::uint32_t node : body->levels()->cut().node )
	{
		if ( octree.levelOf( node ) > 0 && brought < int( state.range( 0 ) ) )
		{
			split.push_back( node );
			brought += int( octree.childStart[node + 1] - octree.childStart[node] );
		}
	}
	for ( auto _ : state )
	{
		body->changeLevels( split, {} );
		state.PauseTiming();
		body->changeLevels( {}, split );
		state.ResumeTiming();
	}
	state.counters["new_nodes"] = brought;
	state.counters["new_nodes_per_second"] = benchmark::Counter( double( brought ), benchmark::Counter::kIsIterationInvariantRate );
}
BENCHMARK( levelsSplit )->Arg( 50 )->Arg( 350 )->Arg( 500 )->Arg( 1000 )->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
