// Fast bodies do not pass through fixed walls, explicit and implicit.

#include "support/shots.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace pliant {
namespace {

using test::ShootingRange;
using test::ShotResult;

/// A subset of the shots of shots_full_test. Walls and bodies repeat with period 35: a coprime step meets all of them.
void shootSome( Elasticity elasticity, int step )
{
	const ShootingRange range;
	int hits = 0, count = 0;
	double deepest = 0.0;
	for ( int seed = 0; seed < 1000; seed += step, ++count )
	{
		const ShotResult r = range.shoot( unsigned( seed ), elasticity );
		hits += r.hits ? 1 : 0;
		deepest = std::max( deepest, r.deepest );
		EXPECT_EQ( r.behind, 0 ) << "shot " << seed << ", " << test::kShotNames[int( r.shot )] << " at " << test::kWallNames[int( r.wall )]
								 << ", " << r.speed << " m/s";
		EXPECT_TRUE( r.isHealthy ) << seed;
	}
	std::printf( "%d shots, %d hits, deepest %.2f mm\n", count, hits, 1e3 * deepest );
	EXPECT_GT( hits, count / 2 );
}

TEST( Shots, ExplicitBodiesDoNotPassThroughWalls )
{
	shootSome( Elasticity::Explicit, 8 );
}

TEST( Shots, ImplicitBodiesDoNotPassThroughWalls )
{
	shootSome( Elasticity::Implicit, 9 );
}

} // namespace
} // namespace pliant
