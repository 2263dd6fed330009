// Planks break by bending at their strength. Links join the centres of cells, which bending strains less than the faces, and in a plank of
// one cell not at all: planks of one to three cells carried more than four times what breaks them.

#include "support/test_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

constexpr double kSpan = 1.6, kWidth = 0.4;       // m
constexpr double kModulus = 2e8, kStrength = 1e6; // Pa

struct Plank
{
	double thickness = 0.1; // m
	double cell = 0.1;      // m
	BreakRule rule = BreakRule::Plane;
	int coarseLevels = 0;
};

/// A plank over two supports, with a bar across its middle that is pressed down ever more: the load at which it breaks over that at which
/// its lower face has the set strength, `M = F L / 4 + rho g W t L^2 / 8`, `sigma = 6 M / ( W t^2 )`.
double breakingLoad( const Plank& plank, double* energy = nullptr )
{
	test::SoftWorld world;
	const double t = plank.thickness;
	for ( const double side : { -1.0, 1.0 } )
	{
		world.add( 0, new btCylinderShapeZ( btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.4 ) ) ),
			btVector3( btScalar( side * 0.5 * kSpan ), btScalar( 1.0 ), 0 ) );
	}
	btRigidBody* const press = world.add( 20, new btCylinderShapeZ( btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.3 ) ) ),
		btVector3( 0, btScalar( 1.2 + t + 0.002 ), 0 ) );
	press->setActivationState( DISABLE_DEACTIVATION );
	Material material;
	material.youngsModulus = float( kModulus );
	material.elasticity = Elasticity::Implicit;
	material.density = 600.0f;
	Adaptivity levels;
	levels.coarseLevels = plank.coarseLevels;
	SoftBody* const body = world.add( test::boxTemplate( { 1.8f, float( t ), float( kWidth ) }, float( plank.cell ) ),
		btVector3( 0, btScalar( 1.1 + 0.5 * t ), 0 ), material, btQuaternion::getIdentity(), levels );
	Fracture fracture;
	fracture.rule = plank.rule;
	fracture.strength = float( kStrength );
	fracture.shardSize = 0.25f;
	EXPECT_TRUE( body->setFracture( fracture ).ok() );
	const double own = 600.0 * 9.81 * kWidth * t * kSpan * kSpan / 8.0;
	const double most = kStrength * kWidth * t * t / 6.0;
	const double full = 4.0 * ( most - own ) / kSpan; // N
	constexpr int kSteps = 1200;
	for ( int i = 0; i < kSteps; ++i )
	{
		const double load = 4.0 * full * i / kSteps;
		press->applyCentralForce( btVector3( 0, -btScalar( std::max( 0.0, load - 20 * 9.81 ) ), 0 ) );
		world.world.stepSimulation( btScalar( 1.0 / 60 ), 0 );
		if ( !world.world.fractureEvents().empty() )
		{
			if ( energy )
			{
				// F^2 L^3 / ( 96 E I ), the energy of the plank under the load in its middle
				const double stiffness = kModulus * kWidth * t * t * t / 12.0;
				*energy = double( world.world.fractureEvents()[0].energy ) / ( load * load * kSpan * kSpan * kSpan / ( 96.0 * stiffness ) );
			}
			return load / full;
		}
	}
	return std::numeric_limits<double>::infinity();
}

TEST( Bending, PlanksBreakAtTheirStrength )
{
	for ( const BreakRule rule : { BreakRule::Plane, BreakRule::Shards, BreakRule::Distance } )
	{
		for ( const double cell : { 0.1, 0.05, 0.1 / 3.0 } )
		{
			Plank plank;
			plank.rule = rule;
			plank.cell = cell;
			const double load = breakingLoad( plank );
			EXPECT_NEAR( load, 1.0, 0.2 ) << int( rule ) << ", cells of " << cell;
		}
	}
}

// What breaks had no energy where the links were not stretched: no sound, no dust.
TEST( Bending, EventsHaveTheEnergyOfBending )
{
	for ( const BreakRule rule : { BreakRule::Plane, BreakRule::Shards, BreakRule::Distance } )
	{
		Plank plank;
		plank.rule = rule;
		double energy = 0.0;
		breakingLoad( plank, &energy );
		EXPECT_GT( energy, 0.02 ) << int( rule ); // one or two of eighteen rows of cells, where the plank bends most
		EXPECT_LT( energy, 1.0 ) << int( rule );
	}
}

// Coarse nodes of a plank of one or two nodes have no stretch when it bends: they were never split, and nothing broke.
TEST( Bending, PlanksOnLevelsAreRefinedAndBreak )
{
	for ( const int levels : { 1, 2 } )
	{
		Plank plank;
		plank.coarseLevels = levels;
		plank.cell = levels == 1 ? 0.05 : 0.025;
		EXPECT_NEAR( breakingLoad( plank ), 1.0, 0.2 ) << levels << " levels";
	}
}

// F of a coarse node in one layer does not rotate across it, and its slope counted as shear: a plate that fell by 3 mm onto two posts broke
// at a third of its strength into 25 pieces, with 2e-5 J.
TEST( Bending, APlateOnLevelsIsLaidOnTwoPosts )
{
	test::SoftWorld world;
	for ( const double x : { -0.7, 0.7 } )
	{
		world.add( 0, new btBoxShape( btVector3( btScalar( 0.06 ), btScalar( 0.05 ), btScalar( 0.5 ) ) ),
			btVector3( btScalar( x ), btScalar( 0.05 ), 0 ) );
	}
	Material material;
	material.youngsModulus = float( kModulus );
	material.density = 600.0f;
	Adaptivity levels;
	levels.coarseLevels = 1;
	SoftBody* const plate = world.add( test::boxTemplate( { 2.0f, 0.05f, 0.8f }, 0.025f ), btVector3( 0, btScalar( 0.128 ), 0 ), material,
		btQuaternion::getIdentity(), levels );
	Fracture fracture;
	fracture.rule = BreakRule::Shards;
	fracture.breakStrain = 0.002f;
	fracture.shardSize = 0.15f;
	ASSERT_TRUE( plate->setFracture( fracture ).ok() );
	for ( int i = 0; i < 60; ++i )
	{
		world.step( 1 );
		ASSERT_EQ( world.world.stepReport().brokenLinks, 0 ) << i;
	}
}

} // namespace
} // namespace pliant
