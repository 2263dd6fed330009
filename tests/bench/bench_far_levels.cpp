// The cost of far levels in a step: the same body at the same substep without them, and with one, two and three active. Ratios of one run.

#include "body/body.h"
#include "support/block_body.h"
#include "support/explicit_material.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

namespace pliant {
namespace {

constexpr float kCell = 0.025f, kStep = 1.0f / 240.0f;

struct Shape
{
	const char* name;
	int x, y, z;
};

const Shape kShapes[] = {
	{ "bar 64x4x4", 64, 4, 4 }, { "bar 64x8x8", 64, 8, 8 }, { "block 16x16x16", 16, 16, 16 }, { "block 32x32x32", 32, 32, 32 } };

/// `times`: Young's modulus over the reach of the finest level.
std::unique_ptr<Body> makeBody( const Shape& shape, int farLevels, double times )
{
	Material material = test::explicitMaterial();
	const StiffnessPlan plan = planStiffness( material, kCell, kStep, 1 );
	material.youngsModulus = float( times * plan.reachedModulus / plan.alpha );
	material.farLevels = farLevels;
	std::unique_ptr<Body> body = test::makeBlock( shape.x, shape.y, shape.z, kCell, material );
	test::Seeded random( 3 );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->nodes().v.set( i, random.inBox( 0.1f ) );
	}
	return body;
}

double secondsOf( Body& body )
{
	const auto start = std::chrono::steady_clock::now();
	test::substep( body, kStep, 1.0f );
	return std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
}

/// Both bodies step in turn, so that other load on the machine affects both; the ratio is that of the shortest times.
void farLevels( benchmark::State& state )
{
	const Shape& shape = kShapes[state.range( 0 )];
	const int levels = int( state.range( 1 ) );
	const double times[] = { 1.0, 4.0, 20.0, 40.0 }; // each requires one level more
	const std::unique_ptr<Body> plain = makeBody( shape, 0, 1.0 ), with = makeBody( shape, levels, times[levels] );
	double least = 1e9, leastPlain = 1e9;
	for ( auto _ : state )
	{
		state.PauseTiming();
		leastPlain = std::min( leastPlain, secondsOf( *plain ) );
		state.ResumeTiming();
		least = std::min( least, secondsOf( *with ) );
	}
	state.SetLabel( shape.name );
	state.counters["far_levels"] = with->material().farLevels;
	state.counters["ns_plain"] = leastPlain * 1e9 / plain->nodeCount();
	state.counters["ns_least"] = least * 1e9 / plain->nodeCount();
	state.counters["ratio"] = least / leastPlain;
}
BENCHMARK( farLevels )->ArgNames( { "shape", "levels" } )->ArgsProduct( { { 0, 1, 2, 3 }, { 1, 2, 3 } } )->Iterations( 3000 );

} // namespace
} // namespace pliant
