#pragma once

// Uniform lattice shape matching (Rivers and James 2007; Steinemann et al. 2008, section 3.2) on the 16-lane kernels.

#include "lattice/lattice.h"
#include "matching/matcher.h"
#include "pliant/material.h"

#include <memory>

namespace pliant {

std::unique_ptr<Matcher> makeLatticeMatcher( const Lattice& lattice, const Material& material );

} // namespace pliant
