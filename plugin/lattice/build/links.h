#pragma once

// Determines the links of a cell to its 26 neighbours. Steinemann et al. 2008, section 4.1; Rivers and James 2007, section 3.

#include "lattice/build/parts.h"
#include "lattice/lattice.h"

namespace pliant {

/// Fills linkStart, linkTo and isSurface. Returns the number of neighbouring pairs without a link.
int linkCells( const Parts& parts, const InsideField& field, TaskRunner* runner, Lattice& lattice );

} // namespace pliant
