// Small objects thrown at soft blocks: how many have sunk into the drawn surface a second later.

#include "experiments/experiments.h"

#include "support/small_things.h"

#include <cstdio>
#include <utility>

namespace pliant::experiment {

void thingsExperiment( int count )
{
	std::puts( "block     step       thrown   sunk   lost   deepest, sizes   sick blocks" );
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		static const std::pair<test::Struck, const char*> kKinds[] = { { test::Struck::Whole, "whole" }, { test::Struck::Loaded, "loaded" },
			{ test::Struck::Cracked, "cracked" }, { test::Struck::Coarse, "coarse" }, { test::Struck::Refining, "refining" } };
		for ( const auto& [kind, name] : kKinds )
		{
			const test::ThrownThings tally = test::throwThings( kind, elasticity, count, 1 );
			std::printf( "%-8s  %-8s  %7d  %5d  %5d  %15.2f  %12d\n", name, elasticity == Elasticity::Implicit ? "implicit" : "explicit",
				tally.thrown, tally.sunk, tally.lost, tally.deepest, tally.sick );
		}
	}
}

} // namespace pliant::experiment
