// What a frame of eight soft cubes on each other costs, against one of four: until they sleep (docs/design/implicit.md).

#include "support/soft_stacks.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

namespace pliant {
namespace {

constexpr int kMostFrames = 1200;

/// Milliseconds a frame, mean of all frames until it sleeps, and how many those are.
double costOf( const test::Stack& stack, int& frames )
{
	test::StackScene scene( stack );
	double seconds = 0.0;
	for ( frames = 0; frames < kMostFrames && !scene.sleeps(); ++frames )
	{
		scene.step( 1 );
		seconds += scene.world.stepReport().total;
	}
	return 1e3 * seconds / frames;
}

/// Four and eight in turn, falls by 1 and 2 cm a thing.
void stackEightOverFour( benchmark::State& state )
{
	std::vector<double> ratios, fours, eights;
	int longest[2] = {};
	for ( auto _ : state )
	{
		double cost[2] = {};
		for ( const double gap : { 0.01, 0.02 } )
		{
			for ( const int k : { 0, 1 } )
			{
				test::Stack stack{ 4 * ( k + 1 ), state.range( 1 ) != 0 };
				stack.gap = gap;
				stack.elasticity = Elasticity( state.range( 0 ) );
				int frames = 0;
				cost[k] += 0.5 * costOf( stack, frames );
				longest[k] = std::max( longest[k], frames );
			}
		}
		fours.push_back( cost[0] );
		eights.push_back( cost[1] );
		ratios.push_back( cost[1] / cost[0] );
	}
	const auto median = []( std::vector<double>& values ) {
		std::nth_element( values.begin(), values.begin() + std::ptrdiff_t( values.size() / 2 ), values.end() );
		return values[values.size() / 2];
	};
	state.counters["four_ms"] = median( fours );
	state.counters["eight_ms"] = median( eights );
	state.counters["ratio"] = median( ratios );
	state.counters["four_frames"] = longest[0];
	state.counters["eight_frames"] = longest[1];
	state.counters["ratio_most"] = *std::max_element( ratios.begin(), ratios.end() );
}
BENCHMARK( stackEightOverFour )
	->ArgNames( { "elasticity", "boxes" } )
	->ArgsProduct( { { 0, 1 }, { 0, 1 } } )
	->Iterations( 3 )
	->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
