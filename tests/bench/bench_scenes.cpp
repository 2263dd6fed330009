// Whole frames of 1/60 s: matching, contacts and Bullet's solver, without skinning. Counters: contacts, substeps, and the fraction of
// matching in the frame.

#include "bench_pile.h"
#include "support/explicit_material.h"

#include <benchmark/benchmark.h>

namespace pliant {
namespace {

void report( benchmark::State& state, SoftBodyWorld& world )
{
	const StepReport& step = world.stepReport();
	state.counters["nodes"] = step.nodes;
	state.counters["contacts"] = step.softContacts;
	state.counters["substeps"] = step.substeps;
	state.counters["matching_ms"] = step.matching * 1e3;
	state.counters["collision_ms"] = step.collision * 1e3;
	state.counters["solve_ms"] = step.solve * 1e3;
	state.counters["total_ms"] = step.total * 1e3;
}

/// A block resting on a plane, kept awake.
void restingBlock( benchmark::State& state )
{
	const int cells = int( state.range( 0 ) );
	test::SoftWorld scene;
	scene.addFloor();
	Material material = test::explicitMaterial();
	material.youngsModulus = 1e5f;
	SoftBody* body = scene.add( test::cubeTemplate( 1.0f, cells ), btVector3( 0, btScalar( 0.51 ), 0 ), material );
	body->setActivationState( DISABLE_DEACTIVATION );
	scene.step( 60 );
	for ( auto _ : state )
	{
		scene.step( 1 );
	}
	report( state, scene.world );
}
BENCHMARK( restingBlock )->Arg( 6 )->Arg( 13 )->Arg( 27 )->Unit( benchmark::kMillisecond );

/// The same with self-collision off and on: nothing touches, so the difference is the cost of the search.
void selfCollision( benchmark::State& state )
{
	test::SoftWorld scene;
	scene.addFloor();
	Material material = test::explicitMaterial();
	material.youngsModulus = 1e5f;
	SoftBody* body = scene.add( test::cubeTemplate( 1.0f, 13 ), btVector3( 0, btScalar( 0.51 ), 0 ), material );
	body->setActivationState( DISABLE_DEACTIVATION );
	static_cast<void>( body->setSelfCollision( state.range( 0 ) != 0 ) );
	scene.step( 60 );
	for ( auto _ : state )
	{
		scene.step( 1 );
	}
	report( state, scene.world );
}
BENCHMARK( selfCollision )->ArgName( "on" )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMillisecond );

/// The same, asleep.
void sleepingBlock( benchmark::State& state )
{
	test::SoftWorld scene;
	scene.addFloor();
	SoftBody* body = scene.add( test::cubeTemplate( 1.0f, 13 ), btVector3( 0, btScalar( 0.51 ), 0 ) );
	scene.step( 60 );
	body->forceActivationState( ISLAND_SLEEPING );
	for ( auto _ : state )
	{
		scene.step( 1 );
	}
	report( state, scene.world );
}
BENCHMARK( sleepingBlock )->Unit( benchmark::kMillisecond );

/// Elasticity 0: explicit, 1: implicit, 2: automatic.
void pile( benchmark::State& state )
{
	test::SoftWorld scene;
	test::fillPile( scene, Elasticity( state.range( 0 ) ) );
	for ( auto _ : state )
	{
		scene.step( 1 );
	}
	report( state, scene.world );
	state.counters["implicit"] = scene.world.stepReport().implicitBodies;
	state.counters["products"] = scene.world.stepReport().implicitProducts;
}
BENCHMARK( pile )->ArgName( "elasticity" )->DenseRange( 0, 2 )->Iterations( 100 )->Unit( benchmark::kMillisecond );

/// The same, asleep.
void sleepingPile( benchmark::State& state )
{
	test::SoftWorld scene;
	test::fillPile( scene, Elasticity( state.range( 0 ) ) );
	for ( const auto& body : scene.soft )
	{
		body->forceActivationState( ISLAND_SLEEPING );
	}
	for ( const auto& body : scene.rigid )
	{
		body->forceActivationState( ISLAND_SLEEPING );
	}
	scene.step( 2 );
	for ( auto _ : state )
	{
		scene.step( 1 );
	}
	report( state, scene.world );
	state.counters["awake"] = scene.world.stepReport().awakeSoftBodies;
}
BENCHMARK( sleepingPile )->ArgName( "elasticity" )->DenseRange( 0, 2 )->Iterations( 100 )->Unit( benchmark::kMillisecond );

/// Sixty rigid boxes: Bullet's own world, ours without a soft body, ours with one asleep.
template <class World>
void rigidScene( benchmark::State& state )
{
	test::WorldOf<World> scene;
	scene.addBoxFloor();
	for ( int i = 0; i < 60; ++i )
	{
		btRigidBody* box = scene.add( 1, new btBoxShape( btVector3( btScalar( 0.2 ), btScalar( 0.2 ), btScalar( 0.2 ) ) ),
			btVector3( btScalar( 0.5 * ( i % 8 ) ), btScalar( 0.5 + 0.41 * ( i / 8 ) ), 0 ) );
		box->setActivationState( DISABLE_DEACTIVATION );
	}
	scene.step( 60 );
	for ( auto _ : state )
	{
		scene.step( 1 );
	}
}
BENCHMARK_TEMPLATE( rigidScene, btDiscreteDynamicsWorld )->Unit( benchmark::kMillisecond );
BENCHMARK_TEMPLATE( rigidScene, SoftBodyWorld )->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
