// Bodies in their rigid state in a world that steps by 1/30 s.

#include "support/soft_stack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace pliant {
namespace {

// A hull on one contact lost its others while it fell by g h^2, turned about the one, and so on: boxes in stacks sank through the floor, to
// -25 m.
TEST( RigidLongSteps, StacksStayAboveTheFloor )
{
	struct Stack
	{
		float youngsModulus, density, rigidStrain, edge, height;
		int boxes, rate;
	};
	const Stack stacks[] = { { 7e10f, 2500.0f, 0.1f, 0.3f, 0.2f, 3, 30 }, { 1e7f, 1000.0f, 0.01f, 0.3f, 0.2f, 3, 30 },
		{ 7e10f, 2500.0f, 0.1f, 0.4f, 0.4f, 4, 30 }, { 1e8f, 1000.0f, 0.01f, 0.3f, 0.2f, 5, 40 } };
	for ( const Stack& stack : stacks )
	{
		test::SoftWorld world;
		world.addBoxFloor();
		Material material;
		material.youngsModulus = stack.youngsModulus;
		material.density = stack.density;
		material.rigidStrain = stack.rigidStrain;
		const std::vector<SoftBody*> boxes = test::addStack( world, stack.boxes, stack.edge, stack.height, 0.05f, material );
		double lowest = 1.0;
		for ( int frame = 0; frame < 6 * stack.rate; ++frame )
		{
			world.world.stepSimulation( btScalar( 1 ) / btScalar( stack.rate ), 0 );
			for ( const SoftBody* box : boxes )
			{
				lowest = std::min( lowest, double( box->massCentre().y() ) );
			}
		}
		EXPECT_TRUE( boxes.front()->isRigid() ) << stack.boxes;
		EXPECT_GT( lowest, 0.45 * double( stack.height ) ) << stack.boxes << " boxes of " << stack.youngsModulus << " Pa";
	}
}

} // namespace
} // namespace pliant
