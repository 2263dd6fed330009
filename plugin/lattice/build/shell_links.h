#pragma once

// Which cells a shell's cells are linked to. Apart from links.h: a shell has no samples of material, only the places that its surface
// passes.

#include "lattice/build/parts.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// What of the surface passes through one lattice position.
struct SurfacePatch
{
	std::uint64_t key = 0;
	std::uint64_t passed = 0;     ///< bit k: through part k of kShellSamples^3 of the position, x fastest
	bool isShell = false;         ///< gets a cell of its own; else it is only known because a cell of the shell is next to it
	double area = 0.0;            ///< in faces of a cell
	Vec3d moment = Vec3d::Zero(); ///< area times place, in cells from the grid's low corner
	Vec3d low = Vec3d::Constant( 1e9 ), high = Vec3d::Constant( -1e9 ); ///< box around it
};

/// Puts the shell's cells among those of the inside, in the lattice's order, and links them. `patches`: by key, ascending, those with
/// isShell as many and in the same order as `shell`. Links among the cells of the inside stay as they are.
void mergeShell( const Grid& grid, const std::vector<SurfacePatch>& patches, const std::vector<CellDraft>& shell,
	std::vector<CellDraft>& cells, Lattice& lattice );

} // namespace pliant
