// Bodies created inside other objects come out at a walking pace, however stiff they are.

#include "support/put_inside.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kFastest = 3.0, kApart = 0.75; // m/s, and fraction of the distance at which the spheres touch

void expectOut( test::PutInside how )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		how.elasticity = elasticity;
		const test::CameOut out = test::putInside( how );
		EXPECT_TRUE( out.isHealthy );
		EXPECT_LT( out.fastest, kFastest );
		EXPECT_GT( out.nearest, kApart );
	}
}

// A cube of hard rubber a third of a metre deep in the floor must be pushed up, not shot up.
TEST( PutInside, AFloor )
{
	for ( const double youngsModulus : { 1e6, 1e8 } )
	{
		test::PutInside how;
		how.youngsModulus = youngsModulus;
		how.depth = youngsModulus > 1e7 ? 0.1 : 0.3;
		expectOut( how );
	}
}

// Two cubes created at overlapping or equal positions must separate, and not at high speed.
TEST( PutInside, OneAnother )
{
	for ( const double apart : { 0.0, 0.33 } )
	{
		test::PutInside how;
		how.what = test::Inside::Cube;
		how.depth = apart;
		how.isRotated = apart == 0.33;
		expectOut( how );
	}
}

TEST( PutInside, AStaticBox )
{
	test::PutInside how;
	how.what = test::Inside::StaticBox;
	expectOut( how );
}

} // namespace
} // namespace pliant
