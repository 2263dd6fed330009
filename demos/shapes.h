#pragma once

// Closed meshes made in code, which the demos use if a model file is missing.

#include "third_party_glue/model_file.h"

#include <array>
#include <vector>

namespace pliant_demos {

/// Each face cut into `cuts` x `cuts` squares, 1 to 200; centre at the origin. Vertices are shared, so shading rounds the edges.
pliant_glue::ModelMesh makeCube( float edge, int cuts );
/// The same with edges and cuts along each axis.
pliant_glue::ModelMesh makeBox( const std::array<float, 3>& edges, const std::array<int, 3>& cuts );
pliant_glue::ModelMesh makeSphere( float diameter, int subdivisions );
/// Lies flat: its axis is y.
pliant_glue::ModelMesh makeTorus( float radius, float tubeRadius, int around, int along );

/// An open vessel with the axis y: its outer line from the foot up to the lip (radius and height, m), inside it a wall and a bottom of that
/// thickness. Rows of triangles are about `row` high.
pliant_glue::ModelMesh makeVessel( const std::vector<std::array<float, 2>>& line, float wall, float row, int around );

/// An ellipsoid that adds to a blobby field: 1 at its centre, falling off as exp( -|x|^2 / radius^2 ).
struct MetaBall
{
	float centre[3];
	float radius[3];
};

/// The surface where the field of all balls is `level`, by marching tetrahedra on cubes of edge `cell`. Closed and consistently
/// oriented by construction.
pliant_glue::ModelMesh makeMetaballs( const std::vector<MetaBall>& balls, float level, float cell );

/// A blob with a few lumps, about 0.6 m across.
pliant_glue::ModelMesh makeGlob();
/// Replaces the Stanford bunny: a body, a head and two ears, about 1 m high like the scaled scan.
pliant_glue::ModelMesh makeBunnyLike();

/// Centres the mesh's bounding box at the origin and scales the mesh to the height `height`.
void fitHeight( pliant_glue::ModelMesh& mesh, float height );

} // namespace pliant_demos
