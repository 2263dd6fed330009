// Meshes from artists, exporters and attackers.

#include "hostile_meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::test {

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Mesh cube()
{
	return makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
}

Mesh ball()
{
	return makeSphere( 1.0, 16, 32 );
}

Mesh with( Mesh mesh, std::size_t position, float value )
{
	mesh.positions[position] = value;
	return mesh;
}

Mesh withIndex( Mesh mesh, std::size_t at, std::uint32_t value )
{
	mesh.indices[at] = value;
	return mesh;
}

Mesh withVertex( Mesh mesh, double x, double y, double z )
{
	mesh.addVertex( x, y, z );
	return mesh;
}

Mesh stretched( Mesh mesh, Point by )
{
	for ( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		mesh.positions[i] = float( mesh.positions[i] * by[i % 3] );
	}
	return mesh;
}

class Random
{
public:
	double operator()()
	{
		m_state = m_state * 1664525u + 1013904223u;
		return double( m_state >> 8 ) / 16777216.0;
	}

private:
	std::uint32_t m_state = 5;
};

/// Random triangles in a unit box, each at most `size` wide.
Mesh thrown( int triangles, double size )
{
	Random random;
	Mesh mesh;
	for ( int t = 0; t < triangles; ++t )
	{
		const Point at = { random(), random(), random() };
		for ( int k = 0; k < 3; ++k )
		{
			const double x = at[0] + size * ( random() - 0.5 );
			const double y = at[1] + size * ( random() - 0.5 );
			mesh.addVertex( x, y, at[2] + size * ( random() - 0.5 ) );
		}
		mesh.addTriangle( std::uint32_t( 3 * t ), std::uint32_t( 3 * t + 1 ), std::uint32_t( 3 * t + 2 ) );
	}
	return mesh;
}

/// Any three of a few vertices: everything is non-manifold.
Mesh tangle( int vertices, int triangles )
{
	Random random;
	Mesh mesh;
	for ( int i = 0; i < vertices; ++i )
	{
		const double x = random();
		const double y = random();
		mesh.addVertex( x, y, random() );
	}
	for ( int t = 0; t < triangles; ++t )
	{
		const auto any = [&]() { return std::uint32_t( random() * vertices ); };
		const std::uint32_t a = any();
		const std::uint32_t b = any();
		mesh.addTriangle( a, b, any() );
	}
	return mesh;
}

Mesh manyOf( const Mesh& mesh, int count, Point step )
{
	Mesh all;
	for ( int k = 0; k < count; ++k )
	{
		all = joined( all, moved( mesh, { step[0] * k, step[1] * k, step[2] * k } ) );
	}
	return all;
}

/// Books of pages on one spine: an edge of many triangles.
Mesh book( int pages )
{
	Mesh mesh;
	mesh.addVertex( 0, 0, 0 );
	mesh.addVertex( 0, 0, 1 );
	for ( int k = 0; k < pages; ++k )
	{
		const double a = 2.0 * 3.14159265358979 * k / pages;
		mesh.addTriangle( 0, 1, mesh.addVertex( std::cos( a ), std::sin( a ), 0.5 ) );
	}
	return mesh;
}

/// A prism over a figure of eight: half of it has the opposite orientation.
Mesh figureOfEight()
{
	Mesh mesh;
	const int n = 64;
	for ( int i = 0; i < n; ++i )
	{
		const double a = 2.0 * 3.14159265358979 * ( i + 0.25 ) / n;
		for ( const double z : { 0.0, 1.0 } )
		{
			mesh.addVertex( std::sin( a ), std::sin( 2.0 * a ), z );
		}
	}
	const std::uint32_t low = mesh.addVertex( 0.01, 0.02, 0 );
	const std::uint32_t high = mesh.addVertex( 0.01, 0.02, 1 );
	for ( std::uint32_t i = 0; i < n; ++i )
	{
		const std::uint32_t j = ( i + 1 ) % n;
		mesh.addQuad( 2 * i, 2 * j, 2 * j + 1, 2 * i + 1 );
		mesh.addTriangle( 2 * j, 2 * i, low );
		mesh.addTriangle( 2 * i + 1, 2 * j + 1, high );
	}
	return mesh;
}

