// Bars dropped on the floor, on no coarse levels, one and two: do as many links break?

#include "experiments/experiments.h"
#include "support/breaking_drops.h"

#include <cstdio>

namespace pliant::experiment {

void dropsExperiment( int count )
{
	std::printf( "Bars of 20 x 10 x 10 cells strike the floor at 6 to 9 m/s, %d each: links broken a bar on no coarse level, and their share on one and on two\n\n"
				 "| rule, step, break strain | uniform | 1 level | 2 levels |\n|---|---|---|---|\n", count );
	for ( const BreakRule rule : { BreakRule::Plane, BreakRule::Distance } )
	{
		for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
		{
			for ( const float strain : { 0.1f, 0.2f, 0.3f } )
			{
				int links[3] = {};
				for ( int level = 0; level < 3; ++level )
				{
					for ( int seed = 0; seed < count; ++seed )
					{
						links[level] += test::linksBrokenBy( test::Drop{ elasticity, rule, strain, level }, unsigned( seed ) );
					}
				}
				std::printf( "| %s, %s, %.2f | %.0f | %.2f | %.2f |\n", rule == BreakRule::Plane ? "plane" : "distance",
					elasticity == Elasticity::Explicit ? "explicit" : "implicit", double( strain ), double( links[0] ) / count, double( links[1] ) / links[0],
					double( links[2] ) / links[0] );
				std::fflush( stdout );
			}
		}
	}
}

} // namespace pliant::experiment
