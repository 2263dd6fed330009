// Boxes of .2 to 5 cells that slide over a rigid floor and over a soft track: distance over theory; and the slopes on which they slide.

#include "experiments/experiments.h"

#include "support/slides.h"

#include <cstdio>

namespace pliant::experiment {

namespace {

void printSlides( const char* name, test::SlidingBox box, std::initializer_list<double> sizes )
{
	for ( const double speed : { 2.0, 4.0 } )
	{
		std::printf( "%s, %.0f m/s\ncells   friction 0   .1     .3     .6     1\n", name, speed );
		for ( const double cells : sizes )
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

void printSlopes( const char* name, test::SlidingBox box, std::initializer_list<double> sizes )
{
	std::printf( "%s, a degree below and above the angle of friction\ncells   friction .1            .3            .6\n", name );
	for ( const double cells : sizes )
	{
		std::printf( "%5.1f     ", cells );
		for ( const double friction : { 0.1, 0.3, 0.6 } )
		{
			box.cells = cells;
			box.friction = friction;
			const double below = test::slideOnASlope( box, -1.0 ), above = test::slideOnASlope( box, 1.0 );
			std::printf( "  %5.2f %5.2f", below, above );
		}
		std::puts( "" );
	}
}

/// Calls `print` for a rigid floor, and for each kind of box on a soft track.
template <class Print>
void onAllTracks( const Print& print )
{
	const auto rigid = { 0.2, 0.5, 1.0, 2.0, 5.0 }, soft = { 2.0, 5.0 }; // cells
	constexpr double kEqual = 0.1, kFiner = 0.06;                        // cell sizes of soft boxes, m
	print( "rigid floor", { .isFloorRigid = true }, rigid );
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		std::puts( elasticity == Elasticity::Implicit ? "-- implicit" : "-- explicit" );
		print( "rigid box", { .elasticity = elasticity }, rigid );
		for ( const int levels : { 1, 2 } )
		{
			print( levels == 1 ? "rigid box, one level" : "rigid box, two levels", { .elasticity = elasticity, .coarseLevels = levels },
				rigid );
			print( levels == 1 ? "rigid box, one level, refined" : "rigid box, two levels, refined",
				{ .elasticity = elasticity, .coarseLevels = levels, .refines = true }, rigid );
		}
		print( "soft box, equal cells, one level", { .elasticity = elasticity, .ownCell = kEqual, .coarseLevels = 1 }, { 3.0, 5.0 } );
		print( "soft box, equal cells", { .elasticity = elasticity, .ownCell = kEqual }, soft );
		print( "soft box, smaller cells", { .elasticity = elasticity, .ownCell = kFiner }, soft );
	}
}

} // namespace

void slidesExperiment()
{
	onAllTracks( printSlides );
	onAllTracks( printSlopes );
}

} // namespace pliant::experiment
