// What is put into something comes out of it, at a walking pace, however stiff it is.

#include "support/put_inside.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kFastest = 3.0, kApart = 0.75; // m/s, and shares of where the spheres touch

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

// A level designer leaves a cube of hard rubber a third of a metre deep in the floor. In a rigid world it is pushed up; here it shot to ten
// metres.
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

// Two cubes spawned over one another, as happens where players drop things, stayed one inside the other for good, or left at 20 m/s if they
// had the very same place.
TEST( PutInside, OneAnother )
{
	for ( const double apart : { 0.0, 0.33 } )
	{
		test::PutInside how;
		how.what = test::Inside::Cube;
		how.depth = apart;
		how.isTurned = apart == 0.33;
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