/// All vertices within a ball far smaller than the welding tolerance, except a distant one.
Mesh dust( int vertices )
{
	Mesh mesh = thrown( vertices / 3, 1e-7 );
	for ( float& x : mesh.positions )
	{
		x *= 1e-7f;
	}
	return joined( mesh, moved( cube(), { 1, 0, 0 } ) );
}

Mesh sheet( int n )
{
	Mesh mesh;
	for ( int i = 0; i <= n; ++i )
	{
		for ( int j = 0; j <= n; ++j )
		{
			mesh.addVertex( double( i ) / n, double( j ) / n, 0.0 );
		}
	}
	const std::uint32_t row = std::uint32_t( n + 1 );
	for ( std::uint32_t i = 0; i < std::uint32_t( n ); ++i )
	{
		for ( std::uint32_t j = 0; j < std::uint32_t( n ); ++j )
		{
			mesh.addQuad( i * row + j, ( i + 1 ) * row + j, ( i + 1 ) * row + j + 1, i * row + j + 1 );
		}
	}
	return mesh;
}

Mesh crumpled( Mesh mesh )
{
	Random random;
	for ( float& x : mesh.positions )
	{
		x = float( x + 0.3 * random() );
	}
	return mesh;
}

using List = std::vector<HostileMesh>;

// One mesh on each line.
// clang-format off
void addBadNumbers( List& list )
{
	list.push_back( { "nothing", []() { return Mesh(); }, ResultCode::EmptyMesh } );
	list.push_back( { "vertices without triangles", []() { Mesh m = cube(); m.indices.clear(); return m; }, ResultCode::EmptyMesh } );
	list.push_back( { "triangles without vertices", []() { Mesh m = cube(); m.positions.clear(); return m; }, ResultCode::EmptyMesh } );
	list.push_back( { "first coordinate NaN", []() { return with( cube(), 0, kNan ); }, ResultCode::NonFiniteVertex } );
	list.push_back( { "last coordinate NaN", []() { return with( cube(), 23, kNan ); }, ResultCode::NonFiniteVertex } );
	list.push_back( { "infinite", []() { return with( cube(), 7, kInfinity ); }, ResultCode::NonFiniteVertex } );
	list.push_back( { "minus infinite", []() { return with( cube(), 7, -kInfinity ); }, ResultCode::NonFiniteVertex } );
	list.push_back( { "unused vertex NaN", []() { return withVertex( cube(), double( kNan ), 0, 0 ); }, ResultCode::NonFiniteVertex } );
	list.push_back( { "one vertex at 1e30", []() { return with( cube(), 4, 1e30f ); }, ResultCode::ExtentOutOfRange } );
	list.push_back( { "one vertex at the largest float", []() { return with( cube(), 4, std::numeric_limits<float>::max() ); }, ResultCode::ExtentOutOfRange } );
	list.push_back( { "unused vertex at 1e30", []() { return withVertex( cube(), 1e30, -1e30, 1e30 ); } } );
	list.push_back( { "everything at 1e30", []() { return moved( cube(), { 1e30, 1e30, 1e30 } ); }, ResultCode::ZeroVolume } );
	list.push_back( { "denormal size", []() { return scaled( cube(), 1e-40 ); }, ResultCode::ExtentOutOfRange } );
	list.push_back( { "index -1", []() { return withIndex( cube(), 5, 0xffffffffu ); }, ResultCode::IndexOutOfRange } );
	list.push_back( { "index n", []() { return withIndex( cube(), 35, 8 ); }, ResultCode::IndexOutOfRange } );
	list.push_back( { "every index 0", []() { Mesh m = cube(); std::fill( m.indices.begin(), m.indices.end(), 0u ); return m; }, ResultCode::ZeroVolume } );
	list.push_back( { "all vertices at one place", []() { return scaled( ball(), 0.0 ); }, ResultCode::ZeroVolume } );
}

