// Welding, duplicates, and orientation of triangles.

#include "lattice_checks.h"

#include "lattice/mesh/weld.h"

#include <cmath>

namespace pliant::test {

namespace {

struct Welded
{
	WeldedMesh mesh;
	BuildReport report;
	std::vector<RimEdge> rim;
};

Welded weld( const Mesh& mesh, float tolerance )
{
	Welded out;
	LatticeSettings settings;
	settings.weldTolerance = tolerance;
	EXPECT_TRUE( weldMesh( mesh.view(), settings, out.mesh, out.report ).ok() );
	cleanTriangles( out.mesh, out.report );
	out.rim = orientTriangles( out.mesh, out.report );
	return out;
}

TEST( Weld, SeamsClose )
{
	const Mesh sphere = makeSphere( 1.0, 16, 32 );
	const Welded seams = weld( unwelded( sphere ), 1e-6f );
	EXPECT_EQ( seams.mesh.position.size(), sphere.vertexCount() );
	EXPECT_TRUE( seams.rim.empty() );
	EXPECT_EQ( seams.report.weldedVertices, int( 3 * sphere.triangleCount() - sphere.vertexCount() ) );
	// Exact duplicates are merged at tolerance zero, too.
	EXPECT_EQ( weld( unwelded( sphere ), 0.0f ).mesh.position.size(), sphere.vertexCount() );
}

TEST( Weld, AcrossTheBordersOfBuckets )
{
	// Each corner slightly displaced, at any position in the grid of buckets.
	const Mesh sphere = makeSphere( 1.0, 40, 80 );
	Mesh shaken = unwelded( sphere );
	std::uint32_t state = 7;
	for ( float& x : shaken.positions )
	{
		state = state * 1664525u + 1013904223u;
		x += 1e-4f * ( float( state >> 8 ) / 16777216.0f - 0.5f );
	}
	const Welded seams = weld( shaken, 1e-4f );
	EXPECT_EQ( seams.mesh.position.size(), sphere.vertexCount() );
	EXPECT_TRUE( seams.rim.empty() );
	// Points farther apart are not merged.
	EXPECT_GT( weld( shaken, 1e-6f ).mesh.position.size(), 2 * sphere.vertexCount() );
}

TEST( Weld, MatchesTheReference )
{
	Mesh mesh;
	std::uint32_t state = 3;
	const auto random = [&state]() {
		state = state * 1664525u + 1013904223u;
		return double( state >> 8 ) / 16777216.0;
	};
	for ( std::uint32_t t = 0; t < 300; ++t )
	{
		for ( int k = 0; k < 3; ++k )
		{
			mesh.addVertex( random(), random(), random() );
		}
		mesh.addTriangle( 3 * t, 3 * t + 1, 3 * t + 2 );
	}
	const Welded fast = weld( mesh, 0.01f );
	int mistakes = 0;
	int near = 0;
	for ( std::size_t i = 0; i < mesh.vertexCount(); ++i )
	{
		for ( std::size_t j = i + 1; j < mesh.vertexCount(); ++j )
		{
			const float* p = &mesh.positions[3 * i];
			const float* q = &mesh.positions[3 * j];
			const double distance = Vec3d( double( p[0] ) - q[0], double( p[1] ) - q[1], double( p[2] ) - q[2] ).norm();
			near += distance <= fast.mesh.tolerance;
			mistakes += distance <= fast.mesh.tolerance && fast.mesh.weldedVertex[i] != fast.mesh.weldedVertex[j];
		}
	}
	EXPECT_GT( near, 0 );
	EXPECT_EQ( mistakes, 0 );
}

TEST( Weld, DoublesGoAndDoubleSidedSurfacesStay )
{
	const Mesh sphere = makeSphere( 1.0, 16, 32 );
	const Welded twice = weld( joined( sphere, sphere ), 1e-6f );
	EXPECT_EQ( twice.mesh.triangle.size(), sphere.triangleCount() );
	EXPECT_TRUE( twice.rim.empty() );
	const Welded bothSides = weld( joined( sphere, flipped( sphere ) ), 1e-6f );
	EXPECT_EQ( bothSides.mesh.triangle.size(), sphere.triangleCount() );
	EXPECT_TRUE( bothSides.rim.empty() );
	EXPECT_EQ( bothSides.report.droppedTriangles, int( sphere.triangleCount() ) );
}

TEST( Orient, AMoebiusStripEndsAndStaysOpen )
{
	Mesh strip;
	const int n = 32;
	for ( int i = 0; i < n; ++i )
	{
		const double a = 2.0 * 3.14159265 * i / n;
		for ( const double side : { -0.2, 0.2 } )
		{
			const double r = 1.0 + side * std::cos( 0.5 * a );
			strip.addVertex( r * std::cos( a ), r * std::sin( a ), side * std::sin( 0.5 * a ) );
		}
	}
	for ( std::uint32_t i = 0; i < n; ++i )
	{
		const bool isLast = i + 1 == n;
		const std::uint32_t c = isLast ? 1 : 2 * i + 2;
		const std::uint32_t d = isLast ? 0 : 2 * i + 3;
		strip.addQuad( 2 * i, 2 * i + 1, d, c );
	}
	const Welded welded = weld( strip, 1e-6f );
	EXPECT_EQ( welded.report.shells, 1 );
	EXPECT_GE( welded.rim.size(), std::size_t( 2 * n ) );
}

} // namespace

} // namespace pliant::test
