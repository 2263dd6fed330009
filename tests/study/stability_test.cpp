// Cells of the stability matrix that have to stay green, and red results that have to be recognised.

#include "demos/study/stability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace {

using namespace pliant_study;

template <class T>
const T& caseNamed( const std::vector<T>& all, const std::string& name )
{
	const auto at = std::find_if( all.begin(), all.end(), [&name]( const T& one ) { return one.name == name; } );
	return at != all.end() ? *at : throw std::out_of_range( name );
}

Verdict verdictOf( const std::string& ordeal, const std::string& method, int steps )
{
	static const std::vector<StabilityCase> kCases = stabilityCases();
	static const std::vector<StabilityMethod> kMethods = stabilityMethods( true );
	return endure( caseNamed( kCases, ordeal ), caseNamed( kMethods, method ), steps, 1 );
}

class GreenByDefault : public testing::TestWithParam<const char*>
{};

TEST_P( GreenByDefault, Stands )
{
	const Verdict verdict = verdictOf( GetParam(), "explicit", 240 );
	EXPECT_EQ( verdict.colour, Colour::Green ) << verdict.reason;
}

INSTANTIATE_TEST_SUITE_P( Cases, GreenByDefault,
	testing::Values( "alpha 1", "E 1e+06 Pa", "step 1/10 s", "step 1/10000 s", "100 m/s", "1000 m/s", "load 1:1", "flat", "mirrored",
		"scrambled", "one point", "stretched x1000", "twisted 720", "spin", "diagonal 1000 m", "1e+06 m away", "one-cell plate",
		"one-cell rod", "single cell" ) );

TEST( Verdicts, SayThatStiffnessIsOutOfReach )
{
	const Verdict verdict = verdictOf( "E 1e+09 Pa", "explicit", 60 );
	EXPECT_EQ( verdict.colour, Colour::Yellow );
	EXPECT_EQ( verdict.reason, "stiffness out of reach" );
}

/// A box of a hundred times their mass presses Bullet's own soft bodies through the floor, which has to be recognised.
TEST( Verdicts, SeeWhatGoesThroughTheFloor )
{
	const Verdict verdict = verdictOf( "load 1:100", "Bullet pose", 120 );
	if ( verdict.colour == Colour::None )
	{
		GTEST_SKIP() << verdict.reason;
	}
	EXPECT_EQ( verdict.colour, Colour::Red );
	EXPECT_GT( verdict.depth, 0.5 );
}

TEST( Verdicts, AreTheSameEachTime )
{
	const Verdict first = verdictOf( "scrambled", "refined, breaking", 60 ), second = verdictOf( "scrambled", "refined, breaking", 60 );
	EXPECT_EQ( first.colour, second.colour );
	EXPECT_EQ( first.inverted, second.inverted );
	EXPECT_EQ( first.energyGrowth, second.energyGrowth );
	EXPECT_EQ( first.recovery, second.recovery );
}

} // namespace