void addFlatOnes( List& list )
{
	list.push_back( { "one triangle", []() { return thrown( 1, 1.0 ); } } );
	list.push_back( { "one quad", []() { return sheet( 1 ); } } );
	list.push_back( { "flat sheet", []() { return sheet( 50 ); } } );
	list.push_back( { "flat sheet, tiny cells", []() { return sheet( 50 ); }, ResultCode::TooManyCells, 1e-4f } );
	list.push_back( { "flat sheet, slanted", []() { return rotated( sheet( 50 ), 0.6 ); } } );
	list.push_back( { "flat sheet, both sides", []() { return joined( sheet( 20 ), flipped( sheet( 20 ) ) ); } } );
	list.push_back( { "cube pressed flat", []() { return stretched( cube(), { 1, 1, 0 } ); } } );
	list.push_back( { "ball pressed to a line", []() { return stretched( ball(), { 1, 0, 0 } ); }, ResultCode::ZeroVolume } );
	list.push_back( { "zero-area triangles only", []() { Mesh m = sheet( 1 ); m.indices = { 0, 0, 1, 1, 2, 1, 3, 3, 3 }; return m; }, ResultCode::ZeroVolume } );
	list.push_back( { "crumpled sheet", []() { return crumpled( sheet( 30 ) ); } } );
	list.push_back( { "ribbon a thousandth wide", []() { return rotated( stretched( sheet( 30 ), { 1, 1e-3, 1 } ), 0.6 ); } } );
	list.push_back( { "needles only", []() { return stretched( thrown( 100, 1.0 ), { 1, 1e-9, 1e-9 } ); } } );
	list.push_back( { "plate a thousandth thick", []() { return stretched( cube(), { 1, 1, 1e-3 } ); } } );
	list.push_back( { "plate a millionth thick", []() { return stretched( cube(), { 1, 1, 1e-5 } ); } } );
	list.push_back( { "slanted plate", []() { return rotated( stretched( cube(), { 1, 1, 1e-3 } ), 0.6 ); } } );
	list.push_back( { "hair", []() { return stretched( cube(), { 1, 1e-4, 1e-4 } ); } } );
	list.push_back( { "slanted hair", []() { return rotated( stretched( cube(), { 1, 1e-2, 1e-2 } ), 0.6 ); } } );
}

