// +-----------------------------------------------------------------------------------------------------------------+
// | Cube, sphere, torus and metaballs as closed triangle meshes.                                                     |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/shapes.h"

#include "demos/marching.h"
#include "demos/shared_vertices.h"
#include "third_party_glue/primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace pliant_demos {

using pliant_glue::ModelMesh;

namespace {

ModelMesh named( const char* name, ModelMesh mesh )
{
	mesh.name = name;
	mesh.submeshNames = { name };
	mesh.submeshOfTriangle.assign( mesh.triangleCount(), 0 );
	return mesh;
}

/// The sum of all balls.
float fieldOf( const std::vector<MetaBall>& balls, const Point& p )
{
	float sum = 0;
	for ( const MetaBall& ball : balls )
	{
		float square = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const float d = ( p[k] - ball.centre[k] ) / ball.radius[k];
			square += d * d;
		}
		sum += std::exp( -square );
	}
	return sum;
}

} // namespace

ModelMesh makeBox( const std::array<float, 3>& edges, const std::array<int, 3>& cuts )
{
	ModelMesh mesh;
	SharedVertices<std::array<int, 3>> vertices( mesh );
	for ( int face = 0; face < 6; ++face )
	{
		const int axis = face / 2, u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
		const bool isFar = face % 2 == 0;
		const auto corner = [&]( int i, int j ) {
			std::array<int, 3> at{};
			at[std::size_t( axis )] = isFar ? cuts[std::size_t( axis )] : 0;
			at[std::size_t( u )] = i;
			at[std::size_t( v )] = j;
			return vertices.at( at, [&] {
				Point p;
				for ( std::size_t k = 0; k < 3; ++k )
				{
					p[k] = edges[k] * ( float( at[k] ) / float( cuts[k] ) - 0.5f );
				}
				return p;
			} );
		};
		for ( int i = 0; i < cuts[std::size_t( u )]; ++i )
		{
			for ( int j = 0; j < cuts[std::size_t( v )]; ++j )
			{
				const std::uint32_t a = corner( i, j ), b = corner( i + 1, j ), c = corner( i + 1, j + 1 ), d = corner( i, j + 1 );
				isFar ? mesh.indices.insert( mesh.indices.end(), { a, b, c, a, c, d } )
					  : mesh.indices.insert( mesh.indices.end(), { a, c, b, a, d, c } );
			}
		}
	}
	return named( "cube", std::move( mesh ) );
}

ModelMesh makeCube( float edge, int cuts )
{
	return makeBox( { edge, edge, edge }, { cuts, cuts, cuts } );
}

ModelMesh makeSphere( float diameter, int subdivisions )
{
	pliant_glue::Primitive unit = pliant_glue::unitSphere( subdivisions );
	ModelMesh mesh;
	mesh.positions = std::move( unit.positions );
	mesh.indices = std::move( unit.indices );
	for ( float& coordinate : mesh.positions )
	{
		coordinate *= diameter;
	}
	return named( "sphere", std::move( mesh ) );
}

ModelMesh makeTorus( float radius, float tubeRadius, int around, int along )
{
	constexpr float kTurn = 6.28318530718f;
	ModelMesh mesh;
	for ( int i = 0; i < around; ++i )
	{
		for ( int j = 0; j < along; ++j )
		{
			const float a = kTurn * float( i ) / float( around ), b = kTurn * float( j ) / float( along );
			const float r = radius + tubeRadius * std::cos( b );
			mesh.positions.insert( mesh.positions.end(), { r * std::cos( a ), tubeRadius * std::sin( b ), -r * std::sin( a ) } );
			const auto at = [&]( int p, int q ) { return std::uint32_t( ( p % around ) * along + q % along ); };
			mesh.indices.insert(
				mesh.indices.end(), { at( i, j ), at( i + 1, j ), at( i + 1, j + 1 ), at( i, j ), at( i + 1, j + 1 ), at( i, j + 1 ) } );
		}
	}
	return named( "torus", std::move( mesh ) );
}

