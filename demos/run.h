#pragma once

// Runs a scene: into files, or in a window.

#include "demos/scene.h"

#include <string>

namespace pliant_demos {

struct RunSettings
{
	StageOptions stage;
	std::string folder;       ///< frames, film and summary.json go here
	int frames = 0;           ///< 0: the scene's own length
	int framesPerSecond = 30; ///< divides kStepsPerSecond
	int width = 960, height = 540;
	float supersampling = 1.5f;
	bool render = true;
	bool showNodes = false;
	std::string exportFormat; ///< "", "glb", "gltf", "obj", "ply" or "stl"
	int draws = 1;            ///< runs of it, each with the next seed
	int exportEvery = 10;     ///< frames from one model file to the next
};

/// All return the process's exit code.
int runHeadless( const SceneEntry& entry, const RunSettings& settings );
/// `draws` times, without pictures or files: prints the means of what the scene finds out.
int runDraws( const SceneEntry& entry, const RunSettings& settings );
/// Draws each frame with skins of the library and with skins of the graphics card, and prints how far they are apart. 0 where they agree.
int compareSkins( const SceneEntry& entry, const RunSettings& settings );
int runInWindow( const SceneEntry& entry, const RunSettings& settings );

} // namespace pliant_demos
