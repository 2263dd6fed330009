// Ten thousand random fractures and cuts.

#include "support/random_breaking.h"

namespace pliant {
namespace {

TEST( RandomBreakingFull, LeavesEveryStructureWholeTenThousandTimes )
{
	EXPECT_GE( test::breakAtRandom( 800, 20, 1000 ).events, 10000 );
}

} // namespace
} // namespace pliant
