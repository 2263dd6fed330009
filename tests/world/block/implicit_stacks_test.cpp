// Stacks of soft cubes, with or without rigid boxes between them, at one step of 1/60 s: they stand, sleep, and cost in proportion to their
// number of cubes. Explicit ones too.

#include "support/soft_stacks.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace pliant {
namespace {

using test::Stack;

struct Stood
{
	bool sleeps = false;
	double sunk = 0.0, aside = 0.0; ///< of the top cube, m
	/// Over all frames until it sleeps: products and passes times cubes; for explicit stacks, contacts times substeps. A pass takes longer
	/// than a product (it linearises contacts and factors the preconditioner) and is counted as one; `pliant_bench
	/// --benchmark_filter=stack` measures milliseconds.
	double work = 0.0;
	int frames = 0; ///< until it sleeps
};

Stood build( const Stack& stack )
{
	test::StackScene scene( stack );
	Stood stood;
	for ( int frame = 0; frame < 400; ++frame )
	{
		scene.step( 1 );
		const StepReport& report = scene.world.stepReport();
		const bool isImplicit = stack.elasticity == Elasticity::Implicit;
		stood.work += isImplicit ? double( ( report.implicitProducts + report.implicitPasses ) * stack.cubes )
								 : double( report.softContacts * report.substeps );
		stood.frames += isImplicit ? ( report.implicitProducts > 0 ? 1 : 0 ) : ( report.awakeSoftBodies > 0 ? 1 : 0 );
		EXPECT_TRUE( !isImplicit || report.substeps <= 1 );
	}
	stood.sleeps = scene.sleeps();
	stood.sunk = scene.top - double( scene.soft.back()->massCentre().y() );
	stood.aside = double( scene.soft.back()->massCentre().x() );
	return stood;
}

// Drawn faces lie on each other: the gaps of .01 m close, and the cubes are compressed by their weight.
TEST( ImplicitStacks, OfTwoFourAndEightCubesStandAndSleep )
{
	for ( const bool hasBoxes : { false, true } )
	{
		for ( const float youngsModulus : { 4e6f, 4e7f } )
		{
			for ( const int cubes : { 2, 4, 8 } )
			{
				if ( cubes == 8 && youngsModulus < 1e7f )
				{
					continue; // buckles under its own weight (docs/design/implicit.md)
				}
				const Stood stood = build( Stack{ cubes, hasBoxes, youngsModulus } );
				std::printf( "%d cubes%s, E %.0e: sunk by %.3f m, %.3f m aside\n", cubes, hasBoxes ? " and boxes" : "",
					double( youngsModulus ), stood.sunk, stood.aside );
				EXPECT_TRUE( stood.sleeps ) << cubes;
				EXPECT_LT( stood.sunk, 0.05 * cubes ) << cubes;
				EXPECT_NEAR( stood.aside, 0.02, 0.06 ) << cubes;
			}
		}
	}
}

// At Bullet's default friction too: two surfaces of spheres would slide into each other's hollows for seconds.
TEST( ImplicitStacks, OfEightCostAtMostFourTimesAsMuchAsOfFour )
{
	for ( const double friction : { 0.5, 0.8 } )
	{
		for ( const bool hasBoxes : { false, true } )
		{
			double cost[2] = {};
			for ( const double gap : { 0.01, 0.02 } )
			{
				for ( const int k : { 0, 1 } )
				{
					const int cubes = k == 0 ? 4 : 8, things = hasBoxes ? 2 * cubes - 1 : cubes;
					const Stood stood = build( Stack{ cubes, hasBoxes, 4e7f, friction, gap } );
					cost[k] += stood.work / stood.frames;
					EXPECT_TRUE( stood.sleeps );
					// Nothing has slid: only the compression by their weight and the gaps remain.
					EXPECT_NEAR( stood.aside, 0.02, 0.01 );
					EXPECT_LT( stood.sunk, gap * things + 0.002 * cubes );
					std::printf( "friction %.1f, %d cubes %s: asleep after %d frames, %.1f products and passes a frame, sunk by %.3f m\n",
						friction, cubes, hasBoxes ? "and boxes" : "bare", stood.frames, stood.work / stood.frames / cubes, stood.sunk );
				}
			}
			std::printf( "products and passes times cubes a frame, eight over four %.2f\n", cost[1] / cost[0] );
			EXPECT_LT( cost[1], 4.0 * cost[0] );
		}
	}
}

// At default substeps, stiff enough that eight do not buckle as an Euler column. Surfaces of spheres slide into each other's hollows: .03 m
// per cube.
TEST( ExplicitStacks, OfFourAndEightCubesStandAndSleep )
{
	const auto expectStands = []( const Stack& stack ) {
		const Stood stood = build( stack );
		EXPECT_TRUE( stood.sleeps ) << stack.cubes;
		EXPECT_NEAR( stood.aside, 0.02, 0.06 ) << stack.cubes;
		EXPECT_LT( stood.sunk, 0.05 * stack.cubes ) << stack.cubes;
		std::printf( "explicit, %d cubes%s: asleep after %d frames, %.0f contacts and substeps a frame, sunk by %.3f m\n", stack.cubes,
			stack.hasBoxes ? " and boxes" : "", stood.frames, stood.work / stood.frames, stood.sunk );
		return stood.work / stood.frames;
	};
	expectStands( Stack{ 2, true, 4e7f, 0.5, 0.01, Elasticity::Explicit } );
	expectStands( Stack{ 4, true, 4e7f, 0.5, 0.01, Elasticity::Explicit } );
	const double four = expectStands( Stack{ 4, false, 4e7f, 0.5, 0.01, Elasticity::Explicit } ),
				 eight = expectStands( Stack{ 8, false, 4e7f, 0.5, 0.01, Elasticity::Explicit } );
	std::printf( "contacts and substeps a frame, eight over four %.2f\n", eight / four );
	EXPECT_LT( eight, 4.0 * four );
}

} // namespace
} // namespace pliant
