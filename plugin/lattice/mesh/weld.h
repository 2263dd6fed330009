#pragma once

// Produces a clean triangle list from arbitrary input. Ohta et al. 2009, "Preprocessing", assumes one.

#include "lattice/lattice.h"
#include "pliant/body_template.h"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

using Triangle = std::array<std::uint32_t, 3>;

/// A welded mesh without degenerate or duplicate triangles. The order of triangles does not depend on their input order.
struct WeldedMesh
{
	std::vector<Vec3d> position;
	std::vector<Triangle> triangle; ///< lowest vertex first, sorted
	std::vector<Triangle> leftOut;  ///< drawn triangles that bound no inside: walls inside a body, and triangles that collapsed to a line
	std::vector<std::uint32_t> weldedVertex; ///< per input vertex: its index in `position`
	Vec3d low = Vec3d::Zero();               ///< bounding box of the vertices that triangles use
	Vec3d high = Vec3d::Zero();
	double tolerance = 0.0; ///< m; narrower gaps are ignored
};

/// Area of some triangles on the mesh's vertices, m^2.
double areaOf( const WeldedMesh& mesh, const std::vector<Triangle>& triangles );

/// Unpaired edges: `count` more triangles run from -> to than back.
struct RimEdge
{
	std::uint32_t from;
	std::uint32_t to;
	int count;
};

/// Checks the arrays, then welds vertices closer than settings.weldTolerance x the bounding box's diagonal.
Status weldMesh( const MeshView& mesh, const LatticeSettings& settings, WeldedMesh& out, BuildReport& report );

/// Triangles grouped by their edges; the entries of one edge are contiguous.
struct EdgeTable
{
	struct Entry
	{
		std::uint32_t low;
		std::uint32_t high;
		std::uint32_t triangle;
		bool isForward; ///< the triangle runs from low to high
	};
	std::vector<Entry> entry;
	std::vector<std::uint32_t> start; ///< one more than edges: edge e is entry[ start[e] .. start[e + 1] )

	std::size_t edgeCount() const { return start.size() - 1; }
};

EdgeTable makeEdgeTable( const std::vector<Triangle>& triangles, std::size_t vertexCount );

/// Removes degenerate and duplicate triangles. Of triangles on the same three vertices one is kept, but a doubled wall inside a body is
/// removed altogether. Sorts the rest.
void cleanTriangles( WeldedMesh& mesh, BuildReport& report );

/// Orients triangles consistently with their neighbours, then flips shells that are inside out. Fills the report's edges and shells.
/// Returns the edges that remain unpaired: none when the surface is closed and the winding number is an integer everywhere.
std::vector<RimEdge> orientTriangles( WeldedMesh& mesh, BuildReport& report );

} // namespace pliant
