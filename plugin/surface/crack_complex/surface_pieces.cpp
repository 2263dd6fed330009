// The polygons that a cell has of one triangle are drawn as one: edges between them cancel.

#include "surface/crack_complex/surface_pieces.h"

#include "surface/crack_shapes/outline.h"
#include "surface/skin/cell_finder.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <memory>
#include <tuple>

namespace pliant {

namespace {

/// The input triangle of a triangle of the welded mesh.
struct Source
{
	std::uint32_t triangle = CellComplex::kNone;
	Triangle vertex{}; ///< of the input, by corner of the welded triangle
	bool isReversed = false;
};

Triangle sorted( Triangle t )
{
	std::sort( t.begin(), t.end() );
	return t;
}

class PieceDrawer
{
public:
	PieceDrawer( const PieceInput& input, const ClippedSurface& surface, const std::vector<std::uint32_t>& merged ) :
		m_mesh( input.mesh ), m_welded( input.welded ), m_lattice( input.lattice ), m_faceEdges( input.faceEdges ), m_surface( surface ),
		m_merged( merged ), m_firstVertex( surface.point.size(), CellComplex::kNone )
	{
		m_out.vertexPoint = m_welded.weldedVertex;
	}

	SurfacePieces run( const std::vector<std::uint32_t>& owner )
	{
		findSources();
		std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> order; // cell, triangle, polygon
		for ( std::uint32_t p = 0; p < m_surface.polygons.count(); ++p )
		{
			const std::uint32_t t = m_surface.polygons.triangle[p];
			if ( t < m_welded.triangle.size() ) // not a cap
			{
				order.emplace_back( owner[p], t, p );
			}
		}
		for ( const auto& [cell, triangle] : m_loose )
		{
			order.emplace_back( cell, triangle + std::uint32_t( m_welded.triangle.size() ), CellComplex::kNone );
		}
		std::sort( order.begin(), order.end() );
		std::size_t last = 0;
		for ( std::uint32_t cell = 0; cell < std::uint32_t( m_lattice.cellCount() ); ++cell )
		{
			m_out.cellStart.push_back( std::uint32_t( m_out.triangle.size() ) );
			while ( last < order.size() && std::get<0>( order[last] ) == cell )
			{
				const std::size_t first = last;
				const std::uint32_t triangle = std::get<1>( order[first] );
				m_polygons.clear();
				for ( ; last < order.size() && std::get<0>( order[last] ) == cell && std::get<1>( order[last] ) == triangle; ++last )
				{
					m_polygons.push_back( std::get<2>( order[last] ) );
				}
				draw( triangle );
			}
		}
		m_out.cellStart.push_back( std::uint32_t( m_out.triangle.size() ) );
		return std::move( m_out );
	}

private:
	/// Finds the input triangles by their vertices: welding has sorted and reoriented the triangles and dropped some.
	void findSources()
	{
		std::vector<std::pair<Triangle, std::uint32_t>> known;
		for ( std::uint32_t t = 0; t < m_mesh.triangleCount; ++t )
		{
			known.emplace_back( sorted( weldedCorners( t ) ), t );
		}
		std::sort( known.begin(), known.end() );
		std::vector<std::uint8_t> isFound( m_mesh.triangleCount, 0 );
		m_source.resize( m_welded.triangle.size() );
		for ( std::size_t w = 0; w < m_welded.triangle.size(); ++w )
		{
			const auto found = std::lower_bound( known.begin(), known.end(), std::make_pair( sorted( m_welded.triangle[w] ), 0u ) );
			isFound[found->second] = 1;
			m_source[w] = sourceOf( m_welded.triangle[w], found->second );
		}
		for ( const auto& [corners, t] : known )
		{
			const bool isFlat = corners[0] == corners[1] || corners[1] == corners[2];
			if ( !isFound[t] && !isFlat )
			{
				addLoose( t );
			}
		}
	}

	Triangle weldedCorners( std::uint32_t t ) const
	{
		const std::uint32_t* v = m_mesh.indices + 3 * std::size_t( t );
		return { m_welded.weldedVertex[v[0]], m_welded.weldedVertex[v[1]], m_welded.weldedVertex[v[2]] };
	}

