#pragma once

// How the drawn surface lies in front of the cells behind it, so that what touches a body touches what is drawn and not the cells' balls.

#include "lattice/inside/grid.h"
#include "lattice/lattice.h"
#include "lattice/mesh/weld.h"

namespace pliant {

/// Fills Lattice::patch. `lattice`: finished but for them, its rest centres relative to its mass centre; `mesh`: oriented. A cell has no
/// patch where the surface near it is no smooth sheet in front of it: at edges, in thin parts, in shells of one cell, within the body.
void fitContactPatches( const WeldedMesh& mesh, const Grid& grid, Lattice& lattice );

} // namespace pliant
