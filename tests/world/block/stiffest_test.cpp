// Bodies so stiff that floats hardly resolve their operator.

#include "support/soft_stack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace pliant {
namespace {

struct StiffStack
{
	float youngsModulus, density, cell, edge, height;
	int levels, boxes;
};

// They flew off at 157, 8.9, 3.5 and 7.0 m/s.
TEST( Stiffest, DiceAndStacksOfUnbreakableBodiesStandAndAreReported )
{
	const StiffStack stacks[] = { { 7e10f, 2500.0f, 0.0025f, 0.0075f, 0.0075f, 0, 1 }, { 7e10f, 2500.0f, 0.05f, 0.15f, 0.1f, 1, 4 },
		{ 3e10f, 2400.0f, 0.05f, 0.3f, 0.3f, 2, 3 }, { 7e10f, 2500.0f, 0.1f, 0.6f, 0.4f, 3, 4 } };
	for ( const StiffStack& stack : stacks )
	{
		test::SoftWorld world;
		world.addBoxFloor();
		Material material;
		material.youngsModulus = stack.youngsModulus;
		material.density = stack.density;
		Adaptivity adaptivity;
		adaptivity.coarseLevels = stack.levels;
		const std::vector<SoftBody*> boxes = test::addStack(
			world, stack.boxes, stack.edge, stack.height, stack.cell, material, adaptivity );
		double fastest = 0.0;
		for ( int frame = 0; frame < 240; ++frame )
		{
			world.step( 1 );
			fastest = std::max( fastest, double( boxes.back()->linearVelocity().length() ) );
			EXPECT_TRUE( frame > 0 || world.world.stepReport().unreachableStiffness == stack.boxes ) << stack.edge;
		}
		EXPECT_LT( fastest, 0.1 ) << stack.edge;
		const double top = double( stack.height ) * ( stack.boxes - 0.5 );
		EXPECT_NEAR( double( boxes.back()->massCentre().y() ), top, 0.03 * double( stack.height ) ) << stack.edge;
		EXPECT_LT( boxes.back()->stiffnessPlan().reachedModulus, 0.1f * stack.youngsModulus ) << stack.edge;
	}
}

// What breaks does so at the load that its modulus says, and what is pinned does not sag.
TEST( Stiffest, BodiesThatBreakOrArePinnedKeepTheirModulus )
{
	test::SoftWorld world;
	Material material;
	material.youngsModulus = 7e10f;
	material.density = 2500.0f;
	SoftBody* const cube = world.add( test::boxTemplate( { 0.3f, 0.3f, 0.3f }, 0.05f ), btVector3( 0, 1, 0 ), material );
	Fracture fracture;
	fracture.rule = BreakRule::Plane;
	EXPECT_TRUE( cube->setFracture( fracture ).ok() );
	SoftBody* const bar = world.add( test::boxTemplate( { 2.0f, 0.1f, 0.1f }, 0.05f ), btVector3( 0, 3, 0 ), material );
	EXPECT_TRUE( bar->pinNode( 0 ).ok() );
	world.step( 1 );
	EXPECT_EQ( bar->stiffnessPlan().reachedModulus, material.youngsModulus );
	EXPECT_EQ( world.world.stepReport().unreachableStiffness, 0 );
	EXPECT_EQ( cube->stiffnessPlan().reachedModulus, material.youngsModulus );
}

} // namespace
} // namespace pliant
