// Conditions of a demo scene (Story).

#include "demos/story.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pliant_demos {
namespace {

TEST( Story, FailsByASentenceForEachPointThatDidNotComeAbout )
{
	Story story;
	story.atLeast( "walked, m", 3.0, 3.0 );
	story.atMost( "fell, m", 0.5, 0.5 );
	EXPECT_TRUE( story.failures().empty() );
	story.atLeast( "jumped, m", 0.2, 0.4 );
	story.atMost( "pieces", 41, 40 );
	story.atLeast( "drove, m", std::nan( "" ), 1 );
	story.atMost( "sank, m", std::nan( "" ), 1 );
	story.atLeast( "flew, m", std::numeric_limits<double>::infinity(), 1 );
	const std::vector<std::string> failures = story.failures();
	ASSERT_EQ( failures.size(), 5u );
	EXPECT_EQ( failures[0], "jumped, m: 0.2 instead of 0.4 to inf" );
	EXPECT_EQ( failures[1], "pieces: 41 instead of -inf to 40" );
	EXPECT_EQ( story.table().rows.size(), 7u );
}

} // namespace
} // namespace pliant_demos
