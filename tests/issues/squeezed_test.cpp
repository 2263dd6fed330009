// A body squeezed flatter than the width of its nodes returns no more energy than was put in.

#include "support/squeezes.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

void expectBounded( const test::Squeeze& how )
{
	const test::Squeezed squeezed = test::squeeze( how );
	EXPECT_TRUE( squeezed.isHealthy );
	EXPECT_LT( squeezed.late, 1.5 * squeezed.early + 1.0 );
	EXPECT_LT( squeezed.motion, squeezed.strain + squeezed.out );
}

// A press squeezes a soft cube to .09 m above the floor, less than its nodes' width of .1 m, waits for some seconds and rises. The released
// energy must not exceed what the springs can store, and must not grow with the waiting time.
TEST( Squeezed, ByAPlateNearerToTheFloorThanANodeIsWide )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		test::Squeeze how;
		how.elasticity = elasticity;
		expectBounded( how );
	}
	test::Squeeze stiff;
	stiff.elasticity = Elasticity::Implicit;
	stiff.youngsModulus = 1e7;
	stiff.gap = 0.06;
	stiff.seconds = 2.0;
	expectBounded( stiff );
}

// The same cube is created between two walls .32 m apart: contact impulses must not grow without bound.
TEST( Squeezed, InASlotBetweenTwoWalls )
{
	for ( const double gap : { 0.32, 0.09 } )
	{
		test::Squeeze how;
		how.isSlot = true;
		how.gap = gap;
		how.elasticity = Elasticity::Implicit;
		how.seconds = 2.0;
		expectBounded( how );
	}
}

TEST( Squeezed, WithLevelsAndPlastic )
{
	test::Squeeze levels;
	levels.elasticity = Elasticity::Implicit;
	levels.coarseLevels = 1;
	levels.seconds = 2.0;
	expectBounded( levels );
	test::Squeeze plastic;
	plastic.elasticity = Elasticity::Implicit;
	plastic.yieldStrain = 0.05f;
	plastic.seconds = 2.0;
	expectBounded( plastic );
}

} // namespace
} // namespace pliant