namespace {

using RadiusHeight = std::array<float, 2>;

/// A smooth line through the given points (Catmull and Rom), in steps of about `step`.
std::vector<RadiusHeight> smoothLine( const std::vector<RadiusHeight>& points, float step )
{
	std::vector<RadiusHeight> line;
	for ( std::size_t i = 0; i + 1 < points.size(); ++i )
	{
		const RadiusHeight &b = points[i], &c = points[i + 1], &a = i > 0 ? points[i - 1] : b,
						   &d = i + 2 < points.size() ? points[i + 2] : c;
		const int cuts = std::max( 1, int( std::ceil( std::hypot( c[0] - b[0], c[1] - b[1] ) / step ) ) );
		for ( int k = 0; k < cuts; ++k )
		{
			const float t = float( k ) / float( cuts );
			RadiusHeight p;
			for ( std::size_t j = 0; j < 2; ++j )
			{
				p[j] = b[j] +
					0.5f * t * ( c[j] - a[j] + t * ( 2 * a[j] - 5 * b[j] + 4 * c[j] - d[j] + t * ( 3 * ( b[j] - c[j] ) + d[j] - a[j] ) ) );
			}
			line.push_back( p );
		}
	}
	line.push_back( points.back() );
	return line;
}

/// From `from` to `to`, without these two.
void straightLine( const RadiusHeight& from, const RadiusHeight& to, float step, std::vector<RadiusHeight>& line )
{
	const int cuts = std::max( 1, int( std::ceil( std::hypot( to[0] - from[0], to[1] - from[1] ) / step ) ) );
	for ( int k = 1; k < cuts; ++k )
	{
		const float t = float( k ) / float( cuts );
		line.push_back( { from[0] + t * ( to[0] - from[0] ), from[1] + t * ( to[1] - from[1] ) } );
	}
}

} // namespace

ModelMesh makeVessel( const std::vector<RadiusHeight>& line, float wall, float row, int around )
{
	// Rings in order: foot from the axis outward, outside up, lip, inside down, bottom to the axis.
	const std::vector<RadiusHeight> outside = smoothLine( line, row );
	std::vector<RadiusHeight> inside;
	for ( std::size_t i = outside.size(); i-- > 0; )
	{
		// Inward at right angles to the outer line.
		const RadiusHeight &before = outside[i > 0 ? i - 1 : 0], &after = outside[std::min( i + 1, outside.size() - 1 )];
		const float dr = after[0] - before[0], dy = after[1] - before[1], length = std::hypot( dr, dy );
		const RadiusHeight p = { outside[i][0] - wall * dy / length, outside[i][1] + wall * dr / length };
		if ( p[1] > line.front()[1] + wall )
		{
			inside.push_back( p );
		}
	}
	const RadiusHeight foot = { 0, line.front()[1] }, bottom = { 0, line.front()[1] + wall };
	inside.push_back( { inside.back()[0], bottom[1] } );
	std::vector<RadiusHeight> rings;
	straightLine( foot, outside.front(), row, rings );
	rings.insert( rings.end(), outside.begin(), outside.end() );
	straightLine( outside.back(), inside.front(), row, rings );
	rings.insert( rings.end(), inside.begin(), inside.end() );
	straightLine( inside.back(), bottom, row, rings );

	constexpr float kTurn = 6.28318530718f;
	ModelMesh mesh;
	for ( const RadiusHeight& ring : rings )
	{
		for ( int k = 0; k < around; ++k )
		{
			const float angle = kTurn * float( k ) / float( around );
			mesh.positions.insert( mesh.positions.end(), { ring[0] * std::cos( angle ), ring[1], -ring[0] * std::sin( angle ) } );
		}
	}
	const auto at = [&]( std::size_t ring, int k ) { return std::uint32_t( int( ring ) * around + k % around ); };
	const std::uint32_t first = std::uint32_t( mesh.vertexCount() ), last = first + 1;
	mesh.positions.insert( mesh.positions.end(), { foot[0], foot[1], 0, bottom[0], bottom[1], 0 } );
	for ( int k = 0; k < around; ++k )
	{
		mesh.indices.insert( mesh.indices.end(), { first, at( 0, k + 1 ), at( 0, k ) } );
		for ( std::size_t i = 0; i + 1 < rings.size(); ++i )
		{
			mesh.indices.insert(
				mesh.indices.end(), { at( i, k ), at( i, k + 1 ), at( i + 1, k + 1 ), at( i, k ), at( i + 1, k + 1 ), at( i + 1, k ) } );
		}
		mesh.indices.insert( mesh.indices.end(), { last, at( rings.size() - 1, k ), at( rings.size() - 1, k + 1 ) } );
	}
	return named( "vessel", std::move( mesh ) );
}

