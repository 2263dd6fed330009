#pragma once

// Determines the links of a shell's cells. Separate from links.h because a shell has no samples, only positions on its surface.

#include "lattice/build/parts.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// The part of the surface inside one lattice position.
struct SurfacePatch
{
	std::uint64_t key = 0;
	std::uint64_t passed = 0;     ///< bit k: through part k of kShellSamples^3 of the position, x fastest
	bool isShell = false;         ///< has a cell of its own; otherwise only present because it is next to a cell of the shell
	double area = 0.0;            ///< in faces of a cell
	Vec3d moment = Vec3d::Zero(); ///< area times position, in cells from the grid's low corner
	Vec3d low = Vec3d::Constant( 1e9 ), high = Vec3d::Constant( -1e9 ); ///< bounding box
};

/// Merges the shell's cells with those of the inside, in the lattice's order, and links them. `patches`: by ascending key, those with
/// isShell in the same number and order as `shell`. Links among the cells of the inside are kept.
void mergeShell( const Grid& grid, const std::vector<SurfacePatch>& patches, const std::vector<CellDraft>& shell,
	std::vector<CellDraft>& cells, Lattice& lattice );

} // namespace pliant
