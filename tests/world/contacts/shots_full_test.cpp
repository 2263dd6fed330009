// Two thousand shots, both elasticities: a thousand that the guards were made on, and as many that nothing was tuned on.

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
