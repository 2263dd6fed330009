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
	int draws = 1;            ///< number of runs, each with the next seed
	int exportEvery = 10;     ///< frames from one model file to the next
	int snapshots = 0;        ///< random steps at which it is saved and restored
};

/// All return the process's exit code.
int runHeadless( const SceneEntry& entry, const RunSettings& settings );
/// Runs it `draws` times, without pictures or files, and prints the means of its findings.
int runDraws( const SceneEntry& entry, const RunSettings& settings );
/// Saves and restores it at random steps, and prints whether it steps on to the same bits.
int runSnapshots( const SceneEntry& entry, const RunSettings& settings );
/// Draws each frame with skins of the library and with skins of the graphics card, and prints their differences. 0 if they agree.
int compareSkins( const SceneEntry& entry, const RunSettings& settings );
int runInWindow( const SceneEntry& entry, const RunSettings& settings );

} // namespace pliant_demos
