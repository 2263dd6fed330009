// Bars stretched until they part, by both rules, at angles to the lattice and on levels: do they break at the strain set, and across the
// pull?

#include "experiments/experiments.h"
#include "support/pulled_bar.h"

#include <algorithm>
#include <cstdio>

namespace pliant::experiment {

namespace {

void pullBars( BreakRule rule, bool rings )
{
	const char* const name = rule == BreakRule::Plane ? "plane" : rule == BreakRule::Shards ? "shards" : "distance";
	double low = 1e9, high = 0.0, tilt = 0.0;
	for ( int levels = 0; levels <= 2; ++levels )
	{
		std::printf( "| %s, %d |", name, levels );
		for ( const double degrees : { 0.0, 5.0, 10.0, 20.0, 30.0, 45.0 } )
		{
			const test::PullResult r = test::pullBar( { degrees, levels, rule, 0.1f, rings } );
			std::printf( " %.2f, %.2f, %.1f |", r.firstStrain / 0.1, r.partedStrain / 0.1, r.tilt );
			low = std::min( low, r.firstStrain / 0.1 );
			high = std::max( high, r.firstStrain / 0.1 );
			tilt = std::max( tilt, r.tilt );
		}
		std::printf( "\n" );
		std::fflush( stdout );
	}
	std::printf( "\n%s: breaks at %.3f to %.3f of what was set, tilt up to %.1f degrees\n\n", name, low, high, tilt );
}

} // namespace

void pullExperiment()
{
	for ( const bool rings : { false, true } )
	{
		std::printf(
			"Bar of 40 x 8 x 8 cells, break strain 0.1, %s: first break and parting over what was set, tilt of the crack, degrees\n\n"
			"| rule, levels | 0 degrees | 5 | 10 | 20 | 30 | 45 |\n|---|---|---|---|---|---|---|\n",
			rings ? "nothing damped" : "wobble damped as by default" );
		pullBars( BreakRule::Plane, rings );
		pullBars( BreakRule::Distance, rings );
		pullBars( BreakRule::Shards, rings );
	}
}

} // namespace pliant::experiment
