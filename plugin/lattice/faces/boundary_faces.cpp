#include "lattice/faces/boundary_faces.h"

#include "lattice/axis_neighbours.h"

#include <cmath>

namespace pliant {

namespace {

/// A corner of a cell: bit `axis` is set on the high side.
constexpr int kCorners = 8;

class BoundaryBuilder
{
public:
	explicit BoundaryBuilder( const Lattice& lattice ) :
		m_lattice( lattice ), m_beside( findAxisNeighbours( lattice ) ), m_vertex( m_beside.size() * kCorners, kNone )
	{}

	BoundaryFaces build()
	{
		m_faces.start.push_back( 0 );
		for ( std::size_t cell = 0; cell < m_beside.size(); ++cell )
		{
			for ( int side = 0; side < 6; ++side )
			{
				if ( m_beside[cell][std::size_t( side )] < 0 )
				{
					addFace( cell, side / 2, side % 2 );
				}
			}
		}
		return std::move( m_faces );
	}

private:
	static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

	void addFace( std::size_t cell, int axis, int high )
	{
		const int b = 1 << ( axis + 1 ) % 3, c = 1 << ( axis + 2 ) % 3, face = high << axis;
		const std::uint32_t p = vertexAt( cell, face ), q = vertexAt( cell, face | b ), r = vertexAt( cell, face | b | c ),
							s = vertexAt( cell, face | c );
		if ( high != 0 )
		{
			m_faces.triangle.push_back( { p, q, r } );
			m_faces.triangle.push_back( { p, r, s } );
		}
		else
		{
			m_faces.triangle.push_back( { p, r, q } );
			m_faces.triangle.push_back( { p, s, r } );
		}
	}

	/// The cells that are linked around a corner, from one of them on: up to eight, each with the corner on its own side.
	std::uint32_t vertexAt( std::size_t cell, int corner )
	{
		if ( const std::uint32_t known = m_vertex[cell * kCorners + std::size_t( corner )]; known != kNone )
		{
			return known;
		}
		const std::uint32_t vertex = std::uint32_t( m_faces.rest.size() );
		std::array<std::uint32_t, kCorners> found{};
		int count = 0;
		Vec3 sum = Vec3::Zero();
		const auto add = [&]( std::uint32_t which, int its ) {
			m_vertex[which * kCorners + std::size_t( its )] = vertex;
			found[std::size_t( count++ )] = which * kCorners + std::uint32_t( its );
			sum += cornerOf( which, its );
			m_faces.cell.push_back( which );
		};
		add( std::uint32_t( cell ), corner );
		for ( int k = 0; k < count; ++k )
		{
			const std::uint32_t from = found[std::size_t( k )] / kCorners;
			const int its = int( found[std::size_t( k )] % kCorners );
			for ( int axis = 0; axis < 3; ++axis )
			{
				const std::int32_t next = m_beside[from][std::size_t( 2 * axis + ( its >> axis & 1 ) )];
				const int opposite = its ^ 1 << axis;
				if ( next >= 0 && m_vertex[std::size_t( next ) * kCorners + std::size_t( opposite )] == kNone )
				{
					add( std::uint32_t( next ), opposite );
				}
			}
		}
		m_faces.rest.push_back( sum / float( count ) );
		m_faces.start.push_back( std::uint32_t( m_faces.cell.size() ) );
		return vertex;
	}

	/// The corner of a cube with the cell's material, about its centre.
	Vec3 cornerOf( std::uint32_t cell, int corner ) const
	{
		const float half = 0.5f * m_lattice.cellSize * std::cbrt( m_lattice.fill[cell] );
		return m_lattice.restCentre[cell] +
			half * Vec3( ( corner & 1 ) != 0 ? 1.0f : -1.0f, ( corner & 2 ) != 0 ? 1.0f : -1.0f, ( corner & 4 ) != 0 ? 1.0f : -1.0f );
	}

	const Lattice& m_lattice;
	AxisNeighbours m_beside;
	std::vector<std::uint32_t> m_vertex; // by cell and corner
	BoundaryFaces m_faces;
};

} // namespace

BoundaryFaces findBoundaryFaces( const Lattice& lattice )
{
	return BoundaryBuilder( lattice ).build();
}

} // namespace pliant
