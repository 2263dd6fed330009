// Shapes for tests, in simple code.

#include "test_meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace pliant::test {

namespace {

constexpr double kPi = std::numbers::pi;

/// A closed sheet over rings x segments: a sphere's poles shrink to points, a torus is periodic in both directions.
template <class F>
Mesh makeSphereLike( int rings, int segments, F&& radiusAt )
{
	Mesh mesh;
	const auto add = [&]( double polar, double around ) {
		const double r = radiusAt( polar, around );
		return mesh.addVertex(
			r * std::sin( polar ) * std::cos( around ), r * std::sin( polar ) * std::sin( around ), r * std::cos( polar ) );
	};
	add( 0.0, 0.0 );
	for ( int i = 1; i < rings; ++i )
	{
		for ( int j = 0; j < segments; ++j )
		{
			add( kPi * i / rings, 2.0 * kPi * j / segments );
		}
	}
	const std::uint32_t south = add( kPi, 0.0 );
	const auto at = [&]( int i, int j ) { return std::uint32_t( 1 + ( i - 1 ) * segments + j % segments ); };
	for ( int j = 0; j < segments; ++j )
	{
		mesh.addTriangle( 0, at( 1, j ), at( 1, j + 1 ) );
		for ( int i = 1; i + 1 < rings; ++i )
		{
			mesh.addQuad( at( i, j ), at( i + 1, j ), at( i + 1, j + 1 ), at( i, j + 1 ) );
		}
		mesh.addTriangle( at( rings - 1, j ), south, at( rings - 1, j + 1 ) );
	}
	return mesh;
}

} // namespace

MeshView Mesh::view() const
{
	MeshView view;
	view.positions = positions.data();
	view.vertexCount = vertexCount();
	view.indices = indices.data();
	view.triangleCount = triangleCount();
	return view;
}

std::uint32_t Mesh::addVertex( double x, double y, double z )
{
	positions.insert( positions.end(), { float( x ), float( y ), float( z ) } );
	return std::uint32_t( vertexCount() - 1 );
}

void Mesh::addTriangle( std::uint32_t a, std::uint32_t b, std::uint32_t c )
{
	indices.insert( indices.end(), { a, b, c } );
}

void Mesh::addQuad( std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d )
{
	addTriangle( a, b, c );
	addTriangle( a, c, d );
}

Mesh makeBox( Point low, Point high )
{
	Mesh mesh;
	for ( int k = 0; k < 8; ++k )
	{
		mesh.addVertex( k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2] );
	}
	mesh.addQuad( 0, 2, 3, 1 );
	mesh.addQuad( 4, 5, 7, 6 );
	mesh.addQuad( 0, 1, 5, 4 );
	mesh.addQuad( 2, 6, 7, 3 );
	mesh.addQuad( 0, 4, 6, 2 );
	mesh.addQuad( 1, 3, 7, 5 );
	return mesh;
}

Mesh makeBox( Point low, Point high, int n )
{
	// Faces are divided one by one and share equal vertices, found by their position on the grid.
	Mesh mesh;
	std::map<std::array<int, 3>, std::uint32_t> made;
	const auto at = [&]( std::array<int, 3> g ) {
		const auto [it, isNew] = made.try_emplace( g, 0 );
		if ( isNew )
		{
			Point p{};
			for ( std::size_t a = 0; a < 3; ++a )
			{
				p[a] = low[a] + ( high[a] - low[a] ) * g[a] / n;
			}
			it->second = mesh.addVertex( p[0], p[1], p[2] );
		}
		return it->second;
	};
	for ( std::size_t axis = 0; axis < 3; ++axis )
	{
		for ( const int side : { 0, n } )
		{
			for ( int i = 0; i < n * n; ++i )
			{
				const auto corner = [&]( int du, int dv ) {
					std::array<int, 3> g{};
					g[axis] = side;
					g[( axis + 1 ) % 3] = i % n + du;
					g[( axis + 2 ) % 3] = i / n + dv;
					return at( g );
				};
				side ? mesh.addQuad( corner( 0, 0 ), corner( 1, 0 ), corner( 1, 1 ), corner( 0, 1 ) )
					 : mesh.addQuad( corner( 0, 0 ), corner( 0, 1 ), corner( 1, 1 ), corner( 1, 0 ) );
			}
		}
	}
	return mesh;
}

