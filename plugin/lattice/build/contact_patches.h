#pragma once

// Fits the drawn surface in front of the cells, so that contacts occur at the drawn surface and not at the cells' balls.

#include "lattice/inside/grid.h"
#include "lattice/lattice.h"
#include "lattice/mesh/weld.h"

namespace pliant {

class TaskRunner;

/// Fills Lattice::patch, edgeFace and overhang. `lattice`: complete otherwise, with rest centres relative to its mass centre; `mesh`:
/// oriented; `runner`: may be null, the result does not depend on it. A cell has no patch where the nearby surface is not a smooth sheet in
/// front of it: at edges, in thin parts, within the body. At edges and in thin parts it has up to four faces instead, one in each direction
/// in which the surface near it faces.
void fitContactPatches( const WeldedMesh& mesh, const Grid& grid, TaskRunner* runner, Lattice& lattice );

} // namespace pliant
