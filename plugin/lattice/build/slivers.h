#pragma once

// Bodies that slip between the samples of every cell: a hair, a speck, a slanted foil.

#include "lattice/build/parts.h"
#include "lattice/lattice.h"

namespace pliant {

/// Cells out of rows far finer than the grid's own samples, one piece each. Empty when those find no inside either.
std::vector<CellDraft> findSliverCells( const WeldedMesh& mesh, const InsideField& field, const Grid& grid, double mostCrossings );

/// Links every cell to whatever stands next to it.
void linkAllNeighbours( const std::vector<CellDraft>& cells, const Grid& grid, Lattice& lattice );

/// Volume inside a closed surface, m^3, from rows across the whole mesh. An estimate.
double estimateVolume( const WeldedMesh& mesh, const InsideField& field, double mostCrossings );

} // namespace pliant
