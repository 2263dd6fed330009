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
	for( const MetaBall& ball : balls )
	{
		float square = 0;
		for( std::size_t k = 0; k < 3; ++k )
		{
			const float d = ( p[k] - ball.centre[k] ) / ball.radius[k];
			square += d * d;
		}
		sum += std::exp( -square );
	}
	return sum;
}

} // namespace

ModelMesh makeCube( float edge, int cuts )
{
	ModelMesh mesh;
	SharedVertices<std::array<int, 3>> vertices( mesh );
	for( int face = 0; face < 6; ++face )
	{
		const int axis = face / 2, u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
		const bool isFar = face % 2 == 0;
		const auto corner = [&]( int i, int j ) {
			std::array<int, 3> at{};
			at[std::size_t( axis )] = isFar ? cuts : 0;
			at[std::size_t( u )] = i;
			at[std::size_t( v )] = j;
			return vertices.at( at, [&] {
				Point p;
				for( std::size_t k = 0; k < 3; ++k )
				{
					p[k] = edge * ( float( at[k] ) / float( cuts ) - 0.5f );
				}
				return p;
			} );
		};
		for( int i = 0; i < cuts; ++i )
		{
			for( int j = 0; j < cuts; ++j )
			{
				const std::uint32_t a = corner( i, j ), b = corner( i + 1, j ), c = corner( i + 1, j + 1 ), d = corner( i, j + 1 );
				isFar ? mesh.indices.insert( mesh.indices.end(), { a, b, c, a, c, d } ) : mesh.indices.insert( mesh.indices.end(), { a, c, b, a, d, c } );
			}
		}
	}
	return named( "cube", std::move( mesh ) );
}

ModelMesh makeSphere( float diameter, int subdivisions )
{
	pliant_glue::Primitive unit = pliant_glue::unitSphere( subdivisions );
	ModelMesh mesh;
	mesh.positions = std::move( unit.positions );
	mesh.indices = std::move( unit.indices );
	for( float& coordinate : mesh.positions )
	{
		coordinate *= diameter;
	}
	return named( "sphere", std::move( mesh ) );
}

ModelMesh makeTorus( float radius, float tubeRadius, int around, int along )
{
	constexpr float kTurn = 6.28318530718f;
	ModelMesh mesh;
	for( int i = 0; i < around; ++i )
	{
		for( int j = 0; j < along; ++j )
		{
			const float a = kTurn * float( i ) / float( around ), b = kTurn * float( j ) / float( along );
			const float r = radius + tubeRadius * std::cos( b );
			mesh.positions.insert( mesh.positions.end(), { r * std::cos( a ), tubeRadius * std::sin( b ), -r * std::sin( a ) } );
			const auto at = [&]( int p, int q ) { return std::uint32_t( ( p % around ) * along + q % along ); };
			mesh.indices.insert( mesh.indices.end(), { at( i, j ), at( i + 1, j ), at( i + 1, j + 1 ), at( i, j ), at( i + 1, j + 1 ), at( i, j + 1 ) } );
		}
	}
	return named( "torus", std::move( mesh ) );
}

ModelMesh makeMetaballs( const std::vector<MetaBall>& balls, float level, float cell )
{
	Point low, high;
	low.fill( std::numeric_limits<float>::max() );
	high.fill( std::numeric_limits<float>::lowest() );
	for( const MetaBall& ball : balls )
	{
		for( std::size_t k = 0; k < 3; ++k )
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
	const std::vector<MetaBall> balls = { { { 0.08f, 0.30f, 0 }, { 0.26f, 0.25f, 0.22f } }, { { 0.20f, 0.24f, 0 }, { 0.20f, 0.20f, 0.21f } },
		{ { -0.22f, 0.56f, 0 }, { 0.16f, 0.15f, 0.14f } }, { { -0.10f, 0.42f, 0 }, { 0.14f, 0.16f, 0.14f } },
		{ { -0.14f, 0.80f, 0.09f }, { 0.06f, 0.20f, 0.055f } }, { { -0.14f, 0.80f, -0.09f }, { 0.06f, 0.20f, 0.055f } },
		{ { 0.45f, 0.22f, 0 }, { 0.09f, 0.09f, 0.09f } }, { { -0.14f, 0.08f, 0.14f }, { 0.16f, 0.08f, 0.08f } },
		{ { -0.14f, 0.08f, -0.14f }, { 0.16f, 0.08f, 0.08f } } };
	return named( "bunny-like", makeMetaballs( balls, 0.4f, 0.022f ) );
}

void fitHeight( ModelMesh& mesh, float height )
{
	Point low, high;
	low.fill( std::numeric_limits<float>::max() );
	high.fill( std::numeric_limits<float>::lowest() );
	for( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		low[i % 3] = std::min( low[i % 3], mesh.positions[i] );
		high[i % 3] = std::max( high[i % 3], mesh.positions[i] );
	}
	const float scale = height / ( high[1] - low[1] );
	for( std::size_t i = 0; i < mesh.positions.size(); ++i )
	{
		mesh.positions[i] = ( mesh.positions[i] - 0.5f * ( low[i % 3] + high[i % 3] ) ) * scale;
	}
}

} // namespace pliant_demos
