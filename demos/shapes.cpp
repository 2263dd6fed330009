// +-----------------------------------------------------------------------------------------------------------------+
// | Cube, sphere, torus and metaballs as closed triangle meshes.                                                     |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/shapes.h"

#include "third_party_glue/primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace pliant_demos {

using pliant_glue::ModelMesh;

namespace {

using Point = std::array<float, 3>;

constexpr int kHalvings = 12; // a cell's edge over 4096

ModelMesh named( const char* name, ModelMesh mesh )
{
	mesh.name = name;
	mesh.submeshNames = { name };
	mesh.submeshOfTriangle.assign( mesh.triangleCount(), 0 );
	return mesh;
}

/// Gives out one vertex number for each key: neighbours that meet on an edge share its vertex.
template <class Key>
class SharedVertices
{
public:
	explicit SharedVertices( ModelMesh& mesh ) : m_mesh( mesh ) {}

	template <class MakePoint>
	std::uint32_t at( const Key& key, MakePoint makePoint )
	{
		const auto [entry, isNew] = m_numbers.try_emplace( key, std::uint32_t( m_mesh.vertexCount() ) );
		if( isNew )
		{
			const Point p = makePoint();
			m_mesh.positions.insert( m_mesh.positions.end(), p.begin(), p.end() );
		}
		return entry->second;
	}

private:
	ModelMesh& m_mesh;
	std::map<Key, std::uint32_t> m_numbers;
};

/// The field of metaballs on the corners of a grid of cubes.
class FieldGrid
{
public:
	FieldGrid( const std::vector<MetaBall>& balls, float cell ) : m_balls( balls ), m_cell( cell )
	{
		Point low, high;
		low.fill( std::numeric_limits<float>::max() );
		high.fill( std::numeric_limits<float>::lowest() );
		for( const MetaBall& ball : balls )
		{
			for( int k = 0; k < 3; ++k )
			{
				// Beyond 2.5 radii a ball adds less than 0.2 %.
				low[k] = std::min( low[k], ball.centre[k] - 2.5f * ball.radius[k] );
				high[k] = std::max( high[k], ball.centre[k] + 2.5f * ball.radius[k] );
			}
		}
		m_low = low;
		for( int k = 0; k < 3; ++k )
		{
			m_size[k] = int( std::ceil( ( high[k] - low[k] ) / cell ) ) + 1;
		}
		m_values.reserve( std::size_t( m_size[0] ) * std::size_t( m_size[1] ) * std::size_t( m_size[2] ) );
		for( int i = 0; i < m_size[0] * m_size[1] * m_size[2]; ++i )
		{
			m_values.push_back( fieldAt( position( i ) ) );
		}
	}

	int number( int x, int y, int z ) const { return ( z * m_size[1] + y ) * m_size[0] + x; }
	float value( int number ) const { return m_values[std::size_t( number )]; }
	int size( int axis ) const { return m_size[axis]; }

	Point position( int number ) const
	{
		const int x = number % m_size[0], y = number / m_size[0] % m_size[1], z = number / ( m_size[0] * m_size[1] );
		return { m_low[0] + float( x ) * m_cell, m_low[1] + float( y ) * m_cell, m_low[2] + float( z ) * m_cell };
	}

	float fieldAt( const Point& p ) const
	{
		float sum = 0;
		for( const MetaBall& ball : m_balls )
		{
			float square = 0;
			for( int k = 0; k < 3; ++k )
			{
				const float d = ( p[k] - ball.centre[k] ) / ball.radius[k];
				square += d * d;
			}
			sum += std::exp( -square );
		}
		return sum;
	}

private:
	const std::vector<MetaBall>& m_balls;
	float m_cell;
	Point m_low;
	std::array<int, 3> m_size;
	std::vector<float> m_values;
};

/// Marching tetrahedra: every cube is cut into the six tetrahedra around one diagonal, the same way, so faces of neighbours agree.
class Marcher
{
public:
	Marcher( const FieldGrid& grid, float level ) : m_grid( grid ), m_level( level ), m_vertices( m_mesh ) {}

