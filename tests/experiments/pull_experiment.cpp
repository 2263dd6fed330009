// Bars drawn out until they part, by both rules, at angles to the lattice and on levels: do they break at what was set, and across the pull?

#include "experiments/experiments.h"
#include "support/pulled_bar.h"

#include <cstdio>

namespace pliant::experiment {

void pullExperiment()
{
	std::printf( "Bar of 40 x 8 x 8 cells, break strain 0.1; first break over what was set, strain when parted, tilt of the crack\n\n"
				 "| rule | levels | 0 | 10 | 20 | 30 | 45 degrees |\n|---|---|---|---|---|---|---|\n" );
	for ( const BreakRule rule : { BreakRule::Plane, BreakRule::Distance } )
	{
		double low = 1e9, high = 0.0, tilt = 0.0;
		for ( int levels = 0; levels <= 2; ++levels )
		{
			std::printf( "| %s | %d |", rule == BreakRule::Plane ? "plane" : "distance", levels );
			for ( const double degrees : { 0.0, 10.0, 20.0, 30.0, 45.0 } )
			{
				const test::PullResult r = test::pullBar( { degrees, levels, rule, 0.1f } );
				std::printf( " %.3f, %.3f, %.1f deg |", r.firstStrain / 0.1, r.partedStrain, r.tilt );
				low = std::min( low, r.firstStrain / 0.1 );
				high = std::max( high, r.firstStrain / 0.1 );
				tilt = std::max( tilt, r.tilt );
			}
			std::printf( "\n" );
		}
		std::printf( "%s: breaks at %.3f to %.3f of what was set, tilt up to %.1f degrees\n\n", rule == BreakRule::Plane ? "plane" : "distance", low, high, tilt );
	}
}

} // namespace pliant::experiment
