// Rollback: 20 bodies of 300 nodes saved without their templates and restored, one thread. In flight, at rest on the floor, and after a
// step in between, as in a game with rollback.

#include "pliant/io/snapshot.h"
#include "support/test_world.h"

#include <benchmark/benchmark.h>

namespace pliant {
namespace {

enum Place : int
{
	InFlight,
	OnFloor
};

void fill( test::SoftWorld& world, Place place )
{
	const auto shape = test::boxTemplate( { 0.5f, 0.3f, 0.25f }, 0.05f );
	world.addBoxFloor();
	for ( int k = 0; k < 20; ++k )
	{
		const btScalar height = place == InFlight ? btScalar( 50 ) : btScalar( 0.13 );
		SoftBody* const body = world.add( shape, btVector3( btScalar( k % 5 ), height, btScalar( k / 5 ) ) );
		if ( place == InFlight )
		{
			static_cast<void>( body->setVelocities( btVector3( 0, 1, 0 ), btVector3( 1, 2, 3 ) ) );
		}
	}
	world.step( 30 );
}

SaveSettings stateOnly()
{
	SaveSettings settings;
	settings.withTemplates = false;
	return settings;
}

void report( benchmark::State& state, const test::SoftWorld& world, const std::vector<std::byte>& bytes )
{
	int nodes = 0;
	for ( int k = 0; k < world.world.softBodyCount(); ++k )
	{
		nodes += world.world.softBody( k )->nodeCount();
	}
	state.counters["nodes"] = nodes;
	state.counters["contacts"] = world.world.stepReport().softContacts;
	state.counters["bytes"] = double( bytes.size() );
}

void saveState( benchmark::State& state, Place place )
{
	test::SoftWorld world;
	fill( world, place );
	std::vector<std::byte> bytes;
	for ( auto _ : state )
	{
		static_cast<void>( saveWorld( world.world, bytes, stateOnly() ) );
		benchmark::ClobberMemory();
	}
	report( state, world, bytes );
}

void restoreState( benchmark::State& state, Place place )
{
	test::SoftWorld world;
	fill( world, place );
	std::vector<std::byte> bytes;
	static_cast<void>( saveWorld( world.world, bytes, stateOnly() ) );
	world.step( 1 );
	for ( auto _ : state )
	{
		const bool isRestored = restoreWorld( world.world, bytes ).ok();
		benchmark::DoNotOptimize( isRestored );
	}
	report( state, world, bytes );
}

const int kRegistered = [] {
	for ( const Place place : { InFlight, OnFloor } )
	{
		const std::string name = place == InFlight ? "inFlight" : "onFloor";
		benchmark::RegisterBenchmark( ( "snapshotSave/" + name ).c_str(), saveState, place )->Unit( benchmark::kMicrosecond );
		benchmark::RegisterBenchmark( ( "snapshotRestore/" + name ).c_str(), restoreState, place )->Unit( benchmark::kMicrosecond );
	}
	return 0;
}();

} // namespace
} // namespace pliant
