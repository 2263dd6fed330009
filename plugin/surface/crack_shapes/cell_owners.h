#pragma once

// Which cell each piece of the surface and each side of a face belongs to. Mostly the one cell at its position; but a position may hold
// several parts of the material, or a crumb that was too small for a cell, which then goes with its neighbour.

#include "lattice/lattice.h"
#include "surface/crack_shapes/crack_faces.h"

#include <cstdint>
#include <vector>

namespace pliant {

struct CellOwners
{
	std::vector<std::uint32_t> ofPolygon;
	std::vector<std::uint32_t> below; ///< by part of a face: the cell under it
	std::vector<std::uint32_t> above;
	int adopted = 0; ///< pieces of material that went to a cell at another position
};

CellOwners findOwners(
	const Lattice& lattice, const ClippedSurface& surface, const FaceParts& faces, const std::vector<std::uint32_t>& merged );

/// Whether two cells are linked in the lattice as it was built.
bool areLinked( const Lattice& lattice, std::uint32_t a, std::uint32_t b );

} // namespace pliant
