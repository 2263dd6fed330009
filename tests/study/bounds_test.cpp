// A short study against committed bounds: errors and ratios, never seconds.

#include "demos/study/measure.h"
#include "demos/study/summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace {

using namespace pliant_study;

constexpr int kCells = 216;
constexpr int kOrientations = 2;

Specimen bar()
{
	pliant_glue::ModelMesh mesh;
	makeShape( "bar", mesh );
	return makeSpecimen( std::move( mesh ), 1.0 );
}

/// The short list of candidates in one scene, all compared with one reference.
std::vector<Summary> shortStudy( const Specimen& specimen, const char* scene, const std::vector<std::string>& only )
{
	CandidatePlan plan;
	plan.cells = kCells;
	plan.isShort = true;
	plan.withBullet = false;
	plan.only = only;
	plan.modulus = 1e5;
	RunOrder order;
	order.scene = *findSceneInfo( scene );
	order.specimen = &specimen;
	order.candidate = reference( plan );
	Track track;
	order.track = &track;
	const Record fine = run( order );
	EXPECT_TRUE( fine.refused.empty() ) << fine.refused;
	order.track = nullptr;
	order.reference = &track;
	order.referenceBrokenAt = fine.brokenAt;
	std::vector<Record> records;
	for ( const Candidate& candidate : candidates( plan ) )
	{
		for ( int o = 0; o < kOrientations; ++o )
		{
			order.candidate = candidate;
			order.orientation = o;
			records.push_back( run( order ) );
			EXPECT_TRUE( records.back().refused.empty() ) << records.back().refused;
		}
	}
	return summarise( records, scene );
}

const Summary& named( const std::vector<Summary>& all, const std::string& name )
{
	const auto at = std::find_if( all.begin(), all.end(), [&name]( const Summary& s ) { return s.candidate == name; } );
	return at != all.end() ? *at : throw std::out_of_range( name );
}

TEST( StudyBounds, HangingBar )
{
	const Specimen specimen = bar();
	const std::vector<Summary> all = shortStudy( specimen, "hang", {} );
	const double uniform = named( all, "uniform w 1, 216 cells" ).errors.mean,
				 levels = named( all, "ours, levels, 216 cells, 2 levels" ).errors.mean;
	EXPECT_LT( uniform, 0.006 );
	EXPECT_LT( levels, 0.008 );
	EXPECT_LT( named( all, "ours, implicit, 216 cells, one step" ).errors.mean, 0.006 );
	// The papers' methods at the same cells and levels: stiffer, and their loss of momentum is visible.
	EXPECT_GT( named( all, "Steinemann, 216 cells, 2 levels" ).errors.mean, 1.5 * levels );
	EXPECT_GT( named( all, "Ohta, literal, 216 cells, 2 levels" ).errors.mean, 1.2 * levels );
	EXPECT_GT( named( all, "Müller linear, 54 cells" ).errors.mean, 1.5 * uniform );
	for ( const Summary& s : all )
	{
		EXPECT_TRUE( s.isHealthy ) << s.candidate;
	}
}

TEST( StudyBounds, FlyingBarKeepsMomentumWhereWeightsConserve )
{
	const Specimen specimen = bar();
	for ( const Summary& s : shortStudy( specimen, "fly", { "uniform", "Steinemann", "ours" } ) )
	{
		if ( s.isOurs )
		{
			EXPECT_LT( s.momentumDrift, 1e-4 ) << s.candidate;
			EXPECT_LT( s.spinDrift, 1e-3 ) << s.candidate;
			EXPECT_LT( s.energyGrowth, 1e-3 ) << s.candidate;
		}
		else
		{
			EXPECT_GT( std::max( s.momentumDrift, s.spinDrift ), 1e-3 ) << s.candidate << ": literal weights leak, or this cannot see it";
		}
	}
}

TEST( StudyBounds, TornBarBreaksInTwo )
{
	const Specimen specimen = bar();
	for ( const Summary& s : shortStudy( specimen, "tear", { "uniform w 1", "ours, levels" } ) )
	{
		EXPECT_GT( s.brokenAt, 0.0 ) << s.candidate;
		EXPECT_GE( s.curve.size(), 5u ) << s.candidate << " broke before it could be compared";
		EXPECT_GT( s.errors.mean, 0.0 ) << s.candidate;
		EXPECT_LT( s.errors.mean, 0.05 ) << s.candidate;
	}
}

TEST( Study, IsTheSameEachTime )
{
	const Specimen specimen = bar();
	Track first, second;
	for ( Track* track : { &first, &second } )
	{
		RunOrder order;
		order.scene = *findSceneInfo( "impact" );
		order.specimen = &specimen;
		CandidatePlan plan;
		plan.cells = kCells;
		order.candidate = candidates( plan ).at( 12 );
		order.orientation = 3;
		order.track = track;
		run( order );
	}
	ASSERT_EQ( first.size(), second.size() );
	for ( std::size_t k = 0; k < first.size(); ++k )
	{
		EXPECT_EQ( first[k], second[k] );
	}
}

} // namespace
