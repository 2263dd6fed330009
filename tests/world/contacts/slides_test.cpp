// Boxes of any size slide over a soft body as over a rigid floor. On one sphere a cell small ones would fall into the gaps between four of
// them, where a box of half a cell at 2 m/s came to .02 to .28 of its distance, and large ones are braked by the next sphere.

#include "support/slides.h"
#include "world/test_world.h"

#include <cstdio>

namespace pliant {
namespace {

/// Expects all distances within `most` of theory.
void expectSlides( test::SlidingBox box, std::initializer_list<double> frictions, double most )
{
	for ( const double speed : { 2.0, 4.0 } )
	{
		for ( const double friction : frictions )
		{
			box.speed = speed;
			box.friction = friction;
			const double slid = test::slideOnATrack( box );
			std::printf( "%.1f cells, %.0f m/s, friction %.1f: %.3f of theory\n", box.cells, speed, friction, slid );
			EXPECT_NEAR( slid, 1.0, most ) << box.cells << " " << speed << " " << friction;
		}
	}
}

constexpr double kSizes[] = { 0.5, 1.0, 2.0, 5.0 }; // cells

// From 2 m/s at friction 1 a box stops within a fifth of a second, and theory itself loses a twelfth in steps of a sixtieth.
TEST( Slides, OfAnImplicitTrackFollowTheory )
{
	for ( const double cells : kSizes )
	{
		expectSlides( { .elasticity = Elasticity::Implicit, .cells = cells }, { 0.0, 0.1, 0.3, 0.6 }, 0.06 );
	}
}

// Friction below the surface tipped boxes of half a cell at friction 0.6, and of 1 and 5 cells at 1.
TEST( Slides, OfAnExplicitTrackFollowTheory )
{
	for ( const double cells : kSizes )
	{
		expectSlides( { .elasticity = Elasticity::Explicit, .cells = cells }, { 0.0, 0.1, 0.3, 0.6, 1.0 }, 0.03 );
	}
}

} // namespace
} // namespace pliant