ModelMesh makeMetaballs( const std::vector<MetaBall>& balls, float level, float cell )
{
	Point low, high;
	low.fill( std::numeric_limits<float>::max() );
	high.fill( std::numeric_limits<float>::lowest() );
	for ( const MetaBall& ball : balls )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			// Beyond 2.5 radii a ball adds less than 0.2 %.
			low[k] = std::min( low[k], ball.centre[k] - 2.5f * ball.radius[k] );
			high[k] = std::max( high[k], ball.centre[k] + 2.5f * ball.radius[k] );
		}
	}
	return named( "metaballs", marchSurface( [&]( const Point& p ) { return fieldOf( balls, p ) - level; }, low, high, cell ) );
}

ModelMesh makeGlob()
{
	const std::vector<MetaBall> balls = { { { 0, 0, 0 }, { 0.20f, 0.17f, 0.20f } }, { { 0.19f, 0.09f, 0.05f }, { 0.12f, 0.12f, 0.12f } },
		{ { -0.17f, 0.10f, 0.08f }, { 0.13f, 0.13f, 0.13f } }, { { 0.02f, 0.20f, -0.10f }, { 0.12f, 0.12f, 0.12f } },
		{ { 0.08f, -0.05f, -0.19f }, { 0.13f, 0.12f, 0.13f } }, { { -0.08f, -0.06f, 0.20f }, { 0.12f, 0.12f, 0.12f } } };
	return named( "glob", makeMetaballs( balls, 0.35f, 0.02f ) );
}

ModelMesh makeBunnyLike()
{
	// Looks along -x, as the scan does; y is up.
	const std::vector<MetaBall> balls = { { { 0.08f, 0.30f, 0 }, { 0.26f, 0.25f, 0.22f } },
		{ { 0.20f, 0.24f, 0 }, { 0.20f, 0.20f, 0.21f } }, { { -0.22f, 0.56f, 0 }, { 0.16f, 0.15f, 0.14f } },
		{ { -0.10f, 0.42f, 0 }, { 0.14f, 0.16f, 0.14f } }, { { -0.14f, 0.80f, 0.09f }, { 0.06f, 0.20f, 0.055f } },
		{ { -0.14f, 0.80f, -0.09f }, { 0.06f, 0.20f, 0.055f } }, { { 0.45f, 0.22f, 0 }, { 0.09f, 0.09f, 0.09f } },
		{ { -0.14f, 0.08f, 0.14f }, { 0.16f, 0.08f, 0.08f } }, { { -0.14f, 0.08f, -0.14f }, { 0.16f, 0.08f, 0.08f } } };
	return named( "bunny-like", makeMetaballs( balls, 0.4f, 0.022f ) );
}

void fitHeight( ModelMesh& mesh, float height )
{
	Point low, high;
	low.fill( std::numeric_limits<float>::max() );
	high.fill( std::numeric_limits<float>::lowest() );
	for ( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		low[i % 3] = std::min( low[i % 3], mesh.positions[i] );
		high[i % 3] = std::max( high[i % 3], mesh.positions[i] );
	}
	const float scale = height / ( high[1] - low[1] );
	for ( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		mesh.positions[i] = ( mesh.positions[i] - 0.5f * ( low[i % 3] + high[i % 3] ) ) * scale;
	}
}

} // namespace pliant_demos
