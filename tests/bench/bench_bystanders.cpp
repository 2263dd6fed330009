// The cost of one soft cube of 216 nodes in a world of 3 000 rigid boxes: the boxes alone in Bullet's world, with the cube among them, and
// with the cube far away. Counters: the median and the worst of 120 steps after the heap is released, ms.

#include "bench_heap.h"
#include "support/explicit_material.h"
#include "support/test_world.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

namespace pliant {
namespace {

template <class World>
void timeSteps( benchmark::State& state, World& scene )
{
	std::vector<double> times;
	for ( auto _ : state )
	{
		for ( int k = 0; k < 120; ++k )
		{
			times.push_back( test::timeOfFrame( scene ) );
		}
	}
	std::sort( times.begin(), times.end() );
	state.counters["median_ms"] = times[times.size() / 2];
	state.counters["worst_ms"] = times.back();
}

void bystandersAlone( benchmark::State& state )
{
	test::WorldOf<btDiscreteDynamicsWorld> scene;
	scene.addBoxFloor();
	test::addBoxes( scene, 3000, 15, 10 );
	timeSteps( state, scene );
}

/// implicit: 1 or 0; far: 1 for 30 m away.
void bystandersWithACube( benchmark::State& state )
{
	test::SoftWorld scene;
	scene.addBoxFloor();
	test::addBoxes( scene, 3000, 15, 10 );
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
