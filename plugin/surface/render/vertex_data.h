#pragma once

// Sources of vertices, and tangents: attributes that are computed on request.

#include "pliant/render/vertex_source.h"
#include "surface/crack_mesh/crack_view.h"
#include "surface/skin/skinning.h"

#include <vector>

namespace pliant {

class TaskRunner;

/// Of one body. Empty arrays: not computed yet, or none.
struct VertexData
{
	std::vector<VertexSource> sources; ///< empty: vertex i is the input's vertex i
	std::vector<float> restTangents;   ///< 4 per vertex, in the undeformed shape
	std::vector<float> tangents;       ///< 4 per vertex, of the drawn surface
	bool areSourcesKnown = false, areRestTangentsKnown = false, areTangentsKnown = false;
	unsigned sourceVersion = 0, restVersion = 0; ///< fracture versions that they are of
	unsigned tangentFrame = 0;                   ///< of `tangents`
};

/// The sources of the vertices of a cracked surface.
std::vector<VertexSource> sourcesOf( const CrackView& cracks, const CellComplex& complex );

/// Tangents of the input's vertices from its texture coordinates, 4 floats per vertex: along the surface in the direction of growing u,
/// weighted by area. Vertices without area or texture gradient get a direction at a right angle to `normals`.
std::vector<float> tangentsFromTexture(
	const float* positions, const float* texture, const SkinTriangles& triangles, const std::vector<Vec3>& normals );

/// Tangents of a cracked surface from those of the input's vertices.
std::vector<float> crackTangents( const CrackView& cracks, const std::vector<VertexSource>& sources, const float* input );

/// Rotates rest tangents as the nodes' maps move the vertices, at a right angle to `normals` (3 floats per vertex).
void turnTangents( const SkinBinding& binding, const SkinPose& pose, const std::vector<float>& rest, const float* normals,
	std::vector<float>& tangents, TaskRunner* runner );

} // namespace pliant
