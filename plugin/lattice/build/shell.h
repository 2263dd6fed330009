#pragma once

// The surface as material: one layer of cells for the surface that no cell of the inside covers.

#include "lattice/build/parts.h"

namespace pliant {

struct ShellOptions
{
	double thickness = 1.0;      ///< of the surface's material, in cells
	double area = 0.0;           ///< of the surface, in faces of a cell
	bool hasKnownInside = false; ///< the material behind the surface is too thin for a cell: the minimum fill replaces the area
	double maxCells = 0.0;       ///< limit above which nothing is added
};

/// Adds cells where the surface is farther than kShellReach from every cell's ball, or everywhere when there are no cells yet. `cells` and
/// the links of `lattice` (linkStart, linkTo, isSurface) are those of the inside, or empty. Each position on the surface gets one cell,
/// regardless of the number of layers in it; neighbours are linked where the surface connects them, or through links to a third cell.
/// Returns the number of cells added; -1, with nothing changed, when the limit would be exceeded.
int addShell( const WeldedMesh& mesh, const Grid& grid, const ShellOptions& options, std::vector<CellDraft>& cells, Lattice& lattice );

} // namespace pliant