void addDirtyOnes( List& list )
{
	list.push_back( { "cube", []() { return cube(); } } );
	list.push_back( { "flipped", []() { return flipped( ball() ); } } );
	list.push_back( { "half of it flipped", []() { Mesh m = ball(); for ( std::size_t t = 0; t < m.triangleCount(); t += 2 ) { std::swap( m.indices[3 * t], m.indices[3 * t + 1] ); } return m; } } );
	list.push_back( { "every triangle twice", []() { return joined( ball(), ball() ); } } );
	list.push_back( { "every triangle ten times", []() { return manyOf( ball(), 10, { 0, 0, 0 } ); } } );
	list.push_back( { "both sides", []() { return joined( ball(), flipped( ball() ) ); } } );
	list.push_back( { "unwelded", []() { return unwelded( ball() ); } } );
	list.push_back( { "unwelded and flipped at random", []() { Mesh m = unwelded( ball() ); Random r; for ( std::size_t t = 0; t < m.triangleCount(); ++t ) { if ( r() < 0.5 ) { std::swap( m.indices[3 * t], m.indices[3 * t + 1] ); } } return m; } } );
	list.push_back( { "open: one triangle gone", []() { return without( ball(), []( std::size_t t ) { return t == 100; } ); } } );
	list.push_back( { "open: half gone", []() { return without( ball(), []( std::size_t t ) { return t % 30 >= 15; } ); } } );
	list.push_back( { "open: every other triangle gone", []() { return without( ball(), []( std::size_t t ) { return t % 2 == 0; } ); } } );
	list.push_back( { "cube without its lid", []() { return without( cube(), []( std::size_t t ) { return t == 2 || t == 3; } ); } } );
	list.push_back( { "degenerate triangles among good ones", []() { Mesh m = ball(); for ( std::uint32_t k = 0; k < 100; ++k ) { m.addTriangle( k, k, k + 1 ); } return m; } } );
	list.push_back( { "needles sticking out", []() { Mesh m = ball(); m.addVertex( 5, 0, 0 ); for ( std::uint32_t k = 0; k < 50; ++k ) { m.addTriangle( k, k + 1, std::uint32_t( m.vertexCount() ) - 1 ); } return m; } } );
	list.push_back( { "wall inside", []() { Mesh m = cube(); m.addQuad( 0, 3, 7, 4 ); return m; } } );
	list.push_back( { "edge of a hundred triangles", []() { return joined( ball(), book( 100 ) ); } } );
	list.push_back( { "edge of twenty triangles", []() { return joined( ball(), book( 20 ) ); } } );
	list.push_back( { "only an edge of ten thousand triangles", []() { return book( 10000 ); } } );
	list.push_back( { "self-cutting: figure of eight", []() { return figureOfEight(); } } );
	list.push_back( { "self-cutting: fat torus", []() { return makeTorus( 0.5, 1.0, 32, 32 ); } } );
	list.push_back( { "tangle", []() { return tangle( 20, 2000 ); } } );
	list.push_back( { "thrown soup", []() { return thrown( 3000, 0.1 ); } } );
	list.push_back( { "thrown soup, few", []() { return thrown( 100, 0.1 ); } } );
}

void addShells( List& list )
{
	list.push_back( { "two shells", []() { return joined( ball(), moved( ball(), { 3, 0, 0 } ) ); } } );
	list.push_back( { "nested, same sense", []() { return joined( ball(), scaled( ball(), 0.5 ) ); } } );
	list.push_back( { "hollow", []() { return joined( ball(), flipped( scaled( ball(), 0.8 ) ) ); } } );
	list.push_back( { "hollow, thin as paper", []() { return joined( ball(), flipped( scaled( ball(), 0.9999 ) ) ); } } );
	list.push_back( { "onion of twenty", []() { Mesh m; for ( int k = 1; k <= 20; ++k ) { m = joined( m, k % 2 ? scaled( ball(), 0.05 * k ) : flipped( scaled( ball(), 0.05 * k ) ) ); } return m; } } );
	list.push_back( { "two cells touching at a corner", []() { return joined( cube(), moved( cube(), { 1, 1, 1 } ) ); }, ResultCode::Ok, 1.0f } );
	list.push_back( { "two cubes touching at an edge", []() { return joined( cube(), moved( cube(), { 1, 1, 0 } ) ); } } );
	list.push_back( { "one cell", []() { return cube(); }, ResultCode::Ok, 1.0f } );
	list.push_back( { "far smaller than a cell", []() { return ball(); }, ResultCode::Ok, 1000.0f } );
	list.push_back( { "crumbs a hundred thousand apart", []() { return joined( scaled( cube(), 1e-2 ), moved( scaled( cube(), 1e-2 ), { 1e3, 0, 0 } ) ); } } );
	list.push_back( { "a thousand cubes", []() { return manyOf( cube(), 1000, { 1.5, 0, 0 } ); } } );
	list.push_back( { "dust", []() { return dust( 60000 ); } } );
}

