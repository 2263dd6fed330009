#pragma once

// Scenes in which bodies have to fall asleep, explicit and implicit.

#include "pliant/soft_body_world.h"
#include "support/explicit_material.h"

namespace pliant::test {

inline constexpr Elasticity kSteps[] = { Elasticity::Explicit, Elasticity::Implicit };

inline Material materialOf( Elasticity elasticity, float youngsModulus )
{
	Material material = test::explicitMaterial();
	material.elasticity = elasticity;
	material.youngsModulus = youngsModulus;
	return material;
}

inline int awakeBodies( SoftBodyWorld& world )
{
	int count = 0;
	for ( int k = 0; k < world.softBodyCount(); ++k )
	{
		count += world.softBody( k )->isActive() ? 1 : 0;
	}
	return count;
}

} // namespace pliant::test
