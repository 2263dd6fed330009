#pragma once

// The mesh under study: centred, in metres, with its properties that every run needs.

#include "third_party_glue/model_file.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace pliant_study {

/// Positions of the mesh's vertices, world, m: one column for each vertex.
using Points = Eigen::Matrix<double, 3, Eigen::Dynamic>;

struct Specimen
{
	pliant_glue::ModelMesh mesh; ///< the centre of its bounding box is the origin
	Points points;               ///< the mesh's vertices in double
	Eigen::Vector3d half;        ///< half the edges of its bounding box, m
	double diagonal = 0;         ///< of the bounding box, m
	double volume = 0;           ///< enclosed volume, m^3; of an open mesh, the sum over its triangles
	double spread = 0;           ///< mean square distance from the mass centre along an axis, mean over three axes, m^2
	/// Fraction of the surface that belongs to a vertex; all sum to 1.
	Eigen::VectorXd fraction;
};

/// Reads a mesh from a file or from code. `diagonal`, m: 0 leaves the mesh's own size.
Specimen makeSpecimen( pliant_glue::ModelMesh mesh, double diagonal );

/// cube, bar, plate, rod, sphere, torus, glob or bunny. False for an unknown shape.
bool makeShape( const std::string& name, pliant_glue::ModelMesh& mesh );
const std::vector<std::string>& shapeNames();

/// The volume enclosed by the triangles with the vertices at `points`, m^3.
double enclosedVolume( const pliant_glue::ModelMesh& mesh, const Points& points );

/// FNV-1a over the mesh's bits: identifies the mesh in a result file.
std::string fingerprint( const pliant_glue::ModelMesh& mesh );

} // namespace pliant_study
