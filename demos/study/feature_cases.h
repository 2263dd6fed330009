#pragma once

// A block on a plane with one feature off, idle or working: what is timed and counted to say what the feature costs.

#include "demos/explicit_material.h"
#include "demos/study/small_world.h"

#include <pliant/build.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pliant_study {

struct FeatureCase
{
	std::string feature; ///< "plain": nothing beyond a body with a skin
	std::string state;   ///< "off", "idle: ...", "working: ..."
	pliant::Material material = pliant_demos::explicitMaterial();
	pliant::Adaptivity adaptivity;
	pliant::Skinning skinning = pliant::Skinning::NearbyNodes;
	bool isLookedAt = true; ///< its skin is asked for in every step
	std::function<void( pliant::SoftBody& )> prepare;
};

/// "idle" is switched on where nothing happens, "working" where it does.
const std::vector<FeatureCase>& featureCases();

/// How many cells the block has.
int featureCells();

/// The block, some steps after it was put there. Null where this build refuses it.
std::unique_ptr<SmallWorld> makeFeatureWorld( const FeatureCase& one );

} // namespace pliant_study
