// The tree compared with the sum over all triangles, and with known values.

#include "lattice_checks.h"

#include "lattice/inside/inside_field.h"

#include <cmath>

namespace pliant::test {

namespace {

struct Soup
{
	std::vector<Vec3d> position;
	std::vector<Triangle> triangle;
};

Soup soupOf( const Mesh& mesh )
{
	Soup soup;
	for ( std::size_t i = 0; i < mesh.vertexCount(); ++i )
	{
		soup.position.emplace_back( mesh.positions[3 * i], mesh.positions[3 * i + 1], mesh.positions[3 * i + 2] );
	}
	for ( std::size_t t = 0; t < mesh.triangleCount(); ++t )
	{
		soup.triangle.push_back( { mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2] } );
	}
	return soup;
}

/// The sum over every triangle: tan( Omega / 2 ) = a . ( b x c ) / ( |a||b||c| + ( a . b ) |c| + ( b . c ) |a| + ( c . a ) |b| ).
double windingAt( const std::vector<Vec3d>& position, const std::vector<Triangle>& triangle, const Vec3d& point )
{
	double sum = 0.0;
	for ( const Triangle& t : triangle )
	{
		const Vec3d a = position[t[0]] - point, b = position[t[1]] - point, c = position[t[2]] - point;
		const double la = a.norm(), lb = b.norm(), lc = c.norm();
		sum += std::atan2( a.dot( b.cross( c ) ), la * lb * lc + a.dot( b ) * lc + b.dot( c ) * la + c.dot( a ) * lb );
	}
	return sum / ( 2.0 * 3.14159265358979 );
}

double windingAt( const Soup& soup, const Vec3d& point )
{
	return windingAt( soup.position, soup.triangle, point );
}

std::vector<Vec3d> randomPoints( int count, double reach )
{
	std::vector<Vec3d> points;
	std::uint32_t state = 11;
	const auto random = [&]() {
		state = state * 1664525u + 1013904223u;
		return reach * ( double( state >> 8 ) / 8388608.0 - 1.0 );
	};
	for ( int i = 0; i < count; ++i )
	{
		const double x = random();
		const double y = random();
		points.emplace_back( x, y, random() );
	}
	return points;
}

TEST( WindingNumber, TreeAgreesWithTheSum )
{
	for ( const Mesh& mesh : { makeSphere( 1.0, 32, 64 ), makeTorus( 1.0, 0.3, 48, 24 ), makeBumpySphere( 1.0, 0.3, 40, 40 ),
			  without( makeSphere( 1.0, 32, 64 ), []( std::size_t t ) { return t % 62 > 20; } ) } )
	{
		const Soup soup = soupOf( mesh );
		const WindingTree tree( soup.position, soup.triangle );
		for ( const Vec3d& p : randomPoints( 500, 1.5 ) )
		{
			EXPECT_NEAR( tree.at( p ), windingAt( soup, p ), 0.05 );
		}
	}
}

TEST( WindingNumber, OneInsideNoneOutside )
{
	const Soup soup = soupOf( makeSphere( 1.0, 32, 64 ) );
	const WindingTree tree( soup.position, soup.triangle );
	for ( const Vec3d& p : randomPoints( 500, 1.5 ) )
	{
		if ( std::abs( p.norm() - 1.0 ) > 0.01 )
		{
			EXPECT_NEAR( windingAt( soup, p ), p.norm() < 1.0 ? 1.0 : 0.0, 1e-9 );
			EXPECT_NEAR( tree.at( p ), p.norm() < 1.0 ? 1.0 : 0.0, 0.05 );
		}
	}
}

TEST( WindingNumber, FlippedIsNegativeAndTwiceIsTwo )
{
	const Soup once = soupOf( flipped( makeSphere( 1.0, 16, 32 ) ) );
	EXPECT_NEAR( windingAt( once, Vec3d::Zero() ), -1.0, 1e-6 );
	EXPECT_NEAR( WindingTree( once.position, once.triangle ).at( Vec3d::Zero() ), -1.0, 0.05 );
	const Soup twice = soupOf( joined( makeSphere( 1.0, 16, 32 ), makeSphere( 0.5, 16, 32 ) ) );
	EXPECT_NEAR( windingAt( twice, Vec3d::Zero() ), 2.0, 1e-6 );
	EXPECT_NEAR( WindingTree( twice.position, twice.triangle ).at( Vec3d::Zero() ), 2.0, 0.05 );
}

TEST( WindingNumber, AHemisphereIsHalfAtItsMiddle )
{
	const Soup bowl = soupOf( without( makeSphere( 1.0, 32, 64 ), []( std::size_t t ) { return t % 62 >= 31; } ) );
	EXPECT_NEAR( windingAt( bowl, Vec3d::Zero() ), 0.5, 1e-6 );
	EXPECT_NEAR( WindingTree( bowl.position, bowl.triangle ).at( Vec3d::Zero() ), 0.5, 0.05 );
}

TEST( WindingNumber, CountingAndCapsGiveTheSameAsTheWholeSum )
{
	// A ball with a hole: the whole sum W = count - caps. Along any ray to the outside the count is the signed crossings of surface and
	// caps.
	const Mesh mesh = without( makeSphere( 1.0, 32, 64 ), []( std::size_t t ) { return t % 62 < 9; } );
	LatticeSettings settings;
	WeldedMesh welded;
	BuildReport report;
	ASSERT_TRUE( weldMesh( mesh.view(), settings, welded, report ).ok() );
	cleanTriangles( welded, report );
	const std::vector<RimEdge> rim = orientTriangles( welded, report );
	ASSERT_EQ( rim.size(), 64u );
	const InsideField field( welded, rim );
	ASSERT_FALSE( field.isSoup() );
	for ( const Vec3d& p : randomPoints( 300, 1.3 ) )
	{
		// Closed by caps the ball lacks its top: inside is below the rim's plane.
		const double top = std::cos( 5.0 * 3.14159265358979 / 32.0 );
		if ( std::abs( p.norm() - 1.0 ) > 0.02 && std::abs( p.z() - top ) > 0.02 )
		{
			const int count = p.norm() < 1.0 && p.z() < top ? 1 : 0;
			EXPECT_NEAR( field.winding( count, p ), windingAt( welded.position, welded.triangle, p ), 0.05 );
		}
	}
}

} // namespace

} // namespace pliant::test
