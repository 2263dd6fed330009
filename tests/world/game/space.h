#pragma once

// Common to the tests of forces: materials by density, and a world without gravity.

#include "world/test_world.h"

namespace pliant::test {

inline Material of( Elasticity elasticity, float density, float youngsModulus = 3e5f )
{
	Material material = stiff( youngsModulus );
	material.elasticity = elasticity;
	material.density = density;
	return material;
}

struct Space : TestWorld
{
	Space() { world.setGravity( btVector3( 0, 0, 0 ) ); }
};

} // namespace pliant::test
