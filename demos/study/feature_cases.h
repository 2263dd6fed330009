#pragma once

// A block on a plane with one feature off, idle or working, for measuring the cost of the feature.

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
	std::string feature; ///< "plain": no feature but a skin
	std::string state;   ///< "off", "idle: ...", "working: ..."
	pliant::Material material = pliant_demos::explicitMaterial();
	pliant::Adaptivity adaptivity;
	pliant::Skinning skinning = pliant::Skinning::NearbyNodes;
	bool isLookedAt = true; ///< its skin is read in every step
	std::function<void( pliant::SoftBody& )> prepare;
};

/// "idle": switched on, without an effect; "working": with an effect.
const std::vector<FeatureCase>& featureCases();

/// Number of cells of the block.
int featureCells();

/// The block, some steps after it was placed. Null if this build refuses it.
std::unique_ptr<SmallWorld> makeFeatureWorld( const FeatureCase& one );

} // namespace pliant_study
