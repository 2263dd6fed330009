#pragma once

// Meshless shape matching as Müller et al. 2005 have it: one region for the whole body, or several overlapping boxes; rigid, linear
// and quadratic modes.

#include "lattice/lattice.h"
#include "matching/matcher.h"
#include "pliant/material.h"

#include <memory>

namespace pliant {

/// For Method::SingleCluster and Method::Clusters.
std::unique_ptr<Matcher> makeClusterMatcher( const Lattice& lattice, const Material& material, const NodeState& nodes );

} // namespace pliant
