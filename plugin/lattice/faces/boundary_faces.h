#pragma once

// The border of a lattice as triangles: the faces of cells that no link crosses. Rays meet it if a body has no drawn mesh.

#include "lattice/lattice.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

/// A closed surface. Vertices are corners of cells, shared by the cells around them that are linked there, so that the two sides of a crack
/// have vertices of their own.
struct BoundaryFaces
{
	std::vector<std::array<std::uint32_t, 3>> triangle; ///< counter-clockwise seen from outside
	std::vector<std::uint32_t> start;                   ///< the cells of vertex i are cell[start[i]] to cell[start[i + 1] - 1]
	std::vector<std::uint32_t> cell;
	std::vector<Vec3> rest; ///< by vertex, relative to the mass centre, m; of cells that are partly full, nearer to their centres
};

BoundaryFaces findBoundaryFaces( const Lattice& lattice );

} // namespace pliant
