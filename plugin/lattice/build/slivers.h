#pragma once

// Bodies that lie between the samples of every cell: a hair, a speck, a slanted foil.

#include "lattice/build/parts.h"
#include "lattice/lattice.h"

namespace pliant {

/// Returns cells from rows far finer than the grid's own samples, one piece each. Empty when those find no inside either.
std::vector<CellDraft> findSliverCells( const WeldedMesh& mesh, const InsideField& field, const Grid& grid, double maxCrossings );

/// Links every cell to all its neighbours.
void linkAllNeighbours( const std::vector<CellDraft>& cells, const Grid& grid, Lattice& lattice );

/// Estimates the volume inside a closed surface, m^3, from rows across the whole mesh.
double estimateVolume( const WeldedMesh& mesh, const InsideField& field, double maxCrossings );

} // namespace pliant
