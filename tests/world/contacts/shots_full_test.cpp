// Two thousand shots, explicit and implicit: a thousand that the guards were developed with, and a thousand for validation.

#include "support/shots.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

void shootAll( Elasticity elasticity )
{
	const test::ShootingRange range;
	for ( unsigned seed = 0; seed < 2000; ++seed )
	{
		const test::ShotResult r = range.shoot( seed, elasticity );
		EXPECT_EQ( r.behind, 0 ) << "shot " << seed;
		EXPECT_TRUE( r.isHealthy ) << "shot " << seed;
	}
}

TEST( ShotsFull, NoExplicitBodyPassesThrough )
{
	shootAll( Elasticity::Explicit );
}

TEST( ShotsFull, NoImplicitBodyPassesThrough )
{
	shootAll( Elasticity::Implicit );
}

} // namespace
} // namespace pliant