	ModelMesh march()
	{
		static constexpr int kOrders[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
		for( int z = 0; z + 1 < m_grid.size( 2 ); ++z )
		{
			for( int y = 0; y + 1 < m_grid.size( 1 ); ++y )
			{
				for( int x = 0; x + 1 < m_grid.size( 0 ); ++x )
				{
					for( int k = 0; k < 6; ++k )
					{
						// From one corner of the cube to the opposite one, an axis at a time: even orders are right-handed.
						int at[3] = { x, y, z };
						std::array<int, 4> corner{ m_grid.number( x, y, z ) };
						for( int step = 0; step < 3; ++step )
						{
							++at[kOrders[k][step]];
							corner[std::size_t( step ) + 1] = m_grid.number( at[0], at[1], at[2] );
						}
						if( k >= 3 )
						{
							std::swap( corner[2], corner[3] );
						}
						tetrahedron( corner );
					}
				}
			}
		}
		return std::move( m_mesh );
	}

private:
	bool isInside( int corner ) const { return m_grid.value( corner ) > m_level; }

	std::uint32_t crossing( int a, int b )
	{
		return m_vertices.at( std::minmax( a, b ), [&] {
			const auto [first, second] = std::minmax( a, b );
			return surfacePoint( m_grid.position( first ), m_grid.position( second ), m_grid.value( first ) > m_level );
		} );
	}

	/// Halving, not one linear step: vertices off the true surface would show as ripples in the shading.
	Point surfacePoint( Point low, Point high, bool lowIsInside ) const
	{
		const auto middle = [&] { return Point{ ( low[0] + high[0] ) / 2, ( low[1] + high[1] ) / 2, ( low[2] + high[2] ) / 2 }; };
		for( int k = 0; k < kHalvings; ++k )
		{
			const Point p = middle();
			( ( m_grid.fieldAt( p ) > m_level ) == lowIsInside ? low : high ) = p;
		}
		return middle();
	}

	void triangle( std::uint32_t a, std::uint32_t b, std::uint32_t c )
	{
		m_mesh.indices.insert( m_mesh.indices.end(), { a, b, c } );
	}

	/// Corners of a right-handed tetrahedron: seen from 0, the corners 1, 2, 3 run clockwise.
	void tetrahedron( const std::array<int, 4>& c )
	{
		// Even permutations that bring corner i (or the pair i, j) to the front keep the handedness.
		static constexpr int kFront[4][4] = { { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 3, 0, 1 }, { 3, 2, 1, 0 } };
		static constexpr int kPairs[6][4] = { { 0, 1, 2, 3 }, { 0, 2, 3, 1 }, { 0, 3, 1, 2 }, { 1, 2, 0, 3 }, { 1, 3, 2, 0 }, { 2, 3, 0, 1 } };
		int inside = 0, count = 0;
		for( int k = 0; k < 4; ++k )
		{
			inside |= isInside( c[std::size_t( k )] ) ? 1 << k : 0;
			count += isInside( c[std::size_t( k )] ) ? 1 : 0;
		}
		if( count == 1 || count == 3 )
		{
			const int alone = count == 1 ? inside : 15 - inside;
			const int* p = kFront[alone == 1 ? 0 : alone == 2 ? 1 : alone == 4 ? 2 : 3];
			const int a = c[std::size_t( p[0] )];
			const std::uint32_t u = crossing( a, c[std::size_t( p[1] )] ), v = crossing( a, c[std::size_t( p[2] )] ), w = crossing( a, c[std::size_t( p[3] )] );
			count == 1 ? triangle( u, v, w ) : triangle( u, w, v );
		}
		else if( count == 2 )
		{
			for( const int* p : kPairs )
			{
				if( inside == ( 1 << p[0] | 1 << p[1] ) )
				{
					const int a = c[std::size_t( p[0] )], b = c[std::size_t( p[1] )], d = c[std::size_t( p[2] )], e = c[std::size_t( p[3] )];
					const std::uint32_t ad = crossing( a, d ), ae = crossing( a, e ), bd = crossing( b, d ), be = crossing( b, e );
					triangle( ad, ae, be );
					triangle( ad, be, bd );
				}
			}
		}
	}

	const FieldGrid& m_grid;
	float m_level;
	ModelMesh m_mesh;
	SharedVertices<std::pair<int, int>> m_vertices;
};

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
	return named( "metaballs", Marcher( FieldGrid( balls, cell ), level ).march() );
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