Mesh makeBeam( double length, double width, int cuts )
{
	Mesh mesh;
	const double h = 0.5 * width;
	for ( int i = 0; i <= cuts; ++i )
	{
		const double x = length * i / cuts - 0.5 * length;
		mesh.addVertex( x, -h, -h );
		mesh.addVertex( x, h, -h );
		mesh.addVertex( x, h, h );
		mesh.addVertex( x, -h, h );
	}
	for ( std::uint32_t i = 0; i < std::uint32_t( cuts ); ++i )
	{
		for ( std::uint32_t k = 0; k < 4; ++k )
		{
			const std::uint32_t next = ( k + 1 ) % 4;
			mesh.addQuad( 4 * i + k, 4 * i + next, 4 * i + 4 + next, 4 * i + 4 + k );
		}
	}
	const std::uint32_t last = 4 * std::uint32_t( cuts );
	mesh.addQuad( 0, 3, 2, 1 );
	mesh.addQuad( last, last + 1, last + 2, last + 3 );
	return mesh;
}

Mesh makeSphere( double radius, int rings, int segments )
{
	return makeSphereLike( rings, segments, [radius]( double, double ) { return radius; } );
}

Mesh makeBumpySphere( double radius, double bump, int rings, int segments )
{
	return makeSphereLike( rings, segments, [=]( double polar, double around ) {
		// Waves fade towards the poles, where all segments meet.
		const double fade = std::sin( polar ) * std::sin( polar );
		return radius * ( 1.0 + bump * fade * std::sin( 5.0 * polar ) * std::cos( 7.0 * around ) );
	} );
}

Mesh makeTorus( double radius, double tube, int rings, int segments )
{
	Mesh mesh;
	for ( int i = 0; i < rings; ++i )
	{
		for ( int j = 0; j < segments; ++j )
		{
			const double a = 2.0 * kPi * i / rings;
			const double b = 2.0 * kPi * j / segments;
			const double r = radius + tube * std::cos( b );
			mesh.addVertex( r * std::cos( a ), r * std::sin( a ), tube * std::sin( b ) );
		}
	}
	const auto at = [&]( int i, int j ) { return std::uint32_t( i % rings * segments + j % segments ); };
	for ( int i = 0; i < rings; ++i )
	{
		for ( int j = 0; j < segments; ++j )
		{
			mesh.addQuad( at( i, j ), at( i + 1, j ), at( i + 1, j + 1 ), at( i, j + 1 ) );
		}
	}
	return mesh;
}

namespace {

double globField( const Point& p )
{
	static constexpr std::array<std::array<double, 4>, 4> kBalls = {
		{ { 0.0, 0.0, 0.0, 0.5 }, { 0.5, 0.2, 0.1, 0.3 }, { -0.4, 0.35, -0.1, 0.3 }, { 0.05, -0.5, 0.3, 0.28 } } };
	double sum = -1.0;
	for ( const auto& ball : kBalls )
	{
		const double x = p[0] - ball[0];
		const double y = p[1] - ball[1];
		const double z = p[2] - ball[2];
		sum += ball[3] * ball[3] / ( x * x + y * y + z * z + 1e-9 );
	}
	return sum;
}

/// The surface inside one tetrahedron of a cube; cut points are shared through the map of edges.
class TetrahedraMarcher
{
public:
	TetrahedraMarcher( double radius, int n, Mesh& mesh ) : m_radius( radius ), m_n( n ), m_mesh( mesh ) {}

	Point at( int g ) const
	{
		const int m = m_n + 1;
		const auto c = [&]( int i ) { return 2.6 * i / m_n - 1.3; };
		return { c( g % m ), c( g / m % m ), c( g / m / m ) };
	}

	void march( const std::array<int, 4>& corner )
	{
		std::vector<int> in;
		std::vector<int> out;
		for ( const int g : corner )
		{
			( globField( at( g ) ) > 0.0 ? in : out ).push_back( g );
		}
		if ( in.size() == 1 || out.size() == 1 )
		{
			const std::vector<int>& lone = in.size() == 1 ? in : out;
			const std::vector<int>& rest = in.size() == 1 ? out : in;
			add( cutPoint( lone[0], rest[0] ), cutPoint( lone[0], rest[1] ), cutPoint( lone[0], rest[2] ), in[0] );
		}
		else if ( in.size() == 2 )
		{
			const std::uint32_t a = cutPoint( in[0], out[0] );
			const std::uint32_t b = cutPoint( in[0], out[1] );
			const std::uint32_t c = cutPoint( in[1], out[1] );
			const std::uint32_t d = cutPoint( in[1], out[0] );
			add( a, b, c, in[0] );
			add( a, c, d, in[0] );
		}
	}

private:
	std::uint32_t cutPoint( int a, int b )
	{
		const auto [it, isNew] = m_made.try_emplace( std::minmax( a, b ), 0 );
		if ( isNew )
		{
			const Point p = at( it->first.first );
			const Point q = at( it->first.second );
			const double fp = globField( p );
			const double t = fp / ( fp - globField( q ) );
			it->second = m_mesh.addVertex( m_radius * ( p[0] + t * ( q[0] - p[0] ) ), m_radius * ( p[1] + t * ( q[1] - p[1] ) ),
				m_radius * ( p[2] + t * ( q[2] - p[2] ) ) );
		}
		return it->second;
	}

