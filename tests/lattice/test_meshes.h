#pragma once

// Shapes made in code, for tests and benchmarks. Plain arrays, counter-clockwise seen from outside.

#include "pliant/mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant::test {

struct Mesh
{
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;

	std::size_t vertexCount() const { return positions.size() / 3; }
	std::size_t triangleCount() const { return indices.size() / 3; }
	MeshView view() const;

	std::uint32_t addVertex( double x, double y, double z );
	void addTriangle( std::uint32_t a, std::uint32_t b, std::uint32_t c );
	/// Two triangles a b c, a c d.
	void addQuad( std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d );
};

using Point = std::array<double, 3>;

/// 12 triangles, 8 vertices.
Mesh makeBox( Point low, Point high );
/// Each face cut into n x n squares.
Mesh makeBox( Point low, Point high, int n );
/// A bar along x, cut into squares along its length.
Mesh makeBeam( double length, double width, int cuts );
Mesh makeSphere( double radius, int rings, int segments );
Mesh makeTorus( double radius, double tube, int rings, int segments );
/// A sphere with waves of height `bump`, as a fraction of the radius, similar to a scanned animal.
Mesh makeBumpySphere( double radius, double bump, int rings, int segments );
/// A union of several balls, by marching tetrahedra over n^3 cubes.
Mesh makeGlob( double radius, int n );

Mesh joined( const Mesh& a, const Mesh& b );
Mesh moved( Mesh mesh, Point by );
Mesh scaled( Mesh mesh, double by );
/// Rotated about (1, 2, 3) by an angle, radians.
Mesh rotated( Mesh mesh, double angle );
/// Every triangle inverted.
Mesh flipped( Mesh mesh );
/// Three own vertices for each triangle.
Mesh unwelded( const Mesh& mesh );
/// Without the triangles for whose numbers `drop` is true.
Mesh without( const Mesh& mesh, bool ( *drop )( std::size_t triangle ) );

} // namespace pliant::test
