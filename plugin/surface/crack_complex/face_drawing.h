#pragma once

// Triangles of the faces between cells.

#include "surface/crack_complex/cell_complex.h"
#include "surface/crack_shapes/cell_owners.h"
#include "surface/crack_shapes/marching_squares.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

struct DrawnFaces
{
	std::vector<CrackFace> face;                              ///< without area
	std::vector<std::array<std::uint32_t, 3>> triangle;       ///< of the surface's points
	std::vector<std::uint8_t> axis;                           ///< by triangle
	std::vector<std::pair<std::uint32_t, std::uint32_t>> tie; ///< point, face: faces that pass a point
};

/// Adds points to the surface: middles of faces, and `squares` its own.
DrawnFaces drawFaces( ClippedSurface& surface, const FaceParts& parts, const CellOwners& owners, const NoiseWarp& warp,
	const CrackSettings& settings, MarchingSquares& squares );

} // namespace pliant