	Source sourceOf( const Triangle& welded, std::uint32_t t ) const
	{
		const Triangle corners = weldedCorners( t );
		Source source;
		source.triangle = t;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const std::size_t at = std::size_t( std::find( corners.begin(), corners.end(), welded[k] ) - corners.begin() );
			source.vertex[k] = m_mesh.indices[3 * std::size_t( t ) + at];
			source.isReversed = k == 0 ? corners[( at + 1 ) % 3] != welded[1] : source.isReversed;
		}
		return source;
	}

	/// Adds a triangle that bounds no material, such as a doubled wall, as a whole to the nearest cell.
	void addLoose( std::uint32_t t )
	{
		if ( !m_tree )
		{
			m_tree = std::make_unique<CellTree>( m_lattice );
		}
		const Triangle c = weldedCorners( t );
		const Vec3d middle = ( m_welded.position[c[0]] + m_welded.position[c[1]] + m_welded.position[c[2]] ) / 3.0;
		m_loose.emplace_back( std::uint32_t( m_tree->nearest( middle ) ), t );
	}

	void draw( std::uint32_t triangle )
	{
		if ( triangle >= m_welded.triangle.size() )
		{
			const std::uint32_t t = triangle - std::uint32_t( m_welded.triangle.size() );
			const std::uint32_t* v = m_mesh.indices + 3 * std::size_t( t );
			m_out.triangle.push_back( { v[0], v[1], v[2] } );
			m_out.source.push_back( t );
			return;
		}
		m_edges.clear();
		for ( const std::uint32_t p : m_polygons )
		{
			const std::uint32_t first = m_surface.polygons.start[p], last = m_surface.polygons.start[p + 1];
			for ( std::uint32_t c = first; c < last; ++c )
			{
				const std::uint32_t next = c + 1 < last ? c + 1 : first;
				m_edges.emplace_back( m_merged[m_surface.polygons.point[c]], m_merged[m_surface.polygons.point[next]] );
			}
		}
		m_loops.clear();
		traceLoops( m_edges, m_loops );
		flatten( triangle );
		m_drawn.clear();
		for ( const OutlinePart& part : groupLoops( m_loops, m_at ) )
		{
			triangulate( m_loops, m_at, part, m_drawn, [this]( std::uint32_t a, std::uint32_t b ) {
				const std::pair<std::uint32_t, std::uint32_t> ends = std::minmax( m_loops.point[a], m_loops.point[b] );
				return std::binary_search( m_faceEdges.begin(), m_faceEdges.end(), ends );
			} );
		}
		for ( const auto& t : m_drawn )
		{
			std::array<std::uint32_t, 3> v;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				v[k] = vertexAt( m_loops.point[t[k]], triangle, m_at[t[k]] );
			}
			if ( m_source[triangle].isReversed )
			{
				std::swap( v[1], v[2] );
			}
			m_out.triangle.push_back( v );
			m_out.source.push_back( m_source[triangle].triangle );
		}
	}

	/// Computes coordinates within the triangle: along its first side, and across it.
	void flatten( std::uint32_t triangle )
	{
		const Triangle& t = m_welded.triangle[triangle];
		const Vec3d origin = m_surface.point[t[0]].rest;
		const Vec3d side = m_surface.point[t[1]].rest - origin, other = m_surface.point[t[2]].rest - origin;
		const Vec3d along = side.normalized();
		const Vec3d across = ( other - along.dot( other ) * along ).normalized();
		m_at.clear();
		for ( const std::uint32_t p : m_loops.point )
		{
			const Vec3d away = m_surface.point[p].rest - origin;
			m_at.emplace_back( along.dot( away ), across.dot( away ) );
		}
		m_corner[0] = Vec2d::Zero();
		m_corner[1] = Vec2d( along.dot( side ), 0.0 );
		m_corner[2] = Vec2d( along.dot( other ), across.dot( other ) );
	}

