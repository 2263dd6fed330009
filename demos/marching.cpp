// +-----------------------------------------------------------------------------------------------------------------+
// | Marching tetrahedra, with vertices moved onto the true surface by bisection.                                      |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/marching.h"

#include "demos/shared_vertices.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

using pliant_glue::ModelMesh;

namespace {

constexpr int kHalvings = 12; // a cell's edge over 4096

/// The field on the corners of a grid of cubes.
class FieldGrid
{
public:
	FieldGrid( const Field& field, const Point& low, const Point& high, float cell ) : m_field( field ), m_cell( cell ), m_low( low )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			m_size[k] = int( std::ceil( ( high[k] - low[k] ) / cell ) ) + 1;
		}
		m_values.reserve( std::size_t( m_size[0] ) * std::size_t( m_size[1] ) * std::size_t( m_size[2] ) );
		for ( int i = 0; i < m_size[0] * m_size[1] * m_size[2]; ++i )
		{
			m_values.push_back( fieldAt( position( i ) ) );
		}
	}

	int number( int x, int y, int z ) const { return ( z * m_size[1] + y ) * m_size[0] + x; }
	float value( int number ) const { return m_values[std::size_t( number )]; }
	int size( std::size_t axis ) const { return m_size[axis]; }
	float fieldAt( const Point& p ) const { return m_field( p ); }

	Point position( int number ) const
	{
		const int x = number % m_size[0], y = number / m_size[0] % m_size[1], z = number / ( m_size[0] * m_size[1] );
		return { m_low[0] + float( x ) * m_cell, m_low[1] + float( y ) * m_cell, m_low[2] + float( z ) * m_cell };
	}

private:
	const Field& m_field;
	float m_cell;
	Point m_low;
	std::array<int, 3> m_size;
	std::vector<float> m_values;
};

/// Marching tetrahedra: every cube is cut into the six tetrahedra around one diagonal, all cubes alike, so that the faces of neighbours
/// agree.
class Marcher
{
public:
	explicit Marcher( const FieldGrid& grid ) : m_grid( grid ), m_vertices( m_mesh ) {}

	ModelMesh march()
	{
		static constexpr int kOrders[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
		for ( int z = 0; z + 1 < m_grid.size( 2 ); ++z )
		{
			for ( int y = 0; y + 1 < m_grid.size( 1 ); ++y )
			{
				for ( int x = 0; x + 1 < m_grid.size( 0 ); ++x )
				{
					for ( int k = 0; k < 6; ++k )
					{
						// From one corner of the cube to the opposite one, an axis at a time: even orders are right-handed.
						int at[3] = { x, y, z };
						std::array<int, 4> corner{ m_grid.number( x, y, z ) };
						for ( int step = 0; step < 3; ++step )
						{
							++at[kOrders[k][step]];
							corner[std::size_t( step ) + 1] = m_grid.number( at[0], at[1], at[2] );
						}
						if ( k >= 3 )
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
	bool isInside( int corner ) const { return m_grid.value( corner ) > 0; }

	std::uint32_t crossing( int a, int b )
	{
		return m_vertices.at( std::minmax( a, b ), [&] {
			const auto [first, second] = std::minmax( a, b );
			return surfacePoint( m_grid.position( first ), m_grid.position( second ), m_grid.value( first ) > 0 );
		} );
	}

	/// Bisection instead of one linear step: vertices off the true surface would show as ripples in the shading.
	Point surfacePoint( Point low, Point high, bool lowIsInside ) const
	{
		const auto middle = [&] { return Point{ ( low[0] + high[0] ) / 2, ( low[1] + high[1] ) / 2, ( low[2] + high[2] ) / 2 }; };
		for ( int k = 0; k < kHalvings; ++k )
		{
			const Point p = middle();
			( ( m_grid.fieldAt( p ) > 0 ) == lowIsInside ? low : high ) = p;
		}
		return middle();
	}

	void triangle( std::uint32_t a, std::uint32_t b, std::uint32_t c ) { m_mesh.indices.insert( m_mesh.indices.end(), { a, b, c } ); }

	/// Corners of a right-handed tetrahedron: seen from 0, the corners 1, 2, 3 run clockwise.
	void tetrahedron( const std::array<int, 4>& c )
	{
		// Even permutations that bring corner i (or the pair i, j) to the front keep the handedness.
		static constexpr int kFront[4][4] = { { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 3, 0, 1 }, { 3, 2, 1, 0 } };
		static constexpr int kPairs[6][4] = {
			{ 0, 1, 2, 3 }, { 0, 2, 3, 1 }, { 0, 3, 1, 2 }, { 1, 2, 0, 3 }, { 1, 3, 2, 0 }, { 2, 3, 0, 1 } };
		int inside = 0, count = 0;
		for ( int k = 0; k < 4; ++k )
		{
			inside |= isInside( c[std::size_t( k )] ) ? 1 << k : 0;
			count += isInside( c[std::size_t( k )] ) ? 1 : 0;
		}
		if ( count == 1 || count == 3 )
		{
			const int alone = count == 1 ? inside : 15 - inside;
			const int* p = kFront[alone == 1 ? 0 : alone == 2 ? 1 : alone == 4 ? 2 : 3];
			const int a = c[std::size_t( p[0] )];
			const std::uint32_t u = crossing( a, c[std::size_t( p[1] )] ), v = crossing( a, c[std::size_t( p[2] )] ),
								w = crossing( a, c[std::size_t( p[3] )] );
			count == 1 ? triangle( u, v, w ) : triangle( u, w, v );
		}
		else if ( count == 2 )
		{
			for ( const int* p : kPairs )
			{
				if ( inside == ( 1 << p[0] | 1 << p[1] ) )
				{
					const int a = c[std::size_t( p[0] )], b = c[std::size_t( p[1] )], d = c[std::size_t( p[2] )],
							  e = c[std::size_t( p[3] )];
					const std::uint32_t ad = crossing( a, d ), ae = crossing( a, e ), bd = crossing( b, d ), be = crossing( b, e );
					triangle( ad, ae, be );
					triangle( ad, be, bd );
				}
			}
		}
	}

	const FieldGrid& m_grid;
	ModelMesh m_mesh;
	SharedVertices<std::pair<int, int>> m_vertices;
};

} // namespace

ModelMesh marchSurface( const Field& field, const Point& low, const Point& high, float cell )
{
	return Marcher( FieldGrid( field, low, high, cell ) ).march();
}

} // namespace pliant_demos
