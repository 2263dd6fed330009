// Boxes as small as the cells of a soft body slide over it as over a rigid floor. On one sphere a cell they would fall into the gaps
// between four of them: a box of half a cell at 2 m/s came to .02 to .28 of its distance.

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

TEST( SmallSlides, OfAnImplicitTrackFollowTheory )
{
	for ( const double cells : { 1.0, 2.0 } )
	{
		expectSlides( { .elasticity = Elasticity::Implicit, .cells = cells }, { 0.0, 0.1, 0.3, 0.6 }, 0.06 );
	}
	expectSlides( { .elasticity = Elasticity::Implicit, .cells = 0.5 }, { 0.0, 0.1, 0.3 }, 0.2 ); // braked by its own dent
}

TEST( SmallSlides, OfAnExplicitTrackFollowTheory )
{
	for ( const double cells : { 0.5, 1.0, 2.0 } )
	{
		expectSlides( { .elasticity = Elasticity::Explicit, .cells = cells }, { 0.0, 0.1, 0.3 }, 0.05 );
	}
}

// Larger boxes lie on the nodes' spheres unless the template asks for the drawn surface.
TEST( SmallSlides, OfLargerBoxesFollowTheoryOnTheDrawnSurface )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		expectSlides( { .elasticity = elasticity, .cells = 5.0, .contactSurface = true }, { 0.0, 0.1, 0.3, 0.6 }, 0.06 );
	}
}

} // namespace
} // namespace pliant
