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
	std::vector<CrackFace> face;                                    ///< areas not yet set
	std::vector<std::array<std::uint32_t, 3>> triangle;             ///< indices of the surface's points
	std::vector<std::uint8_t> axis;                                 ///< by triangle
	std::vector<std::pair<std::uint32_t, std::uint32_t>> incidence; ///< point, face: the faces that contain a point
};

/// Triangulates the faces between cells. Adds points to the surface: interior points of faces, and those of `squares`.
DrawnFaces drawFaces( ClippedSurface& surface, const FaceParts& parts, const CellOwners& owners, const NoiseWarp& warp,
	const CrackSettings& settings, MarchingSquares& squares );

} // namespace pliant