/// Meshes without an inside, with settings that forbid shells or make everything a shell.
void addShellsAsked( List& list )
{
	const auto never = [&list]( const char* name, std::function<Mesh()> make, ResultCode expected ) {
		list.push_back( { std::string( name ) + ", never a shell", std::move( make ), expected, 0.0f, Shell::Never } );
	};
	never( "one triangle", []() { return thrown( 1, 1.0 ); }, ResultCode::ZeroVolume );
	never( "flat sheet", []() { return sheet( 50 ); }, ResultCode::ZeroVolume );
	never( "flat sheet, both sides", []() { return joined( sheet( 20 ), flipped( sheet( 20 ) ) ); }, ResultCode::ZeroVolume );
	never( "cube pressed flat", []() { return stretched( cube(), { 1, 1, 0 } ); }, ResultCode::ZeroVolume );
	never( "cube", []() { return cube(); }, ResultCode::Ok );
	never( "cube without its lid", []() { return without( cube(), []( std::size_t t ) { return t == 2 || t == 3; } ); }, ResultCode::Ok );
	const auto always = [&list]( const char* name, std::function<Mesh()> make, ResultCode expected, float cellSize = 0.0f ) {
		list.push_back( { std::string( name ) + ", always a shell", std::move( make ), expected, cellSize, Shell::Always } );
	};
	always( "cube", []() { return cube(); }, ResultCode::Ok );
	always( "ball", []() { return ball(); }, ResultCode::Ok );
	always( "cube, tiny cells", []() { return cube(); }, ResultCode::TooManyCells, 1e-4f );
	always( "10^6 triangles", []() { return makeSphere( 1.0, 708, 708 ); }, ResultCode::Ok );
	always( "far smaller than a cell", []() { return ball(); }, ResultCode::Ok, 1000.0f );
	always( "book", []() { return book( 10000 ); }, ResultCode::Ok );
}

void addSizes( List& list )
{
	list.push_back( { "1e-6 m", []() { return scaled( ball(), 1e-6 ); } } );
	list.push_back( { "1e6 m", []() { return scaled( ball(), 1e6 ); } } );
	list.push_back( { "1e8 m", []() { return scaled( ball(), 1e8 ); }, ResultCode::ExtentOutOfRange } );
	list.push_back( { "1 m at 1e4 m", []() { return moved( ball(), { 1e4, 1e4, 1e4 } ); } } );
	list.push_back( { "1 m at 1e7 m", []() { return moved( ball(), { 1e7, 0, 0 } ); }, ResultCode::ExtentOutOfRange } );
	list.push_back( { "cells of a millionth", []() { return ball(); }, ResultCode::ExtentOutOfRange, 1e-6f } );
	list.push_back( { "cells of a ten-thousandth", []() { return ball(); }, ResultCode::TooManyCells, 1e-4f } );
	list.push_back( { "cells of a denormal", []() { return ball(); }, ResultCode::ExtentOutOfRange, 1e-40f } );
	list.push_back( { "cells of the largest float", []() { return ball(); }, ResultCode::ExtentOutOfRange, 1e30f } );
	list.push_back( { "open, cells of a thousandth", []() { return without( ball(), []( std::size_t t ) { return t < 30; } ); }, ResultCode::TooManyCells, 1e-3f } );
	list.push_back( { "10^6 triangles", []() { return makeSphere( 1.0, 708, 708 ); } } );
	list.push_back( { "10^6 needles", []() { return thrown( 1000000, 0.5 ); }, ResultCode::TooFolded } );
	list.push_back( { "10^6 triangles at one corner", []() { Mesh m = cube(); m.indices.reserve( 3000036 ); for ( std::uint32_t k = 0; k < 1000000; ++k ) { m.addTriangle( 0, 1 + k % 7, 1 + k / 7 % 7 ); } return m; }, ResultCode::TooFolded } );
	list.push_back( { "10^6 vertices at one place", []() { Mesh m = cube(); for ( std::uint32_t k = 0; k < 1000000; ++k ) { m.addVertex( 0.5, 0.5, 0.5 ); } m.addTriangle( 8, 1000, 100000 ); return m; } } );
}
// clang-format on

} // namespace

std::vector<HostileMesh> hostileMeshes()
{
	List list;
	addBadNumbers( list );
	addFlatOnes( list );
	addDirtyOnes( list );
	addShells( list );
	addShellsAsked( list );
	addSizes( list );
	return list;
}

} // namespace pliant::test
