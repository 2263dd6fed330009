// Bars that strike the floor break about as much with coarse levels as without.

#include "support/breaking_drops.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr unsigned kDrops = 2;

int linksOnLevels( const test::Drop& drop, int levels )
{
	test::Drop onLevels = drop;
	onLevels.coarseLevels = levels;
	int links = 0;
	for ( unsigned seed = 0; seed < kDrops; ++seed )
	{
		links += test::linksBrokenBy( onLevels, seed );
	}
	return links;
}

// Cells near a big node, and cells that have just been split, must be allowed to break within the short time of an impact. Otherwise two
// levels would break a quarter of the links of the uniform lattice at a strain of .1, and a fourteenth at .2.
TEST( BreakingDrops, LevelsHardlyReduceBreaking )
{
	for ( const float strain : { 0.1f, 0.2f } )
	{
		const test::Drop drop{ Elasticity::Explicit, BreakRule::Plane, strain };
		const int uniform = linksOnLevels( drop, 0 );
		EXPECT_GT( uniform, 5000 );
		EXPECT_GT( linksOnLevels( drop, 1 ), 0.65 * uniform ) << strain;
		EXPECT_GT( linksOnLevels( drop, 2 ), ( strain < 0.15f ? 0.65 : 0.4 ) * uniform ) << strain;
	}
}

} // namespace
} // namespace pliant
