// Boxes of any size slide over a soft body as over a rigid floor. On one sphere a cell small ones would fall into the gaps between four of
// them, where a box of half a cell at 2 m/s came to .02 to .28 of its distance, and large ones are braked by the next sphere.

#include "support/slides.h"
#include "world/test_world.h"

#include <cstdio>

namespace pliant {
namespace {

/// Expects all distances within `most` of theory for steps of length `step`, s.
void expectSlides( test::SlidingBox box, std::initializer_list<double> frictions, double step, double most )
{
	for ( const double speed : { 2.0, 4.0 } )
	{
		for ( const double friction : frictions )
		{
			box.speed = speed;
			box.friction = friction;
			const double slid = test::slideOnATrack( box );
			std::printf( "%.1f cells, %.0f m/s, friction %.1f: %.3f of theory\n", box.cells, speed, friction, slid );
			// Positions follow the velocity at each step's end, which is lower by mu g h: of v^2 / ( 2 mu g ) a part of mu g h / v is lost.
			EXPECT_NEAR( slid, 1.0 - friction * test::kGravity * step / speed, most ) << box.cells << " " << speed << " " << friction;
		}
	}
}

constexpr double kSizes[] = { 0.5, 1.0, 2.0, 5.0 }; // cells

TEST( Slides, OfAnImplicitTrackFollowTheory )
{
	for ( const double cells : kSizes )
	{
		expectSlides( { .elasticity = Elasticity::Implicit, .cells = cells }, { 0.0, 0.1, 0.3, 0.6, 1.0 }, double( test::kFrame ), 0.045 );
	}
}

// In substeps theory loses little. Friction below the surface tipped boxes of half a cell at friction 0.6, and of 1 and 5 cells at 1.
TEST( Slides, OfAnExplicitTrackFollowTheory )
{
	for ( const double cells : kSizes )
	{
		expectSlides( { .elasticity = Elasticity::Explicit, .cells = cells }, { 0.0, 0.1, 0.3, 0.6, 1.0 }, 0.0, 0.03 );
	}
}

// Nodes' spheres of two bodies interlock: a soft box came to .2 to .8 of its distance, and stood on any slope.
TEST( Slides, OfSoftBoxesOnAnImplicitTrackFollowTheory )
{
	for ( const double ownCell : { 0.1, 0.06 } ) // m, on cells of .1 m
	{
		expectSlides( { .elasticity = Elasticity::Implicit, .cells = 5.0, .ownCell = ownCell }, { 0.0, 0.1, 0.3, 0.6 },
			double( test::kFrame ), 0.045 );
	}
}

// Two layers of nodes of 2 or 4 cells, of which the lower one is pinned; small boxes fell through, and larger ones were braked by the
// spheres. Where the track refines, the borders of levels move with the box. Pinned nodes share contacts: without them friction acts at the
// height of the free nodes, and tips what is smaller than a node.
TEST( Slides, OfATrackWithLevelsFollowTheory )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		const bool isImplicit = elasticity == Elasticity::Implicit;
		for ( const int levels : { 1, 2 } )
		{
			for ( const bool refines : { false, true } )
			{
				for ( const double cells : kSizes )
				{
					expectSlides( { .elasticity = elasticity, .cells = cells, .coarseLevels = levels, .refines = refines }, { 0.3, 0.6 },
						isImplicit ? double( test::kFrame ) : 0.0, isImplicit ? 0.045 : 0.03 );
				}
			}
		}
	}
}

// The second layer of a body's side faces the first layer of another's top, and where sizes differ the two are near enough to be paired.
TEST( Slides, OfSoftBoxesOnATrackWithLevelsFollowTheory )
{
	for ( const int levels : { 1, 2 } )
	{
		for ( const bool refines : { false, true } )
		{
			for ( const double ownCell : { 0.1, 0.06 } )
			{
				for ( const double cells : { 3.0, 5.0 } )
				{
					test::SlidingBox box{ .elasticity = Elasticity::Implicit, .cells = cells, .ownCell = ownCell, .coarseLevels = levels };
					box.refines = refines;
					box.friction = 0.3;
					const double slid = test::slideOnATrack( box );
					EXPECT_NEAR( slid, 1.0, 0.05 ) << levels << " " << refines << " " << ownCell << " " << cells;
				}
			}
		}
	}
}

TEST( Slides, BeginADegreeAboveTheAngleOfFrictionAndNotADegreeBelow )
{
	for ( const double ownCell : { 0.0, 0.1, 0.06 } ) // m; 0: rigid
	{
		for ( const double friction : { 0.1, 0.3, 0.6 } )
		{
			const test::SlidingBox box{ .elasticity = Elasticity::Implicit, .cells = 5.0, .friction = friction, .ownCell = ownCell };
			const double below = test::slideOnASlope( box, -1.0 ), above = test::slideOnASlope( box, 1.0 );
			std::printf( "own cells of %.2f m, friction %.1f: %.3f below, %.3f above\n", ownCell, friction, below, above );
			EXPECT_LT( below, 0.05 ) << ownCell << " " << friction;
			EXPECT_NEAR( above, 1.0, 0.35 ) << ownCell << " " << friction; // of the small difference between weight and friction
		}
	}
}

} // namespace
} // namespace pliant
