#pragma once

// Finds the cell that owns each piece of the surface and each side of a face. Usually it is the only cell at that position; but a position
// may hold several parts of the material, or a fragment too small for a cell, which then goes to a neighbouring cell.

#include "lattice/lattice.h"
#include "surface/crack_shapes/crack_faces.h"

#include <cstdint>
#include <vector>

namespace pliant {

struct CellOwners
{
	std::vector<std::uint32_t> ofPolygon;
	std::vector<std::uint32_t> below; ///< by part of a face: the cell below it
	std::vector<std::uint32_t> above;
	int adopted = 0; ///< number of material parts assigned to a cell at another position
};

CellOwners findOwners(
	const Lattice& lattice, const ClippedSurface& surface, const FaceParts& faces, const std::vector<std::uint32_t>& merged );

/// True where two cells are linked in the given lattice.
bool areLinked( const Lattice& lattice, std::uint32_t a, std::uint32_t b );

} // namespace pliant
