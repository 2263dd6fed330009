// Bars dropped on the floor, without coarse levels, with one and with two: do equally many links break?

#include "experiments/experiments.h"
#include "support/breaking_drops.h"

#include <cstdio>

namespace pliant::experiment {

void dropsExperiment( int count )
{
	std::printf( "Bars of 20 x 10 x 10 cells strike the floor at 6 to 9 m/s, %d each: links broken a bar on no coarse level, and their "
				 "share on one, on two,\nand on two whose nodes are split where they touch\n\n"
				 "| rule, step, break strain | uniform | 1 level | 2 levels | 2, on contact |\n|---|---|---|---|---|\n",
		count );
	for ( const BreakRule rule : { BreakRule::Plane, BreakRule::Distance, BreakRule::Shards } )
	{
		for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
		{
			for ( const float strain : { 0.1f, 0.2f, 0.3f } )
			{
				const test::Drop drops[] = { { elasticity, rule, strain, 0 }, { elasticity, rule, strain, 1 },
					{ elasticity, rule, strain, 2 }, { elasticity, rule, strain, 2, true } };
				int links[4] = {};
				for ( int k = 0; k < 4; ++k )
				{
					for ( int seed = 0; seed < count; ++seed )
					{
						links[k] += test::linksBrokenBy( drops[k], unsigned( seed ) );
					}
				}
				std::printf( "| %s, %s, %.2f | %.0f | %.2f | %.2f | %.2f |\n",
					rule == BreakRule::Plane        ? "plane"
						: rule == BreakRule::Shards ? "shards"
													: "distance",
					elasticity == Elasticity::Explicit ? "explicit" : "implicit", double( strain ), double( links[0] ) / count,
					double( links[1] ) / links[0], double( links[2] ) / links[0], double( links[3] ) / links[0] );
				std::fflush( stdout );
			}
		}
	}
}

} // namespace pliant::experiment
