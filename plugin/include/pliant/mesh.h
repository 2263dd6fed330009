#pragma once

// A triangle mesh as plain arrays: the input of BodyTemplate::build.

#include <cstddef>
#include <cstdint>

namespace pliant {

/// Non-owning view of a triangle mesh; the arrays are read only during the call. Any mesh is accepted: closed, open, self-intersecting,
/// with inconsistent orientation, unwelded, in several connected parts.
struct MeshView
{
	/// Vertex positions, m: x, y, z, then a step of `positionStride` floats from one vertex to the next. At least
	/// ( vertexCount - 1 ) * positionStride + 3 floats, finite (else NonFiniteVertex). Not null (BadArgument).
	const float* positions = nullptr;
	std::size_t vertexCount = 0;    ///< above 0, else EmptyMesh
	std::size_t positionStride = 3; ///< floats, at least 3, else BadArgument

	/// 3 * triangleCount vertex indices, each below vertexCount (else IndexOutOfRange); counter-clockwise seen from outside where the mesh
	/// has an outside. Not null (BadArgument).
	const std::uint32_t* indices = nullptr;
	std::size_t triangleCount = 0; ///< above 0, else EmptyMesh

	/// Optional (null: none); copied and returned unchanged by the template: u, v for each vertex, 2 * vertexCount floats; ...
	const float* textureCoordinates = nullptr;
	/// ... and a submesh number for each triangle, triangleCount values.
	const std::uint32_t* submeshOfTriangle = nullptr;

	/// Optional tangents for `tangents` (pliant/render/vertex_attributes.h), copied; null: computed from the texture coordinates on
	/// request. 4 * vertexCount floats, finite (else NonFiniteVertex): x, y, z and the handedness, 1 or -1.
	const float* tangents = nullptr;
};

} // namespace pliant
