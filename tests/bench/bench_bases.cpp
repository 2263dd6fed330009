// The cost that a world for soft bodies adds to a scene without any, compared with Bullet's world over which it is built: the fourteen
// rigid scenes of the tests, both worlds in turn. Counters: the medians over repetitions of a whole scene's steps, us a step, and their
// ratio, all scenes together; and the ratio of the shortest times.

#include "support/bullet_worlds.h"
#include "support/rigid_scenes.h"

#include <benchmark/benchmark.h>

#include <time.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace pliant {
namespace {

constexpr int kSteps = 300, kRepetitions = 24;

/// Processor time of this thread, us: excludes other load on the machine.
double now()
{
	timespec time{};
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &time );
	return 1e6 * double( time.tv_sec ) + 1e-3 * double( time.tv_nsec );
}

/// Returns the time of a scene's steps, us a step.
template <class Base, class World>
double timeOf( const test::Kind& kind )
{
	test::PartsOf<Base> parts;
	const std::unique_ptr<World> world = parts.template make<World>();
	test::Scene scene( *world );
	kind.build( scene );
	const double begin = now();
	for ( int frame = 0; frame < kSteps; ++frame )
	{
		if ( scene.everyFrame )
		{
			scene.everyFrame( scene, frame );
		}
		world->stepSimulation( test::kFrame, 2, test::kFrame );
	}
	return ( now() - begin ) / kSteps;
}

double medianOfTimes( std::vector<double>& times )
{
	std::nth_element( times.begin(), times.begin() + std::ptrdiff_t( times.size() / 2 ), times.end() );
	return times[times.size() / 2];
}

template <class Base>
void rigidScenes( benchmark::State& state )
{
	double theirs = 0.0, ours = 0.0, theirLeast = 0.0, ourLeast = 0.0;
	for ( auto _ : state )
	{
		for ( const test::Kind& kind : test::kRigidKinds )
		{
			std::vector<double> times[2];
			for ( int k = 0; k < kRepetitions; ++k )
			{
				for ( int turn = 0; turn < 2; ++turn )
				{
					const int which = ( k + turn ) % 2; // the order alternates
					times[which].push_back( which == 0 ? timeOf<Base, Base>( kind ) : timeOf<Base, SoftBodyWorldOver<Base>>( kind ) );
				}
			}
			theirs += medianOfTimes( times[0] );
			ours += medianOfTimes( times[1] );
			theirLeast += *std::min_element( times[0].begin(), times[0].end() );
			ourLeast += *std::min_element( times[1].begin(), times[1].end() );
		}
	}
	const double count = double( state.iterations() ) * double( std::size( test::kRigidKinds ) );
	state.counters["bullet_us"] = theirs / count;
	state.counters["ours_us"] = ours / count;
	state.counters["ratio"] = ours / theirs;
	state.counters["least_ratio"] = ourLeast / theirLeast;
}

BENCHMARK_TEMPLATE( rigidScenes, btDiscreteDynamicsWorld )->Unit( benchmark::kMillisecond );
BENCHMARK_TEMPLATE( rigidScenes, btDiscreteDynamicsWorldMt )->Unit( benchmark::kMillisecond );
BENCHMARK_TEMPLATE( rigidScenes, btMultiBodyDynamicsWorld )->Unit( benchmark::kMillisecond );
BENCHMARK_TEMPLATE( rigidScenes, btSoftRigidDynamicsWorld )->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
