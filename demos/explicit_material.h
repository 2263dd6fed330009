#pragma once

// The initial material of scenes: the papers' explicit step with a modulus that it reaches, so that changes of the library's defaults do
// not change the scenes.

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
