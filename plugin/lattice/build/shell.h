#pragma once

// The surface as material: one layer of cells that carry what no cell of the inside carries.

#include "lattice/build/parts.h"

namespace pliant {

struct ShellOptions
{
	double thickness = 1.0; ///< of the surface's material, in cells
	double area = 0.0;      ///< of the surface, in faces of a cell
	bool isWhole = false;   ///< the material behind the surface is known, and too thin for a cell: the least fill counts, not the surface
	double mostCells = 0.0; ///< gives up above it
};

/// Adds cells where the surface is further than kShellReach from every cell's ball; everywhere, when there is no cell yet. `cells` and the
/// links of `lattice` (linkStart, linkTo, isSurface) are those of the inside, or none. Positions where the surface passes are one cell
/// each, however many layers of it pass; neighbours are linked where the surface leads from one to the other, or through links to a third.
/// Returns how many cells were added; -1 and nothing done when there would be more than allowed.
int addShell( const WeldedMesh& mesh, const Grid& grid, const ShellOptions& options, std::vector<CellDraft>& cells, Lattice& lattice );

} // namespace pliant
