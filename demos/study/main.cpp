// +-----------------------------------------------------------------------------------------------------------------+
// | pliant_study: error against run time for the user's mesh.                                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/materials.h"
#include "demos/study/scale.h"
#include "demos/study/stability.h"
#include "demos/study/study.h"

#include "third_party_glue/assimp_mesh.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>

namespace pliant_study {

namespace {

constexpr double kGravity = 9.81;
constexpr double kDefaultSag = 0.1; // of its own weight over E, if no modulus is given

struct Arguments
{
	std::string mesh, shape = "bunny", scene = "drop", budget;
	double diagonal = 0, modulus = 0;
	bool noPictures = false, noBullet = false;
	StudyPlan plan;
	StabilityPlan stability;
	ScalePlan scale;
	FeaturePlan features;
	MaterialPlan materials;
};

CLI::App* describeScale( CLI::App& app, ScalePlan& to )
{
	CLI::App* command = app.add_subcommand( "scale", "Instead: what a step costs against the number of nodes, bodies and threads" );
	command->add_option( "--most-nodes", to.mostNodes, "Of one body" )->check( CLI::Range( 1000, 10000000 ) )->capture_default_str();
	command->add_option( "--most-bodies", to.mostBodies, "In one world" )->check( CLI::Range( 1, 10000 ) )->capture_default_str();
	command->add_option( "--out", to.folder, "Folder for the results" )->capture_default_str();
	return command;
}

CLI::App* describeFeatures( CLI::App& app, FeaturePlan& to )
{
	CLI::App* command = app.add_subcommand( "features", "Instead: what each feature costs, off, idle and working" );
	command->add_option( "--steps", to.steps, "Game steps each" )->check( CLI::Range( 10, 100000 ) )->capture_default_str();
	command->add_option( "--out", to.folder, "Folder for the results" )->capture_default_str();
	return command;
}

CLI::App* describeMaterials( CLI::App& app, MaterialPlan& to )
{
	CLI::App* command = app.add_subcommand( "materials", "Instead: testing pieces against the theory of elasticity, M1 to M15" );
	command->add_option( "--only", to.only, "Only these, e.g. --only M1 M3" );
	command->add_flag( "--short", to.isShort, "Fewer and smaller pieces" );
	command->add_option( "--out", to.folder, "Folder for the results" )->capture_default_str();
	return command;
}

CLI::App* describeStability( CLI::App& app, StabilityPlan& to )
{
	CLI::App* command = app.add_subcommand( "stability", "Instead: extreme cases by every method, as a table of green, yellow and red" );
	command->add_option( "--steps", to.steps, "Game steps a cell" )->check( CLI::Range( 10, 10000000 ) )->capture_default_str();
	command->add_option( "--seed", to.seed, "Of what is random" )->capture_default_str();
	command->add_option( "--case", to.cases, "Only cases that begin so" );
	command->add_option( "--method", to.methods, "Only methods that begin so" );
	command->add_option( "--out", to.folder, "Folder for the results" )->capture_default_str();
	command->add_flag( "--fresh", to.isFresh, "Begin anew instead of going on with what is in the folder" );
	command->add_flag( "!--no-bullet", to.withBullet, "Without Bullet's own soft bodies" );
	return command;
}

void describe( CLI::App& app, Arguments& to )
{
	std::vector<std::string> scenes = { "all" };
	std::string about = "What is done to it: all";
	for ( const SceneInfo& scene : sceneInfos() )
	{
		scenes.push_back( scene.name );
		about += std::string( "; " ) + scene.name + " (" + scene.description + ")";
	}
	CandidatePlan& candidates = to.plan.candidates;
	app.add_option( "--mesh", to.mesh, "Model file, in metres" );
	app.add_option( "--shape", to.shape, "Built-in shape, where no file is named" )
		->check( CLI::IsMember( shapeNames() ) )
		->capture_default_str();
	app.add_option( "--diagonal", to.diagonal, "Scale it to this, m, from corner to corner; 0: as it is" )->check( CLI::Range( 0.0, 1e4 ) );
	app.add_option( "--scene", to.scene, about )->check( CLI::IsMember( scenes ) )->capture_default_str();
	app.add_option( "--modulus", to.modulus, "Young's modulus, Pa; 0: it gives by a tenth under its own weight" )
		->check( CLI::Range( 0.0, 1e12 ) );
	app.add_option( "--density", candidates.density, "kg/m^3" )->check( CLI::Range( 1e-3, 1e6 ) )->capture_default_str();
	app.add_option( "--cells", candidates.cells, "Cells of the finest candidate; the reference has 8 times as many" )
		->check( CLI::Range( 24, 100000 ) )
		->capture_default_str();
	app.add_option( "--levels", candidates.levels, "Most levels of detail" )->check( CLI::Range( 1, 4 ) )->capture_default_str();
	app.add_option( "--orientations", to.plan.orientations, "Lattice orientations for each candidate" )
		->check( CLI::Range( 1, 100 ) )
		->capture_default_str();
	app.add_option( "--only", candidates.only, "Only families that begin so, e.g. --only ours Ohta" );
	app.add_option( "--budget", to.budget, "Recommend settings for so much a game step, e.g. 1ms or 500us" );
	app.add_option( "--out", to.plan.folder, "Folder for the results [out/study_MESH]" );
	app.add_flag( "--short", candidates.isShort, "Two resolutions and few settings" );
	app.add_flag( "--no-bullet", to.noBullet, "Without Bullet's own soft bodies" );
	app.add_flag( "--no-pictures", to.noPictures, "Draw nothing" );
	app.add_flag( "--fresh", to.plan.isFresh, "Begin anew instead of going on with what is in the folder" );
}

/// s; negative if the text is not a time.
double secondsFrom( const std::string& text )
{
	double number = 0;
	int used = 0;
	if ( std::sscanf( text.c_str(), "%lf%n", &number, &used ) != 1 || !( number > 0 ) )
	{
		return -1;
	}
	const std::string unit = text.substr( std::size_t( used ) );
	return unit == "ms" || unit.empty() ? 1e-3 * number : unit == "us" ? 1e-6 * number : unit == "s" ? number : -1;
}

bool readMesh( const Arguments& arguments, pliant_glue::ModelMesh& mesh )
{
	if ( arguments.mesh.empty() )
	{
		return makeShape( arguments.shape, mesh );
	}
	pliant_glue::ReadResult read = pliant_glue::readModel( arguments.mesh );
	if ( !read.ok() )
	{
		std::fprintf( stderr, "pliant_study: %s\n", read.status.sentence.c_str() );
		return false;
	}
	mesh = std::move( read.mesh );
	return true;
}

int runProgram( int count, char** words )
{
	CLI::App app( "Error against run time: which method, at which settings, for this mesh" );
	Arguments arguments;
	describe( app, arguments );
	const CLI::App* stability = describeStability( app, arguments.stability );
	const CLI::App* materials = describeMaterials( app, arguments.materials );
	const CLI::App *scale = describeScale( app, arguments.scale ), *features = describeFeatures( app, arguments.features );
	CLI11_PARSE( app, count, words );
	if ( stability->parsed() )
	{
		return studyStability( arguments.stability );
	}
	if ( scale->parsed() )
	{
		return studyScale( arguments.scale );
	}
	if ( features->parsed() )
	{
		return studyFeatures( arguments.features );
	}
	if ( materials->parsed() )
	{
		return studyMaterials( arguments.materials );
	}
	StudyPlan& plan = arguments.plan;
	plan.budget = arguments.budget.empty() ? 0 : secondsFrom( arguments.budget );
	if ( plan.budget < 0 )
	{
		std::fprintf( stderr, "pliant_study: --budget takes a time such as 1ms or 500us.\n" );
		return 2;
	}
	pliant_glue::ModelMesh mesh;
	if ( !readMesh( arguments, mesh ) )
	{
		return 1;
	}
	plan.meshName = arguments.mesh.empty() ? arguments.shape : arguments.mesh.substr( arguments.mesh.find_last_of( '/' ) + 1 );
	const Specimen specimen = makeSpecimen( std::move( mesh ), arguments.diagonal );
	CandidatePlan& candidates = plan.candidates;
	candidates.modulus = arguments.modulus > 0 ? arguments.modulus : candidates.density * kGravity * 2 * specimen.half.y() / kDefaultSag;
	candidates.withBullet = !arguments.noBullet;
	plan.drawsPictures = !arguments.noPictures;
	if ( plan.folder.empty() )
	{
		plan.folder = "out/study_" + plan.meshName;
	}
	for ( const SceneInfo& scene : sceneInfos() )
	{
		if ( arguments.scene == "all" || arguments.scene == scene.name )
		{
			plan.scenes.push_back( scene );
		}
	}
	return study( plan, specimen );
}

} // namespace

} // namespace pliant_study

int main( int count, char** words )
{
	try
	{
		return pliant_study::runProgram( count, words );
	}
	catch ( const std::exception& error )
	{
		std::fprintf( stderr, "pliant_study: %s\n", error.what() );
		return 1;
	}
}