	/// Barycentric weights of a point in a triangle.
	std::array<double, 3> weightsAt( std::uint32_t point, std::uint32_t triangle, const Vec2d& at ) const
	{
		const Triangle& t = m_welded.triangle[triangle];
		const SurfaceOrigin& origin = m_surface.point[point].origin;
		std::array<double, 3> fraction{ 0.0, 0.0, 0.0 };
		bool isOfTriangle = !origin.isInterior();
		for ( std::size_t k = 0; k < 3 && origin.vertex[k] != SurfaceOrigin::kNone; ++k )
		{
			const std::size_t corner = std::size_t( std::find( t.begin(), t.end(), origin.vertex[k] ) - t.begin() );
			isOfTriangle = isOfTriangle && corner < 3;
			if ( corner < 3 )
			{
				fraction[corner] = origin.weight[k];
			}
		}
		if ( isOfTriangle )
		{
			return fraction;
		}
		// The point was merged with one of a neighbouring triangle.
		const double whole = doubleArea( m_corner[0], m_corner[1], m_corner[2] );
		double sum = 0.0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			fraction[k] = whole > 0.0 ? std::max( 0.0, doubleArea( m_corner[( k + 1 ) % 3], m_corner[( k + 2 ) % 3], at ) / whole ) : 1.0;
			sum += fraction[k];
		}
		for ( double& s : fraction )
		{
			s /= sum;
		}
		return fraction;
	}

	/// The vertex of a point in this triangle: triangles that share the input's vertices there share it.
	std::uint32_t vertexAt( std::uint32_t point, std::uint32_t triangle, const Vec2d& at )
	{
		const std::array<double, 3> fraction = weightsAt( point, triangle, at );
		std::array<std::pair<std::uint32_t, float>, 3> used;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			used[k] = { fraction[k] > 0.0 ? m_source[triangle].vertex[k] : CellComplex::kNone, float( fraction[k] ) };
		}
		std::sort( used.begin(), used.end() );
		if ( used[1].first == CellComplex::kNone && m_surface.point[point].origin.isInput() )
		{
			return used[0].first;
		}
		CellComplex::Origin origin;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			origin.vertex[k] = used[k].first;
			origin.weight[k] = used[k].second;
		}
		for ( std::uint32_t v = m_firstVertex[point]; v != CellComplex::kNone; v = m_nextVertex[v] )
		{
			if ( m_out.addedOrigin[v].vertex == origin.vertex )
			{
				return v + std::uint32_t( m_mesh.vertexCount );
			}
		}
		m_nextVertex.push_back( m_firstVertex[point] );
		m_firstVertex[point] = std::uint32_t( m_out.addedOrigin.size() );
		m_out.addedOrigin.push_back( origin );
		m_out.vertexPoint.push_back( point );
		return m_firstVertex[point] + std::uint32_t( m_mesh.vertexCount );
	}

	const MeshView& m_mesh;
	const WeldedMesh& m_welded;
	const Lattice& m_lattice;
	const std::vector<std::pair<std::uint32_t, std::uint32_t>>& m_faceEdges;
	const ClippedSurface& m_surface;
	const std::vector<std::uint32_t>& m_merged;
	SurfacePieces m_out;
	std::vector<Source> m_source;
	std::vector<std::pair<std::uint32_t, std::uint32_t>> m_loose; ///< cell, input triangle
	std::unique_ptr<CellTree> m_tree;
	std::vector<std::uint32_t> m_firstVertex, m_nextVertex; ///< added vertices at a point
	std::vector<std::uint32_t> m_polygons;
	std::vector<OutlineEdge> m_edges;
	Loops m_loops;
	std::vector<Vec2d> m_at;
	std::array<Vec2d, 3> m_corner;
	std::vector<std::array<std::uint32_t, 3>> m_drawn;
};

} // namespace

SurfacePieces drawPieces( const PieceInput& input, const ClippedSurface& surface, const std::vector<std::uint32_t>& owner,
	const std::vector<std::uint32_t>& merged )
{
	return PieceDrawer( input, surface, merged ).run( owner );
}

} // namespace pliant
