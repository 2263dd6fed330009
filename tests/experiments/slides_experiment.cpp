// Boxes of .2 to 5 cells that slide over a soft track: distance over theory.

#include "experiments/experiments.h"

#include "support/slides.h"

#include <cstdio>

namespace pliant::experiment {

void slidesExperiment()
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		for ( const bool isDrawn : { false, true } )
		{
			for ( const double speed : { 2.0, 4.0 } )
			{
				std::printf( "%s, %s, %.0f m/s\ncells   friction 0   .1     .3     .6     1\n",
					elasticity == Elasticity::Implicit ? "implicit" : "explicit", isDrawn ? "contactSurface" : "default", speed );
				for ( const double cells : { 0.2, 0.5, 1.0, 2.0, 5.0 } )
				{
					std::printf( "%5.1f        ", cells );
					for ( const double friction : { 0.0, 0.1, 0.3, 0.6, 1.0 } )
					{
						std::printf( "  %5.2f", test::slideOnATrack( { elasticity, cells, speed, friction, isDrawn } ) );
					}
					std::puts( "" );
				}
			}
		}
	}
}

} // namespace pliant::experiment
