// A part of fracture_full_test, for the short tests.

#include "support/random_breaking.h"

namespace pliant {
namespace {

TEST( RandomBreaking, LeavesEveryStructureWhole )
{
	const test::BreakingCounts counts = test::breakAtRandom( 24, 10, 1 );
	EXPECT_GE( counts.events, 200 );
	EXPECT_GT( counts.healed, 0 );
	EXPECT_GT( counts.pieces, 100 );
	EXPECT_GT( counts.removed, 0 );
	EXPECT_GT( counts.splits, 0 );
	for ( const int kind : counts.kind )
	{
		EXPECT_GT( kind, 0 );
	}
}

} // namespace
} // namespace pliant
