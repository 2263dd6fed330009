// Stacks of soft cubes, bare and with rigid boxes between them, at one step of 1/60 s: they stand, sleep, and cost as much as they have cubes. Explicit ones too.

#include "test_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

struct Stack
{
	int cubes = 4;
	bool hasBoxes = false;
	float youngsModulus = 4e7f;
	double friction = 0.5; ///< of each thing; 0.5 is Bullet's own
	double gap = 0.01;     ///< m, by which each falls on the next
	Elasticity elasticity = Elasticity::Implicit;
};

struct Stood
{
	bool sleeps = false;
	double sunk = 0.0, aside = 0.0; ///< of the top cube, m
	double work = 0.0;              ///< of all frames until it sleeps: products times cubes; of explicit ones, contacts times substeps
	int frames = 0;                 ///< until then
};

/// Every other cube stands a little aside.
Stood build( const Stack& stack )
{
	TestWorld t;
	t.addFloor();
	const auto shape = block( 6, 6, 6, 0.1f );
	Material material = test::stiff( stack.youngsModulus );
	material.elasticity = stack.elasticity;
	std::vector<SoftBody*> cubes;
	double y = stack.gap;
	for ( int k = 0; k < stack.cubes; ++k )
	{
		const btScalar aside = k % 2 == 0 ? btScalar( 0 ) : btScalar( 0.02 );
		cubes.push_back( t.addSoft( shape, at( aside, btScalar( y + 0.3 ), aside / 2 ), material ) );
		cubes.back()->setFriction( btScalar( stack.friction ) );
		y += 0.6 + stack.gap;
		if ( stack.hasBoxes && k + 1 < stack.cubes )
		{
			t.addBox( 216, btVector3( 0.3f, 0.1f, 0.3f ), at( 0, btScalar( y + 0.1 ), 0 ) )->setFriction( btScalar( stack.friction ) );
			y += 0.2 + stack.gap;
		}
	}
	const double top = y - 0.3 - stack.gap;
	Stood stood;
	for ( int frame = 0; frame < 400; ++frame )
	{
		t.run( 1 );
		const StepReport& report = t.world.stepReport();
		const bool isImplicit = stack.elasticity == Elasticity::Implicit;
		stood.work += isImplicit ? double( report.implicitProducts * stack.cubes ) : double( report.softContacts * report.substeps );
		stood.frames += isImplicit ? ( report.implicitProducts > 0 ? 1 : 0 ) : ( report.awakeSoftBodies > 0 ? 1 : 0 );
		EXPECT_TRUE( !isImplicit || report.substeps <= 1 );
	}
	stood.sleeps = std::all_of( cubes.begin(), cubes.end(), []( const SoftBody* cube ) { return cube->getActivationState() == ISLAND_SLEEPING; } );
	stood.sunk = top - double( cubes.back()->massCentre().y() );
	stood.aside = double( cubes.back()->massCentre().x() );
	return stood;
}

// The cubes' surfaces are spheres, which give way to each other's hollows where friction lets them: 0.01 to 0.05 m a cube.
TEST( ImplicitStacks, OfTwoFourAndEightCubesStandAndSleep )
{
	for ( const bool hasBoxes : { false, true } )
	{
		for ( const float youngsModulus : { 4e6f, 4e7f } )
		{
			for ( const int cubes : { 2, 4, 8 } )
			{
				if ( cubes == 8 && hasBoxes && youngsModulus < 1e7f )
				{
					continue; // buckles by its own weight (docs/implicit.md)
				}
				const Stood stood = build( Stack{ cubes, hasBoxes, youngsModulus } );
				std::printf( "%d cubes%s, E %.0e: sunk by %.3f m, %.3f m aside\n", cubes, hasBoxes ? " and boxes" : "", double( youngsModulus ), stood.sunk, stood.aside );
				EXPECT_TRUE( stood.sleeps ) << cubes;
				EXPECT_LT( stood.sunk, 0.05 * cubes ) << cubes;
				EXPECT_NEAR( stood.aside, 0.02, 0.06 ) << cubes;
			}
		}
	}
}

// At Bullet's own friction too: two surfaces of spheres would slide into each other's hollows, for seconds.
TEST( ImplicitStacks, OfEightCostAtMostFourTimesWhatFourDo )
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
					// Nothing has slid: what is left are their own weight, and the gaps they fell by.
					EXPECT_NEAR( stood.aside, 0.02, 0.01 );
					EXPECT_LT( stood.sunk, gap * things + 0.002 * cubes );
					std::printf( "friction %.1f, %d cubes %s: asleep after %d frames, %.1f products a frame, sunk by %.3f m\n", friction, cubes,
						hasBoxes ? "and boxes" : "bare", stood.frames, stood.work / stood.frames / cubes, stood.sunk );
				}
			}
			std::printf( "products times cubes a frame, eight over four %.2f\n", cost[1] / cost[0] );
			EXPECT_LT( cost[1], 4.0 * cost[0] );
		}
	}
}

// At default substeps, as stiff as eight must be to be no Euler column. Surfaces of spheres slide into each other's hollows: .03 m a cube.
TEST( ExplicitStacks, OfFourAndEightCubesStandAndSleep )
{
	double cost[2] = {};
	for ( const int k : { 0, 1 } )
	{
		const int cubes = k == 0 ? 4 : 8;
		const Stood stood = build( Stack{ cubes, false, 4e7f, 0.5, 0.01, Elasticity::Explicit } );
		cost[k] = stood.work / stood.frames;
		EXPECT_TRUE( stood.sleeps ) << cubes;
		EXPECT_NEAR( stood.aside, 0.02, 0.06 ) << cubes;
		EXPECT_LT( stood.sunk, 0.05 * cubes ) << cubes;
		std::printf( "explicit, %d cubes: asleep after %d frames, %.0f contacts and substeps a frame, sunk by %.3f m\n", cubes, stood.frames, cost[k], stood.sunk );
	}
	std::printf( "contacts and substeps a frame, eight over four %.2f\n", cost[1] / cost[0] );
	EXPECT_LT( cost[1], 4.0 * cost[0] );
}

} // namespace
} // namespace pliant
