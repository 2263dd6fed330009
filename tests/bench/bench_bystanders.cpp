// The cost of one soft cube of 216 nodes in a world of 3 000 rigid boxes: the boxes alone in Bullet's world, with the cube among them, and
// with the cube far away. Counters: the median and the worst of 120 steps after the heap is released, ms.

#include "support/explicit_material.h"
#include "support/test_world.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

namespace pliant {
namespace {

template <class World>
void fillHeap( World& scene )
{
	scene.addBoxFloor();
	const btScalar half = btScalar( 0.2 );
	for ( int k = 0; k < 3000; ++k )
	{
		const int x = k % 15, z = k / 15 % 10, y = k / 150;
		scene.add( 8, new btBoxShape( btVector3( half, half, half ) ),
			btVector3( btScalar( 0.42 * x + 0.03 * ( y % 3 ) ), btScalar( 0.25 + 0.45 * y ), btScalar( 0.42 * z + 0.02 * ( y % 2 ) ) ) );
	}
}

template <class World>
void timeSteps( benchmark::State& state, World& scene )
{
	std::vector<double> times;
	for ( auto _ : state )
	{
		for ( int k = 0; k < 120; ++k )
		{
			const auto begin = std::chrono::steady_clock::now();
			scene.step( 1 );
			times.push_back( std::chrono::duration<double, std::milli>( std::chrono::steady_clock::now() - begin ).count() );
		}
	}
	std::sort( times.begin(), times.end() );
	state.counters["median_ms"] = times[times.size() / 2];
	state.counters["worst_ms"] = times.back();
}

void bystandersAlone( benchmark::State& state )
{
	test::WorldOf<btDiscreteDynamicsWorld> scene;
	fillHeap( scene );
	timeSteps( state, scene );
}

/// implicit: 1 or 0; far: 1 for 30 m away.
void bystandersWithACube( benchmark::State& state )
{
	test::SoftWorld scene;
	fillHeap( scene );
	Material material = test::explicitMaterial();
	material.youngsModulus = 1e5f;
	material.elasticity = state.range( 0 ) ? Elasticity::Implicit : Elasticity::Explicit;
	SoftBody* const cube = scene.add( test::cubeTemplate( 0.6f, 6 ), btVector3( state.range( 1 ) ? 30 : 3, btScalar( 9.6 ), 2 ), material );
	cube->setActivationState( DISABLE_DEACTIVATION );
	timeSteps( state, scene );
}

BENCHMARK( bystandersAlone )->Iterations( 1 )->Unit( benchmark::kMillisecond );
BENCHMARK( bystandersWithACube )
	->ArgNames( { "implicit", "far" } )
	->Args( { 1, 0 } )
	->Args( { 1, 1 } )
	->Args( { 0, 1 } )
	->Args( { 0, 0 } )
	->Iterations( 1 )
	->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
