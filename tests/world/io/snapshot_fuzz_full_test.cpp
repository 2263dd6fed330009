#include "support/snapshot_fuzz.h"

#include <cstdlib>

namespace pliant::test {
namespace {

TEST( SnapshotsFull, DamagedOnesAreRefusedOrCanBeStepped )
{
	const char* const wanted = std::getenv( "PLIANT_FUZZ_COUNT" );
	const int count = wanted ? std::atoi( wanted ) : 100000;
	SnapshotFuzz fuzz( 2 );
	for ( int k = 0; k < count && !testing::Test::HasFailure(); ++k )
	{
		fuzz.once();
	}
	std::printf( "%d damaged snapshots: %d refused, %d loaded and stepped\n", count, fuzz.refused, fuzz.accepted );
}

} // namespace
} // namespace pliant::test
