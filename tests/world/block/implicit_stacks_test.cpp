// Stacks of soft cubes, with or without rigid boxes between them, at one step of 1/60 s: they stand, sleep, and cost in proportion to their
// number of cubes. Explicit ones too.

#include "world/test_world.h"

#include "support/soft_stacks.h"

#include <algorithm>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::Stack;
using test::TestWorld;

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

// A contact was as stiff as its lighter side alone: a crate under a cube gave way for several steps, and threw it. A default cube of 125 kg
// rose to 1.07 m from .75 on a crate of .5 kg, and to 3.3 m on one of .1 kg.
TEST( ImplicitStacks, LightCratesCarryAHeavyCube )
{
	for ( const double mass : { 2.0, 0.5, 0.1 } )
	{
		TestWorld t;
		t.addFloor();
		const btScalar half = btScalar( 0.25 );
		const btRigidBody* const crate = t.addBox( btScalar( mass ), btVector3( half, half, half ), at( 0, half, 0 ) );
		const SoftBody* const cube = t.addSoft( test::block( 5, 5, 5, 0.1f ), at( 0, btScalar( 0.751 ), 0 ), Material{} );
		double highest = 0.0, fastest = 0.0;
		for ( int frame = 0; frame < 300; ++frame )
		{
			t.run( 1 );
			highest = std::max( highest, double( cube->massCentre().y() ) );
			fastest = frame > 60 ? std::max( fastest, double( cube->linearVelocity().length() ) ) : 0.0;
		}
		std::printf( "crate of %.1f kg: the cube rises to %.4f m, and moves at %.1e m/s after a second\n", mass, highest, fastest );
		EXPECT_LT( highest, 0.755 );
		EXPECT_LT( fastest, 0.02 );
		EXPECT_NEAR( crate->getWorldTransform().getOrigin().y(), half, 0.01 );
	}
}

} // namespace
} // namespace pliant
