#pragma once

// The material of tests of the explicit step, independent of the default step and stiffness.

#include <pliant/material.h>

namespace pliant::test {

/// Returns a material that steps explicitly. `youngsModulus`: Pa.
inline Material explicitMaterial( float youngsModulus = 2e4f )
{
	Material material;
	material.youngsModulus = youngsModulus;
	material.elasticity = Elasticity::Explicit;
	return material;
}

} // namespace pliant::test
