#pragma once

// The material that scenes begin with: the papers' explicit step at a modulus that it reaches, so that a scene shows the same after the
// library's defaults change.

#include <pliant/material.h>

namespace pliant_demos {

inline pliant::Material explicitMaterial()
{
	pliant::Material material;
	material.youngsModulus = 2e4f; // Pa
	material.elasticity = pliant::Elasticity::Explicit;
	return material;
}

} // namespace pliant_demos
