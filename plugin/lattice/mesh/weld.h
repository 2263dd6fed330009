#pragma once

// A clean triangle list out of whatever the game hands in. Ohta et al. 2009, "Preprocessing", takes it for granted.

#include "lattice/lattice.h"
#include "pliant/body_template.h"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

using Triangle = std::array<std::uint32_t, 3>;

/// Welded, without degenerate triangles and doubles. Triangle order does not depend on the order they came in.
struct WeldedMesh
{
	std::vector<Vec3d> position;
	std::vector<Triangle> triangle;          ///< lowest vertex first, sorted
	std::vector<Triangle> leftOut;           ///< drawn, but no border of an inside: walls inside a body, and what shrank to a line
	std::vector<std::uint32_t> weldedVertex; ///< per input vertex: its number in `position`
	Vec3d low = Vec3d::Zero();               ///< bounding box of the vertices that triangles use
	Vec3d high = Vec3d::Zero();
	double tolerance = 0.0; ///< m; gaps narrower than this are none
};

/// Of some triangles on the mesh's vertices, m^2.
double areaOf( const WeldedMesh& mesh, const std::vector<Triangle>& triangles );

/// Unpaired edges: `count` more triangles run from -> to than back.
struct RimEdge
{
	std::uint32_t from;
	std::uint32_t to;
	int count;
};

/// Checks the arrays, then welds vertices nearer than settings.weldTolerance x the bounding box's diagonal.
Status weldMesh( const MeshView& mesh, const LatticeSettings& settings, WeldedMesh& out, BuildReport& report );

/// Triangles grouped by their edges: entry k of `triangle` holds edge k; entries of one edge stand together.
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
	std::vector<std::uint32_t> start; ///< one past the last: edge e is entry[ start[e] .. start[e + 1] )

	std::size_t edgeCount() const { return start.size() - 1; }
};

EdgeTable makeEdgeTable( const std::vector<Triangle>& triangles, std::size_t vertexCount );

/// Removes degenerate triangles and doubles. Of triangles on the same three vertices one stays, but a doubled wall inside a body is left
/// out altogether. Sorts the rest.
void cleanTriangles( WeldedMesh& mesh, BuildReport& report );

/// Turns triangles to agree with their neighbours, then shells that are inside out. Fills the report's edges and shells.
/// Returns the edges that still are unpaired: none when the surface is closed and the winding number everywhere whole.
std::vector<RimEdge> orientTriangles( WeldedMesh& mesh, BuildReport& report );

} // namespace pliant
