#pragma once

// Processor time of one call, which excludes other load on the machine: single-threaded code only.

#include <algorithm>
#include <cstdio>
#include <ctime>

namespace pliant::experiment {

inline constexpr float kTimedStep = 1.0f / 240.0f; ///< s

/// Seconds of processor time: the shortest mean of several rounds.
template <class F>
double processorSecondsOf( F&& call )
{
	constexpr int kTimedRounds = 9;
	constexpr double kTimedRoundSeconds = 0.04;
	double best = 1e30;
	for ( int round = 0; round < kTimedRounds; ++round )
	{
		const std::clock_t begin = std::clock();
		double seconds = 0.0;
		int calls = 0;
		for ( ; calls == 0 || seconds < kTimedRoundSeconds; ++calls )
		{
			call();
			seconds = double( std::clock() - begin ) / CLOCKS_PER_SEC;
		}
		best = std::min( best, seconds / calls );
	}
	return best;
}

/// A figure and its limit, a lower or an upper one.
inline void printLimit( const char* what, double value, const char* unit, double limit, bool isAtLeast )
{
	const bool isReached = isAtLeast ? value >= limit : value <= limit;
	std::printf( "  %-78s %10.2f %-9s %s %9.2f   %s\n", what, value, unit, isAtLeast ? "at least" : "at most ", limit,
		isReached ? "reached" : "NOT reached" );
}

} // namespace pliant::experiment
