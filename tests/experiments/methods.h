#pragma once

// The methods that the experiments compare, each a setting of one step.

#include "pliant/adaptivity.h"
#include "pliant/material.h"

#include <string>
#include <vector>

namespace pliant::experiment {

struct NamedMethod
{
	std::string name;
	Adaptivity adaptivity;
	Weights weights = Weights::Conserving;
};

/// Steinemann, Ohta, and the intermediate methods up to ours, all with `coarseLevels` levels that do not change at run time.
std::vector<NamedMethod> staticMethods( int coarseLevels );

/// Ours with refinement by strain.
std::vector<NamedMethod> refiningMethods( int coarseLevels );

} // namespace pliant::experiment
