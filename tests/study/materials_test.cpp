// The short material benchmarks: rows that have to be within their bounds are, and the others are as accurate as before.

#include "demos/study/materials.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace pliant_study;

class Materials : public testing::TestWithParam<MaterialTest>
{};

TEST_P( Materials, AreWithinTheirBounds )
{
	const std::vector<MaterialRow> rows = GetParam().measure( true );
	EXPECT_FALSE( rows.empty() );
	for ( const MaterialRow& row : rows )
	{
		std::printf( "%s %s: %g, theory %g, error %g\n", row.id.c_str(), row.what.c_str(), row.value, row.theory, row.error() );
		EXPECT_TRUE( row.hasPassed() ) << row.what << ": " << row.value << " for " << row.theory;
	}
}

std::vector<MaterialTest> withinBounds()
{
	std::vector<MaterialTest> tests;
	for ( const MaterialTest& test : materialTests() )
	{
		const std::string id = test.id;
		if ( id != "M8" && id != "M9" && id != "M10" && id != "M12" ) // rows out of reach: below
		{
			tests.push_back( test );
		}
	}
	return tests;
}

INSTANTIATE_TEST_SUITE_P(
	Short, Materials, testing::ValuesIn( withinBounds() ), []( const auto& made ) { return std::string( made.param.id ); } );

TEST( MaterialsOutOfReach, AreNoWorseThanTheyWere )
{
	for ( const MaterialRow& row : measureCook( true ) )
	{
		EXPECT_LT( std::abs( row.error() ), 0.1 ) << row.what;
	}
	for ( const MaterialRow& row : measurePlate( true ) )
	{
		EXPECT_LT( std::abs( row.error() ), 0.4 ) << row.what; // twisted, a layer of one cell is four times too stiff
	}
	for ( const MaterialRow& row : measureStretch( true ) )
	{
		EXPECT_LT( std::abs( row.error() ), 0.32 ) << row.what; // volume conservation is linear
	}
}

TEST( MaterialRows, AreJudgedByTheirErrors )
{
	MaterialRow row{ "M0", "", "", 1.04, 1, 0.05, Judge::Ratio, "" };
	EXPECT_TRUE( row.hasPassed() );
	row.value = 0.94;
	EXPECT_FALSE( row.hasPassed() );
	row = { "M0", "", "", NAN, 1, 0.05, Judge::Difference, "" };
	EXPECT_FALSE( row.hasPassed() );
	const MaterialRow spread = spreadRow( "M0", "", "", { 1, 1.2, 0.9 }, 0.3 );
	EXPECT_FALSE( spread.hasPassed() );
	EXPECT_NEAR( spread.error(), 1.2 / 0.9 - 1, 1e-12 );
}

} // namespace
