// The study's arithmetic.

#include "demos/study/page.h"
#include "demos/study/scale.h"
#include "tests/support/explicit_material.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <filesystem>
#include <fstream>

namespace {

using namespace pliant_study;

Specimen cube()
{
	pliant_glue::ModelMesh mesh;
	makeShape( "cube", mesh );
	return makeSpecimen( std::move( mesh ), 0 );
}

Summary made( const char* name, double seconds, double error, bool isOurs )
{
	Summary s;
	s.candidate = s.family = name;
	s.median = seconds;
	s.errors.mean = error;
	s.isOurs = isOurs;
	s.runs = 1;
	return s;
}

Record recordOf( const char* name, int orientation, double error, double seconds )
{
	Record r;
	r.candidate = r.family = name;
	r.scene = "hang";
	r.orientation = orientation;
	r.errors.mean = error;
	r.median = seconds;
	r.slowest = 2 * seconds;
	r.curve = { error, 2 * error };
	return r;
}

TEST( Specimen, OfACubeHasItsVolumeAndItsMoments )
{
	const Specimen specimen = cube();
	EXPECT_NEAR( specimen.volume, 1.0, 1e-6 );
	EXPECT_NEAR( specimen.spread, 1.0 / 12.0, 1e-6 );
	EXPECT_NEAR( specimen.diagonal, std::sqrt( 3.0 ), 1e-6 );
	EXPECT_NEAR( specimen.fraction.sum(), 1.0, 1e-12 );
	EXPECT_NEAR( enclosedVolume( specimen.mesh, specimen.points.colwise() + Eigen::Vector3d( 1e4, 0, 0 ) ), 1.0, 1e-6 );
	pliant_glue::ModelMesh mesh;
	makeShape( "cube", mesh );
	EXPECT_NEAR( makeSpecimen( std::move( mesh ), 3.0 ).volume, std::pow( 3.0 / std::sqrt( 3.0 ), 3 ), 1e-5 );
}

TEST( Errors, OfARigidMotionAreNoneOfShape )
{
	const Specimen specimen = cube();
	const Eigen::Matrix3d turn = Eigen::AngleAxisd( 0.7, Eigen::Vector3d( 1, 2, 3 ).normalized() ).toRotationMatrix();
	const Eigen::Vector3d shift( 0.1, -0.2, 0.3 );
	EXPECT_NEAR( errorsOf( specimen, specimen.points.colwise() + shift, specimen.points ).mean, shift.norm() / specimen.diagonal, 1e-12 );
	const Errors turned = errorsOf( specimen, ( turn * specimen.points ).colwise() + shift, specimen.points );
	EXPECT_GT( turned.mean, 0.05 );
	EXPECT_LT( turned.shape, 1e-12 );
	Points pressed = specimen.points;
	pressed.row( 1 ) *= 0.9;
	EXPECT_GT( errorsOf( specimen, pressed, specimen.points ).shape, 0.01 );
}

TEST( WholeBodyAlpha, IsTheModulusOfAStretch )
{
	pliant::Material material = pliant::test::explicitMaterial();
	material.density = 1000;
	material.youngsModulus = 1e4f;
	// alpha = E h^2 / ( rho <x^2> ), <x^2> = 1/12 for a cube of 1 m.
	EXPECT_NEAR( wholeBodyAlpha( cube(), material, 1.0 / 240 ), 1e4 / 57600.0 / 1000 * 12, 1e-6 );
	material.youngsModulus = 1e9f;
	EXPECT_EQ( wholeBodyAlpha( cube(), material, 1.0 / 60 ), 1.0 );
}

TEST( Summaries, AreMeansOverOrientationsAndMarkTheFront )
{
	std::vector<Record> records = { recordOf( "slow", 0, 0.01, 3e-3 ), recordOf( "slow", 1, 0.03, 90e-3 ),
		recordOf( "slow", 2, 0.02, 5e-3 ), recordOf( "fast", 0, 0.05, 1e-3 ), recordOf( "worse", 0, 0.06, 2e-3 ),
		recordOf( "reference", 0, 0, 1 ) };
	const std::vector<Summary> all = summarise( records, "hang" );
	ASSERT_EQ( all.size(), 3u );
	EXPECT_NEAR( all[0].errors.mean, 0.02, 1e-15 );
	EXPECT_NEAR( all[0].spread, 0.01, 1e-12 );
	EXPECT_EQ( all[0].median, 5e-3 ) << "the middle one: a run that was disturbed says nothing";
	EXPECT_EQ( all[0].slowest, 10e-3 );
	EXPECT_NEAR( all[0].curve[1], 0.04, 1e-15 );
	EXPECT_TRUE( all[0].isOnFront );
	EXPECT_TRUE( all[1].isOnFront );
	EXPECT_FALSE( all[2].isOnFront );
	EXPECT_TRUE( summarise( records, "drop" ).empty() );
}

TEST( Summaries, OfSeveralScenesLeaveOutWhoWasRefusedInOne )
{
	std::vector<Summary> first = { made( "a", 1e-3, 0.01, true ), made( "b", 1e-3, 0.02, false ) }, second = first;
	second[0].errors.mean = 0.04;
	second[1].refused = "no";
	const std::vector<Summary> both = combine( { first, second } );
	ASSERT_EQ( both.size(), 1u );
	EXPECT_NEAR( both[0].errors.mean, 0.02, 1e-12 ); // the root of .01 and .04
}

TEST( Budget, TakesTheBestThatFits )
{
	std::vector<Summary> all = { made( "a", 1e-3, 0.05, true ), made( "b", 2e-3, 0.01, false ), made( "c", 0.5e-3, 0.08, true ) };
	EXPECT_EQ( best( all, 1.5e-3 )->candidate, "a" );
	EXPECT_EQ( best( all, 5e-3 )->candidate, "b" );
	EXPECT_EQ( best( all, 5e-3, true )->candidate, "a" );
	EXPECT_EQ( best( all, 1e-4 ), nullptr );
	all[1].isHealthy = false;
	EXPECT_EQ( best( all, 5e-3 )->candidate, "a" );
	EXPECT_EQ( whatIsGivenUp( all, all[0] ), "Nothing that was tried is better at any price." );
}

TEST( Standing, IsTheWorstRatioUnderTheBudget )
{
	const std::vector<Summary> all = { made( "ours", 1e-3, 0.04, true ), made( "ours, slow", 3e-3, 0.01, true ),
		made( "theirs", 1.5e-3, 0.02, false ), made( "theirs, slow", 4e-3, 0.001, false ) };
	EXPECT_NEAR( standing( all, 2e-3 ).ratio, 2.0, 1e-12 );
	EXPECT_EQ( standing( all, 2e-3 ).other, "theirs" );
	EXPECT_NEAR( standing( all, 1.0 ).ratio, 10.0, 1e-12 );
	EXPECT_EQ( standing( { all[0] }, 1.0 ).ratio, 0.0 );
}

TEST( Scale, ExponentIsTheSlopeOfTheLogarithms )
{
	EXPECT_NEAR( exponentOf( { 1, 10, 100 }, { 3, 3 * std::pow( 10, 1.3 ), 3 * std::pow( 100, 1.3 ) } ), 1.3, 1e-12 );
	EXPECT_EQ( exponentOf( { 5 }, { 1 } ), 0.0 );
}

TEST( Scale, CountsNodesAndTheirMemory )
{
	const ScaleRow one = flyingBlock( 1000, 1 ), three = pile( 3, 27, 2 );
	EXPECT_EQ( one.nodes, 1000 );
	EXPECT_GT( one.median, 0.0 );
	EXPECT_LT( one.bytes, 2000.0 );
	EXPECT_EQ( three.nodes, 81 );
	EXPECT_EQ( three.bodies, 3 );
	EXPECT_EQ( three.threads, 2 );
}

TEST( RunStore, GoesOnWhereItWasCutOff )
{
	const Specimen specimen = cube();
	StudyPlan plan;
	plan.folder = ( std::filesystem::temp_directory_path() / "pliant_run_store_test" ).string();
	plan.isFresh = true;
	std::string why;
	{
		RunStore store;
		ASSERT_TRUE( store.open( plan, specimen, why ) ) << why;
		EXPECT_TRUE( store.add( recordOf( "a", 0, 0.01, 1e-3 ) ) );
		EXPECT_TRUE( store.add( recordOf( "a", 1, 0.02, 2e-3 ) ) );
	}
	std::ofstream( plan.folder + "/runs.jsonl", std::ios::app ) << R"({"candidate": "a", "orient)"; // killed while it wrote
	plan.isFresh = false;
	{
		RunStore store;
		ASSERT_TRUE( store.open( plan, specimen, why ) ) << why;
		ASSERT_EQ( store.records().size(), 2u );
		EXPECT_EQ( store.records()[1].curve, recordOf( "a", 1, 0.02, 2e-3 ).curve );
		EXPECT_TRUE( store.has( "a", "hang", 1 ) );
		EXPECT_FALSE( store.has( "a", "hang", 2 ) );
		EXPECT_TRUE( store.add( recordOf( "a", 2, 0.02, 2e-3 ) ) );
	}
	RunStore whole;
	ASSERT_TRUE( whole.open( plan, specimen, why ) );
	EXPECT_EQ( whole.records().size(), 3u );
	plan.candidates.modulus *= 2;
	RunStore other;
	EXPECT_FALSE( other.open( plan, specimen, why ) );
	EXPECT_NE( why.find( "--fresh" ), std::string::npos );
	std::filesystem::remove_all( plan.folder );
}

TEST( Candidates, HaveNamesOfTheirOwnAndSayTheirCode )
{
	CandidatePlan plan;
	std::vector<std::string> names;
	for ( const Candidate& candidate : candidates( plan ) )
	{
		EXPECT_EQ( std::count( names.begin(), names.end(), candidate.name() ), 0 ) << candidate.name();
		names.push_back( candidate.name() );
		EXPECT_FALSE( codeOf( candidate ).empty() );
		EXPECT_TRUE( pliant::check( candidate.material ).ok() ) << candidate.name();
		EXPECT_TRUE( pliant::check( candidate.adaptivity ).ok() ) << candidate.name();
	}
	EXPECT_GT( names.size(), 40u );
	plan.only = { "Ohta" };
	for ( const Candidate& candidate : candidates( plan ) )
	{
		EXPECT_EQ( candidate.family.rfind( "Ohta", 0 ), 0u );
	}
	EXPECT_EQ( reference( plan ).cells, 8 * plan.cells );
}

} // namespace
