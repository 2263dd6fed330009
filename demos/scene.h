#pragma once

// A demo scene: its bodies, its events, and its camera.

#include "demos/stage.h"
#include "demos/story.h"

#include <any>
#include <memory>
#include <string>
#include <vector>

namespace pliant_demos {

/// Controls that a player holds down.
struct PlayerKeys
{
	float ahead = 0, aside = 0; ///< -1 to 1; aside: to the right
	bool jump = false, change = false;

	bool isAny() const { return ahead != 0 || aside != 0 || jump || change; }
};

class Scene
{
public:
	virtual ~Scene() = default;

	/// Puts the bodies on the stage. False if one is refused; the stage's status has the reason.
	virtual bool init( Stage& stage ) = 0;

	/// Additional worlds that step together with the stage, so that the time of each is known.
	virtual std::vector<Stage*> sideStages() { return {}; }

	/// Called before and after each step of 1/60 s; `seconds` is the present time.
	virtual void beforeStep( Stage&, double /*seconds*/ ) {}
	virtual void afterStep( Stage&, double /*seconds*/ ) {}

	/// Called before each picture with up-to-date skins; may add to it.
	virtual void beforePicture( Stage&, pliant_glue::DrawList& ) {}

	/// After the last step, for the table and summary.json.
	virtual std::vector<FindingTable> findings( const Stage& ) const { return {}; }
	/// Conditions that must be met after the scene has run its whole length.
	virtual Story story( const Stage& ) const { return {}; }

	/// In a window, before each step. False for scenes that cannot be played.
	virtual bool takeKeys( const PlayerKeys& ) { return false; }

	/// State that the scene and the objects that it moves itself carry from step to step, in addition to the world's snapshot
	/// (docs/guide/saving.md): a value that another run of the scene accepts too, before its world is restored.
	virtual std::any ownState() const { return {}; }
	virtual void restoreOwnState( const std::any& ) {}

	/// Duration of the scene, s.
	virtual double duration() const = 0;
	/// Factor by which the film is slowed down.
	virtual int slowness() const { return 1; }

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

/// Null if there is no scene of that name.
const SceneEntry* findScene( const std::string& name );

// One function for each file in scenes/.
std::unique_ptr<Scene> makeBarPull();
std::unique_ptr<Scene> makeBrickWall();
std::unique_ptr<Scene> makeBulletHit();
std::unique_ptr<Scene> makeBunnyPile();
std::unique_ptr<Scene> makeBunnyTear();
std::unique_ptr<Scene> makeElephants();
std::unique_ptr<Scene> makeFlowers();
std::unique_ptr<Scene> makeGamePlayground();
std::unique_ptr<Scene> makeGlassPane();
std::unique_ptr<Scene> makeGlobDrop();
std::unique_ptr<Scene> makeHandScene();
std::unique_ptr<Scene> makeHeavyOnSoft();
std::unique_ptr<Scene> makeHello();
std::unique_ptr<Scene> makeIceFloe();
std::unique_ptr<Scene> makeLiverCut();
std::unique_ptr<Scene> makePlank();
std::unique_ptr<Scene> makePlasticBlock();
std::unique_ptr<Scene> makePuppet();
std::unique_ptr<Scene> makeRobotGrip();
std::unique_ptr<Scene> makeSlope();
std::unique_ptr<Scene> makeSoftStack();
std::unique_ptr<Scene> makeSphereCrack();
std::unique_ptr<Scene> makeStack();
std::unique_ptr<Scene> makeTable();
std::unique_ptr<Scene> makeThinFingers();
std::unique_ptr<Scene> makeVaseShatter();

} // namespace pliant_demos
