#pragma once

// The sources of the vertices of a drawn surface, from which a game derives any attribute of them: colours, further texture coordinates,
// weights of its own.

#include "pliant/export.h"
#include "pliant/result.h"

#include <cstdint>

namespace pliant {

/// A drawn vertex as a weighted mean of vertices of the input mesh. Vertices of crack faces come from none of them.
struct VertexSource
{
	/// Value of `vertex[0]` for a vertex of a crack face.
	static constexpr std::uint32_t kInside = 0xffffffffu;

	std::uint32_t vertex[3]; ///< of the input mesh; unused ones repeat the first, with weight 0
	float weight[3];         ///< sums to 1; all 0 for a vertex of a crack face
};

/// Of all vertices of a surface.
struct VertexSourceView
{
	const VertexSource* sources = nullptr; ///< one per vertex; null: vertex i is the input's vertex i
	int vertexCount = 0;                   ///< as SurfaceView::vertexCount
	unsigned topologyVersion = 0;          ///< as SurfaceView::topologyVersion
};

/// Computes an attribute of all vertices: `out`, `components` floats per vertex, from `input`, as many per vertex of the input mesh.
/// Vertices of crack faces get `inside`, `components` floats; null: zeros. Errors: BadArgument for null arrays, for components below 1,
/// and for a number of vertices below 0.
PLIANT_API Status interpolateAttribute(
	const VertexSourceView& vertices, const float* input, int components, const float* inside, float* out );

} // namespace pliant
