#pragma once

// Triangles of the unit cube and the unit sphere, for instanced drawing and for model files.

#include <cstdint>
#include <vector>

namespace pliant_glue {

struct Primitive
{
	std::vector<float> positions; ///< x, y, z a vertex
	std::vector<float> normals;
	std::vector<std::uint32_t> indices;
};

/// Edge 1, centre at the origin, flat faces (24 vertices).
Primitive unitCube();

/// Diameter 1, centre at the origin; an icosahedron whose triangles are cut in four `subdivisions` times, 0 to 6.
Primitive unitSphere( int subdivisions );

} // namespace pliant_glue
