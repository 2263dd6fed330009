#pragma once

// Which features this build of the library has. Each can be left out by a CMake option (PLIANT_WITH_FRACTURE=OFF and so on); calls that
// need a missing feature are refused with ResultCode::BadArgument and a sentence that names the option; those that return no Status do
// nothing, as stated at each.

#include "pliant/export.h"

namespace pliant {

/// A part of the library that can be left out.
enum class Feature : int
{
	Fracture,     ///< breaking and cutting: Fracture with a rule, SoftBody::cutPlane, cutSphere and cutSweep
	Levels,       ///< levels of detail: Adaptivity::coarseLevels
	Plasticity,   ///< Material::yieldStrain
	Surface,      ///< skins and drawn cracks. Without it templates need Skinning::None.
	FarLevels,    ///< Material::farLevels
	Clusters,     ///< Method::SingleCluster and Method::Clusters
	SelfCollision ///< SoftBody::setSelfCollision
};

/// Number of features.
constexpr int kFeatureCount = 7;

/// True where this build has the feature; false for a value that is no Feature.
[[nodiscard]] PLIANT_API bool hasFeature( Feature feature );

/// The feature's name, e.g. "SelfCollision"; "unknown" for a value that is no Feature. Never null.
[[nodiscard]] PLIANT_API const char* toString( Feature feature );

} // namespace pliant
