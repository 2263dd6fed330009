#include "support/snapshot_fuzz.h"

namespace pliant::test {
namespace {

TEST( Snapshots, DamagedOnesAreRefusedOrCanBeStepped )
{
	SnapshotFuzz fuzz( 1 );
	for ( int k = 0; k < 1000 && !testing::Test::HasFailure(); ++k )
	{
		fuzz.once();
	}
	EXPECT_GT( fuzz.refused, 500 );
	EXPECT_GT( fuzz.accepted, 20 ); // most changes of a position's bits give a valid position
}

} // namespace
} // namespace pliant::test
