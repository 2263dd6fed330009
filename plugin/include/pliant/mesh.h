#pragma once

// A triangle mesh as plain arrays: what a game hands in, and what it gets back each frame.

#include <cstddef>
#include <cstdint>

namespace pliant {

/// Borrowed arrays of a triangle mesh. They are read during the call only.
/// Any mesh will do: closed, open, self-cutting, flipped, unwelded, in several shells.
struct MeshView
{
	/// Vertex positions, metres: x, y, z, then `positionStride` floats on to the next vertex.
	const float* positions = nullptr;
	std::size_t vertexCount = 0;
	std::size_t positionStride = 3;

	/// Three vertex numbers a triangle, counter-clockwise seen from outside where the mesh has an outside.
	const std::uint32_t* indices = nullptr;
	std::size_t triangleCount = 0;

	/// Optional, kept and handed back untouched: u, v per vertex; a part number per triangle.
	const float* textureCoordinates = nullptr;
	const std::uint32_t* submeshOfTriangle = nullptr;
};

} // namespace pliant