	/// Turned so that the inside corner lies behind it.
	void add( std::uint32_t a, std::uint32_t b, std::uint32_t c, int inside )
	{
		const auto point = [&]( std::uint32_t v ) { return &m_mesh.positions[3 * std::size_t( v )]; };
		const Point o = at( inside );
		const float* pa = point( a );
		std::array<double, 3> u{}, v{}, w{};
		for ( std::size_t k = 0; k < 3; ++k )
		{
			u[k] = double( point( b )[k] ) - double( pa[k] );
			v[k] = double( point( c )[k] ) - double( pa[k] );
			w[k] = m_radius * o[k] - double( pa[k] );
		}
		const double side = w[0] * ( u[1] * v[2] - u[2] * v[1] ) + w[1] * ( u[2] * v[0] - u[0] * v[2] ) +
			w[2] * ( u[0] * v[1] - u[1] * v[0] );
		side < 0.0 ? m_mesh.addTriangle( a, b, c ) : m_mesh.addTriangle( a, c, b );
	}

	double m_radius;
	int m_n;
	Mesh& m_mesh;
	std::map<std::pair<int, int>, std::uint32_t> m_made;
};

} // namespace

Mesh makeGlob( double radius, int n )
{
	Mesh mesh;
	TetrahedraMarcher marcher( radius, n, mesh );
	const int m = n + 1;
	for ( int k = 0; k < n * n * n; ++k )
	{
		const int base = ( k / n / n * m + k / n % n ) * m + k % n;
		const int far = base + 1 + m + m * m;
		// Six tetrahedra around the cube's long diagonal: one for each order of the three steps.
		const std::array<int, 3> step = { 1, m, m * m };
		for ( std::size_t a = 0; a < 3; ++a )
		{
			for ( std::size_t b = 0; b < 3; ++b )
			{
				if ( a != b )
				{
					marcher.march( { base, base + step[a], base + step[a] + step[b], far } );
				}
			}
		}
	}
	return mesh;
}

Mesh joined( const Mesh& a, const Mesh& b )
{
	Mesh mesh = a;
	const std::uint32_t shift = std::uint32_t( a.vertexCount() );
	mesh.positions.insert( mesh.positions.end(), b.positions.begin(), b.positions.end() );
	for ( const std::uint32_t i : b.indices )
	{
		mesh.indices.push_back( i + shift );
	}
	return mesh;
}

Mesh moved( Mesh mesh, Point by )
{
	for ( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		mesh.positions[i] = float( double( mesh.positions[i] ) + by[i % 3] );
	}
	return mesh;
}

Mesh scaled( Mesh mesh, double by )
{
	for ( float& x : mesh.positions )
	{
		x = float( double( x ) * by );
	}
	return mesh;
}

Mesh rotated( Mesh mesh, double angle )
{
	const double n = std::sqrt( 14.0 );
	const Point k = { 1.0 / n, 2.0 / n, 3.0 / n };
	const double c = std::cos( angle );
	const double s = std::sin( angle );
	for ( std::size_t i = 0; i < mesh.positions.size(); i += 3 )
	{
		// Rodrigues: v cos + ( k x v ) sin + k ( k . v ) ( 1 - cos )
		const Point v = { mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2] };
		const double along = ( k[0] * v[0] + k[1] * v[1] + k[2] * v[2] ) * ( 1.0 - c );
		const Point cross = { k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0] };
		for ( std::size_t a = 0; a < 3; ++a )
		{
			mesh.positions[i + a] = float( v[a] * c + cross[a] * s + k[a] * along );
		}
	}
	return mesh;
}

Mesh flipped( Mesh mesh )
{
	for ( std::size_t t = 0; t < mesh.triangleCount(); ++t )
	{
		std::swap( mesh.indices[3 * t + 1], mesh.indices[3 * t + 2] );
	}
	return mesh;
}

Mesh unwelded( const Mesh& mesh )
{
	Mesh out;
	for ( const std::uint32_t i : mesh.indices )
	{
		out.indices.push_back( out.addVertex(
			mesh.positions[3 * std::size_t( i )], mesh.positions[3 * std::size_t( i ) + 1], mesh.positions[3 * std::size_t( i ) + 2] ) );
	}
	return out;
}

Mesh without( const Mesh& mesh, bool ( *drop )( std::size_t triangle ) )
{
	Mesh out;
	out.positions = mesh.positions;
	for ( std::size_t t = 0; t < mesh.triangleCount(); ++t )
	{
		if ( !drop( t ) )
		{
			out.addTriangle( mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2] );
		}
	}
	return out;
}

} // namespace pliant::test
