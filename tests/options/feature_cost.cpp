// The cost of a feature, for a counter of instructions: feature_cost lists its cases by number, feature_cost NUMBER STEPS runs one. Only
// the instructions in countedSteps are to be counted (callgrind: --toggle-collect=countedSteps).

#include "demos/study/feature_cases.h"

#include <cstdio>
#include <cstdlib>

extern "C" __attribute__( ( noinline ) ) void countedSteps( pliant_study::SmallWorld& world, int steps, bool isLookedAt )
{
	for ( int k = 0; k < steps; ++k )
	{
		world.timedStep( isLookedAt );
	}
}

int main( int count, char** words )
{
	const std::vector<pliant_study::FeatureCase>& cases = pliant_study::featureCases();
	if ( count != 3 )
	{
		for ( std::size_t k = 0; k < cases.size(); ++k )
		{
			std::printf( "%d|%s|%s\n", int( k ), cases[k].feature.c_str(), cases[k].state.c_str() );
		}
		return 0;
	}
	const std::size_t number = std::size_t( std::atoi( words[1] ) );
	const auto world = number < cases.size() ? pliant_study::makeFeatureWorld( cases[number] ) : nullptr;
	if ( world == nullptr )
	{
		std::printf( "refused\n" );
		return 2;
	}
	countedSteps( *world, std::atoi( words[2] ), cases[number].isLookedAt );
	return 0;
}
