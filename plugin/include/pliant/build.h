#pragma once

// What this build of the library has. Each feature can be left out by a CMake option, PLIANT_WITH_FRACTURE=OFF and so on; what asks for it
// then is refused with a sentence that says so.

#include "pliant/export.h"

namespace pliant {

enum class Feature : int
{
	Fracture,     ///< breaking and cutting: Fracture with a rule, SoftBody::cutPlane and its like
	Levels,       ///< levels of detail: Adaptivity::coarseLevels
	Plasticity,   ///< Material::yieldStrain
	Implicit,     ///< Elasticity::Implicit; Automatic steps explicitly
	Surface,      ///< skins and drawn cracks: templates need Skinning::None
	FarLevels,    ///< Material::farLevels
	Clusters,     ///< Method::SingleCluster and Clusters
	SelfCollision ///< SoftBody::setSelfCollision
};

constexpr int kFeatureCount = 8;

PLIANT_API bool hasFeature( Feature feature );

/// Its name, e.g. "SelfCollision". Never null.
PLIANT_API const char* toString( Feature feature );

} // namespace pliant
