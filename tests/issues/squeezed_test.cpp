// What is pressed flatter than its nodes are wide gives back no more than was put in.

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

// A press comes down on a soft cube to .09 m over the floor, where its nodes are .1 m wide, waits for some seconds and goes up again. The
// cube flew to 21 m, with eleven times the energy that its springs can hold, and the longer the press had waited the higher.
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

// The same cube comes into a level between two walls that stand .32 m apart: one contact alone pressed with ten thousand newton seconds a
// step after ten seconds.
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
