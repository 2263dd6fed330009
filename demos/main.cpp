// +-----------------------------------------------------------------------------------------------------------------+
// | pliant_demos: scenes by name, into files or in a window.                                                          |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/run.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>

namespace pliant_demos {

namespace {

struct Arguments
{
	RunSettings run;
	std::string scene = sceneList().front().name;
	bool list = false;
	bool window = false;
	bool noRender = false;
	bool awake = false;
	bool compareSkins = false;
};

void describe( CLI::App& app, Arguments& to )
{
	app.add_flag( "--list", to.list, "Name the scenes and end" );
	app.add_option( "--scene", to.scene, "Scene to run (see --list)" )->capture_default_str();
	app.add_option( "--out", to.run.folder, "Folder for frames, film and summary.json [out/SCENE]" );
	app.add_option( "--frames", to.run.frames, "Frames to make; 0: as long as the scene is" )->check( CLI::Range( 0, 100000 ) );
	app.add_option( "--fps", to.run.framesPerSecond, "Frames per second of film" )
		->check( CLI::IsMember( { 10, 12, 15, 20, 30, 60 } ) )
		->capture_default_str();
	app.add_option( "--width", to.run.width, "Picture width, pixels" )->check( CLI::Range( 16, 8192 ) )->capture_default_str();
	app.add_option( "--height", to.run.height, "Picture height, pixels" )->check( CLI::Range( 16, 8192 ) )->capture_default_str();
	app.add_option( "--supersampling", to.run.supersampling, "Draw so many times larger and shrink" )
		->check( CLI::Range( 1.0, 4.0 ) )
		->capture_default_str();
	app.add_flag( "--nodes", to.run.showNodes, "Draw nodes instead of skins" );
	app.add_flag( "--gpu-skin", to.run.stage.gpuSkin, "Leave skins to the graphics card" );
	app.add_flag(
		"--compare-skins", to.compareSkins, "Draw each frame both ways and compare; no files but of the frame that differs most" );
	app.add_flag( "--no-render", to.noRender, "Make no pictures" );
	app.add_option( "--export", to.run.exportFormat, "Write model files too" )
		->check( CLI::IsMember( { "glb", "gltf", "obj", "ply", "stl" } ) );
	app.add_option( "--export-every", to.run.exportEvery, "Frames from one model file to the next" )
		->check( CLI::Range( 1, 100000 ) )
		->capture_default_str();
	app.add_flag( "--window", to.window, "Show it in a window" );
	app.add_option( "--seed", to.run.stage.seed, "Seed of what is random in a scene" )->capture_default_str();
	app.add_flag( "--awake", to.awake, "Nothing falls asleep" );
	app.add_option( "--draws", to.run.draws,
		   "Run it so often, each time with the next seed, and print means of what it finds out; no pictures, no files" )
		->check( CLI::Range( 1, 1000 ) );
	app.add_option( "--snapshots", to.run.snapshots, "Save and restore it at so many random steps, and compare what follows" )
		->check( CLI::Range( 1, 1000 ) );
	app.add_option( "--threads", to.run.stage.threads, "Threads of the soft bodies" )->check( CLI::Range( 1, 64 ) )->capture_default_str();
	app.add_option( "--substeps", to.run.stage.softSubsteps, "Soft substeps a step; 0: the world's default" )->check( CLI::Range( 0, 64 ) );
	app.footer(
		"In the window: left button grabs, right turns, middle shifts, wheel zooms. With C held, soft bodies are cut along the way of the "
		"mouse, through all that lies under it. Esc closes it. The scene game_playground is played: W A S D or the arrows walk and drive, "
		"space jumps and brakes, Tab changes between the character and the car." );
	app.add_option( "--models", to.run.stage.modelFolder, "Folder made by demos/fetch_models.sh" )->capture_default_str();
}

int run( int count, char** words )
{
	CLI::App app( "Soft bodies in Bullet, scene by scene" );
	Arguments arguments;
	arguments.run.stage.modelFolder = "models";
	describe( app, arguments );
	CLI11_PARSE( app, count, words );
	if ( arguments.list )
	{
		for ( const SceneEntry& entry : sceneList() )
		{
			std::printf( "%-12s %s\n", entry.name, entry.description );
		}
		return 0;
	}
	const SceneEntry* entry = findScene( arguments.scene );
	if ( entry == nullptr )
	{
		std::fprintf( stderr, "There is no scene \"%s\"; --list names them.\n", arguments.scene.c_str() );
		return 2;
	}
	if ( arguments.run.folder.empty() )
	{
		arguments.run.folder = "out/" + arguments.scene;
	}
	arguments.run.render = !arguments.noRender;
	gDisableDeactivation = arguments.awake; // Bullet's own, of all its worlds
	if ( arguments.run.snapshots > 0 )
	{
		return runSnapshots( *entry, arguments.run );
	}
	if ( arguments.compareSkins )
	{
		return compareSkins( *entry, arguments.run );
	}
	if ( !arguments.run.exportFormat.empty() && arguments.run.stage.gpuSkin )
	{
		std::fprintf( stderr, "--export needs skins of the library, not --gpu-skin.\n" );
		return 2;
	}
	if ( arguments.run.draws > 1 && !arguments.window )
	{
		return runDraws( *entry, arguments.run );
	}
	return arguments.window ? runInWindow( *entry, arguments.run ) : runHeadless( *entry, arguments.run );
}

} // namespace

} // namespace pliant_demos

int main( int count, char** words )
{
	try
	{
		return pliant_demos::run( count, words );
	}
	catch ( const std::exception& error )
	{
		std::fprintf( stderr, "pliant_demos: %s\n", error.what() );
		return 1;
	}
}
