// Boxes of .2 to 5 cells that slide over a rigid floor and over a soft track: distance over theory.

#include "experiments/experiments.h"

#include "support/slides.h"

#include <cstdio>

namespace pliant::experiment {

namespace {

void printSlides( const char* name, test::SlidingBox box )
{
	for ( const double speed : { 2.0, 4.0 } )
	{
		std::printf( "%s, %.0f m/s\ncells   friction 0   .1     .3     .6     1\n", name, speed );
		for ( const double cells : { 0.2, 0.5, 1.0, 2.0, 5.0 } )
		{
			std::printf( "%5.1f        ", cells );
			for ( const double friction : { 0.0, 0.1, 0.3, 0.6, 1.0 } )
			{
				box.speed = speed;
				box.cells = cells;
				box.friction = friction;
				std::printf( "  %5.2f", test::slideOnATrack( box ) );
			}
			std::puts( "" );
		}
	}
}

} // namespace

void slidesExperiment()
{
	printSlides( "rigid floor", { .isFloorRigid = true } );
	printSlides( "implicit", { .elasticity = Elasticity::Implicit } );
	printSlides( "explicit", { .elasticity = Elasticity::Explicit } );
}

} // namespace pliant::experiment
