// Small objects thrown at soft blocks: how many have sunk into the drawn surface a second later.

#include "experiments/experiments.h"

#include "support/small_things.h"

#include <cstdio>

namespace pliant::experiment {

void thingsExperiment( int count )
{
	std::puts( "block     step       thrown   sunk   lost   deepest, sizes   sick blocks" );
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		for ( const test::Struck kind : { test::Struck::Whole, test::Struck::Loaded, test::Struck::Cracked } )
		{
			const test::ThrownThings tally = test::throwThings( kind, elasticity, count, 1 );
			std::printf( "%-8s  %-8s  %7d  %5d  %5d  %15.2f  %12d\n",
				kind == test::Struck::Whole        ? "whole"
					: kind == test::Struck::Loaded ? "loaded"
												   : "cracked",
				elasticity == Elasticity::Implicit ? "implicit" : "explicit", tally.thrown, tally.sunk, tally.lost, tally.deepest,
				tally.sick );
		}
	}
}

} // namespace pliant::experiment
