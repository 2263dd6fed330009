#pragma once

// A demo scene: what stands where, what happens while it runs, and where the eye is.

#include "demos/stage.h"

#include <memory>
#include <vector>

namespace pliant_demos {

class Scene
{
public:
	virtual ~Scene() = default;

	/// Put the bodies on the stage. False when one is refused; the stage's status says why.
	virtual bool init( Stage& stage ) = 0;

	/// Called before each step of 1/60 s.
	virtual void beforeStep( Stage&, double /*seconds*/ ) {}

	/// Length of the film, s.
	virtual double duration() const = 0;

	virtual pliant_glue::DrawCamera camera( double seconds ) const = 0;
	virtual pliant_glue::DrawLight light() const = 0;
};

struct SceneEntry
{
	const char* name;
	const char* description; ///< one sentence
	std::unique_ptr<Scene> ( *make )();
};

/// Every scene, in the order of the list; the first is the main one.
const std::vector<SceneEntry>& sceneList();

/// Null when there is none of that name.
const SceneEntry* findScene( const std::string& name );

// One function a file in scenes/.
std::unique_ptr<Scene> makeBunnyPile();
std::unique_ptr<Scene> makeHello();
std::unique_ptr<Scene> makeStack();

} // namespace pliant_demos
