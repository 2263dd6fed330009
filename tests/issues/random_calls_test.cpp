// Public calls in any order, valid and invalid, as in a game of many authors: no dangling pointers, no bad numbers, and rigid bodies that
// touch no soft body behave as in Bullet's own world. Most useful under sanitizers, with far more sequences:
//
//     PLIANT_RANDOM_SEQUENCES=100000 PLIANT_RANDOM_FIRST=0 issues_fuzz

#include "issues/random_calls.h"

#include <cstdlib>

namespace pliant::test {
namespace {

int numberFrom( const char* name, int otherwise )
{
	const char* const text = std::getenv( name );
	return text ? std::atoi( text ) : otherwise;
}

TEST( RandomCalls, InAnyOrderKeepTheStateValid )
{
	const int count = numberFrom( "PLIANT_RANDOM_SEQUENCES", 200 ), first = numberFrom( "PLIANT_RANDOM_FIRST", 0 );
	int compared = 0, calls = 0, removed = 0;
	for ( int k = 0; k < count; ++k )
	{
		RandomCalls sequence( static_cast<unsigned>( first + k ) );
		sequence.run();
		compared += sequence.comparesBystanders() ? 1 : 0;
		calls += sequence.calls();
		removed += sequence.removedInCallbacks();
		ASSERT_FALSE( testing::Test::HasFailure() ) << "sequence " << first + k;
	}
	std::printf( "%d sequences, %d calls, %d bodies removed in callbacks; bystanders compared in %d\n", count, calls, removed, compared );
	EXPECT_TRUE( count < 200 || ( compared > 20 && removed > 0 ) );
}

} // namespace
} // namespace pliant::test
