#pragma once

// The skin of a body for a renderer that skins on the GPU: SoftBody::gpuSurface.
//
// Position of vertex v, M the 3 x 4 transform of a node (GpuSurfaceView::nodeTransforms), n( c ) the node of cell c:
//
//     blend( v ) = sum of weight x M[ n( cell ) ] over the influences of v
//     skin( v )  = blend( v ) ( rest, 1 ) + offsetTurn offset[v]
//     x( v )     = skin( v ), or where count is 0: sum of weight_k x skin( vertex_k ) over the three corners of its mix
//
// Normal, from the positions of all vertices: a = sum over the corners of the list of v of ( x1 - x0 ) x ( x2 - x0 ) of their triangles;
// where a is zero, n = blend( v ) ( restNormal, 0 ); else n = a / | a |, plus blend( v ) ( normalShift, 0 ) where that is not zero. Of a
// mix: the sum of weight_k n( vertex_k ). Normalised. docs/guide/rendering.md has the shader.

#include "pliant/render/skin_tables.h"

#include <LinearMath/btVector3.h>

namespace pliant {

/// The skin as tables and node transforms. Pointers stay valid until the next step or the next call for the body. Bodies of one template
/// that have not broken return the same `vertices`, `influences`, `mixes`, `corners` and `indices`: they can share buffers.
struct GpuSurfaceView
{
	btVector3 origin = btVector3( 0, 0, 0 ); ///< world position that skinned positions are relative to, m

	// --- small, for each frame ---
	/// Of each node 12 floats: the rows of a 3 x 4 matrix, from SkinVertex::rest to the world's axes relative to `origin`, m.
	const float* nodeTransforms = nullptr;
	int nodeCount = 0; ///< transforms in `nodeTransforms`
	/// Rotates SkinOffset::offset into the world and lets it fade: 3 x 3, row by row. Used while `offsets` has entries.
	float offsetTurn[9] = { 0, 0, 0, 0, 0, 0, 0, 0, 0 };
	unsigned frame = 0; ///< changes when `origin`, `nodeTransforms` or `offsetTurn` do

	// --- changed by events only ---
	SkinArray<SkinVertex> vertices;                ///< all drawn vertices, as in SurfaceView
	SkinArray<SkinInfluence> influences;           ///< of all vertices
	SkinArray<SkinMix> mixes;                      ///< empty as long as nothing has broken
	SkinArray<SkinCorner> corners;                 ///< for normals
	SkinArray<std::uint32_t> indices;              ///< 3 per triangle, as in SurfaceView
	SkinArray<std::uint32_t> nodeOfCell;           ///< by cell; empty: cell i is node i, as in all bodies without levels of detail
	SkinArray<SkinOffset> offsets;                 ///< one per vertex, left by a change of levels; empty: none
	const float* textureCoordinates = nullptr;     ///< as in SurfaceView
	const std::uint32_t* triangleSource = nullptr; ///< as in SurfaceView
	unsigned topologyVersion = 0;                  ///< as in SurfaceView: changes with the first five arrays
};

} // namespace pliant
