// +-----------------------------------------------------------------------------------------------------------------+
// | The scenes by name.                                                                                              |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/scene.h"

#include <algorithm>

namespace pliant_demos {

const std::vector<SceneEntry>& sceneList()
{
	static const std::vector<SceneEntry> kScenes = {
		{ "bunny_pile", "The Stanford bunny and a Glob fall down stairs among rigid boxes and balls and push a hinged door open.",
			makeBunnyPile },
		{ "bar_pull",
			"Bars drawn out until they break, by both rules, at three angles to their lattices; at what strain over the one that was set.",
			makeBarPull },
		{ "brick_wall", "A heavy box drives through a wall of bricks, which breaks along its joints.", makeBrickWall },
		{ "bullet_hit",
			"Fast balls hit a soft block and foam, and a fast soft ball meets a wall of a millimetre; what goes over, what goes through.",
			makeBulletHit },
		{ "bunny_tear", "A bunny held by its head is torn by its weight; nodes and time, with merging and without.", makeBunnyTear },
		{ "elephants", "Five, ten and fifteen elephants fall, collide and break; what touches the pink ball sticks to it.", makeElephants },
		{ "flowers", "Forty flowers sway in the wind; where a finger touches one, its nodes are split.", makeFlowers },
		{ "game_playground",
			"A character walks, jumps and pushes, a car drives through a gate and a wall: a small level of a game, scripted or played.",
			makeGamePlayground },
		{ "glass_pane", "A steel ball flies through a pane of glass in its frame.", makeGlassPane },
		{ "glob_drop",
			"The same Glob falls with the uniform lattice and with three methods that know levels; colour shows how far they are from it.",
			makeGlobDrop },
		{ "hand", "The same pull at every finger of a hand with a soft little finger and a hard thumb.", makeHandScene },
		{ "heavy_on_soft", "Boxes of 1, 10, 100 and 1000 times a soft block's mass rest on blocks; in the middle, off it, on an edge.",
			makeHeavyOnSoft },
		{ "hello", "One soft cube falls on a rigid box.", makeHello },
		{ "ice_floe", "A floe floats on water; an iron ball falls on it, it cracks, and its pieces float on.", makeIceFloe },
		{ "liver_cut", "A hanging liver is cut along a scripted path; nodes are split under the blade.", makeLiverCut },
		{ "plank", "A wooden plank is bent over an edge until it splinters along its grain.", makePlank },
		{ "plastic_block", "A ball, an edge and a corner press into rubber, wax and clay; how deep, and how much is left.",
			makePlasticBlock },
		{ "puppet", "A fleshy figure follows the pose of ten bones, is let go as its own ragdoll, and is taken up again.", makePuppet },
		{ "robot_grip", "A robot's arm, a multibody, grips a soft ball, lifts it, swings around and puts it down.", makeRobotGrip },
		{ "slope", "Soft cubes and a rigid box slide down a slope, by friction and stiffness; their acceleration against theory.",
			makeSlope },
		{ "soft_stack", "Two, four and eight soft cubes on each other, and four with rigid boxes between.", makeSoftStack },
		{ "sphere_crack", "The same cracks in four spheres: bricks, Marching Squares, exact faces, exact faces with noise.",
			makeSphereCrack },
		{ "stack", "Soft cubes and rigid boxes stand on each other.", makeStack },
		{ "table", "Two legs of a laden wooden table are shot away, one after the other: it comes down with what stands on it.",
			makeTable },
		{ "thin_fingers",
			"A bar sweeps through thin fingers: a lattice of their size in the whole palm, and one with levels that has big nodes there.",
			makeThinFingers },
		{ "vase_shatter", "An iron ball falls on a brittle vase, which flies apart.", makeVaseShatter },
	};
	return kScenes;
}

const SceneEntry* findScene( const std::string& name )
{
	const std::vector<SceneEntry>& list = sceneList();
	const auto found = std::find_if( list.begin(), list.end(), [&]( const SceneEntry& entry ) { return name == entry.name; } );
	return found == list.end() ? nullptr : &*found;
}

} // namespace pliant_demos
