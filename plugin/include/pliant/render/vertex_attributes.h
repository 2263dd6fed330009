#pragma once

// Tangents, and sources of vertices for other attributes. Computed on request, without a cost for other bodies.

#include "pliant/render/vertex_source.h"
#include "pliant/soft_body.h"

namespace pliant {

/// Tangents of a surface: 4 floats per vertex, along the texture's u, unit length, at a right angle to the normal; then the handedness, 1
/// or -1: bitangent = handedness x cross( normal, tangent ).
struct TangentView
{
	const float* tangents =
		nullptr;         ///< 4 per vertex; null with Skinning::None, and where the mesh has neither tangents nor texture coordinates
	int vertexCount = 0; ///< as SurfaceView::vertexCount
	unsigned topologyVersion = 0; ///< as SurfaceView::topologyVersion
	unsigned frame = 0;           ///< as SurfaceView::frame; of rest tangents 0
};

/// The sources of the vertices of SoftBody::surface and gpuSurface. Pointers stay valid until the next call after the body breaks. Empty
/// with Skinning::None. To be called as SoftBody::surface is.
PLIANT_API VertexSourceView vertexSources( const SoftBody& body );

/// Tangents in the undeformed shape: MeshView::tangents, else computed from the texture coordinates; those of vertices on cracks are
/// interpolated, those of crack faces follow their texture. For renderers that skin on the GPU: the tangent of vertex v is
/// blend( v ) ( tangent, 0 ), made orthogonal to the normal (gpu_surface.h). Pointers and calls as above.
PLIANT_API TangentView restTangents( const SoftBody& body );

/// Tangents of the surface as drawn: those of SoftBody::surface, which this calls. Pointers stay valid until the next step or the next
/// call for the body.
PLIANT_API TangentView tangents( const SoftBody& body );

} // namespace pliant
