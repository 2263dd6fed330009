#include "surface/face_drawing.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace pliant {

namespace {

/// A part of a face that stands between two cells.
struct Wall
{
	std::uint32_t a, b; ///< a < b
	std::uint32_t part;
	bool isAUpper;
};

/// The piece of surface there may draw the same edge: then an edge would have four triangles.
bool isOnOneTriangle( const SurfaceOrigin& a, const SurfaceOrigin& b )
{
	std::size_t count = 0, more = 0;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		count += a.vertex[k] != SurfaceOrigin::kNone;
		more += b.vertex[k] != SurfaceOrigin::kNone && std::find( a.vertex.begin(), a.vertex.end(), b.vertex[k] ) == a.vertex.end();
	}
	return !a.isInterior() && !b.isInterior() && count + more <= 3;
}

class FaceDrawer
{
public:
	FaceDrawer( ClippedSurface& surface, const FaceParts& parts, const NoiseWarp& warp, const CrackSettings& settings, MarchingSquares& squares ) :
		m_surface( surface ), m_parts( parts ), m_warp( warp ), m_settings( settings ), m_squares( squares )
	{
	}

	DrawnFaces run( const CellOwners& owners )
	{
		std::vector<Wall> walls;
		for ( std::uint32_t p = 0; p < m_parts.part.size(); ++p )
		{
			const std::uint32_t below = owners.below[p], above = owners.above[p];
			if ( below != above )
			{
				walls.push_back( { std::min( below, above ), std::max( below, above ), p, above < below } );
			}
		}
		std::sort( walls.begin(), walls.end(), []( const Wall& x, const Wall& y ) { return std::tie( x.a, x.b, x.part ) < std::tie( y.a, y.b, y.part ); } );
		for ( const Wall& wall : walls )
		{
			if ( m_out.face.empty() || m_out.face.back().cellA != wall.a || m_out.face.back().cellB != wall.b )
			{
				const std::uint32_t first = std::uint32_t( m_out.triangle.size() );
				m_out.face.push_back( { wall.a, wall.b, first, first, 0.0f, false } );
			}
			draw( wall );
			m_out.face.back().lastTriangle = std::uint32_t( m_out.triangle.size() );
		}
		return std::move( m_out );
	}

private:
	void draw( const Wall& wall )
	{
		const FacePart& part = m_parts.part[wall.part];
		const std::uint32_t first = m_parts.loops.start[part.firstLoop], last = m_parts.loops.start[part.lastLoop];
		for ( std::uint32_t k = first; k < last; ++k )
		{
			m_out.tie.emplace_back( m_parts.loops.point[k], std::uint32_t( m_out.face.size() - 1 ) );
		}
		for ( std::uint32_t k = part.firstCut; k < part.lastCut; ++k )
		{
			m_out.tie.emplace_back( m_parts.cutPoint[k], std::uint32_t( m_out.face.size() - 1 ) );
		}
		m_drawn.clear();
		if ( m_settings.faces != CrackFaces::Exact )
		{
			drawCoarsely( wall );
		}
		else if ( isWholeSquare( part ) )
		{
			drawSquare( part );
		}
		else
		{
			drawPart( part );
		}
		for ( std::array<std::uint32_t, 3> t : m_drawn )
		{
			if ( wall.isAUpper )
			{
				std::swap( t[1], t[2] );
			}
			for ( const std::uint32_t p : t )
			{
				m_out.tie.emplace_back( p, std::uint32_t( m_out.face.size() - 1 ) );
			}
			m_out.triangle.push_back( t );
			m_out.axis.push_back( std::uint8_t( 2 * part.axis + ( wall.isAUpper ? 1 : 0 ) ) );
		}
	}

	/// A square is drawn once between two cells, however many parts of it stand there.
	void drawCoarsely( const Wall& wall )
	{
		const FacePart& part = m_parts.part[wall.part];
		const Wall* before = std::exchange( m_before, &wall );
		const bool isKnown = before && before->a == wall.a && before->b == wall.b && m_parts.part[before->part].below == part.below &&
			m_parts.part[before->part].axis == part.axis;
		if ( isKnown )
		{
			return;
		}
		const Eigen::Vector3i below = positionOfKey( m_surface.extent, part.below );
		std::vector<std::uint32_t> ring;
		m_settings.faces == CrackFaces::Bricks ? m_squares.square( below, part.axis, ring ) : m_squares.outline( below, part.axis, ring );
		for ( std::size_t k = 2; k < ring.size(); ++k )
		{
			m_drawn.push_back( { ring[0], ring[k - 1], ring[k] } );
		}
	}

	bool isWholeSquare( const FacePart& part ) const
	{
		const std::uint32_t first = m_parts.loops.start[part.firstLoop], last = m_parts.loops.start[part.firstLoop + 1];
		if ( part.lastLoop != part.firstLoop + 1 || last - first != std::uint32_t( 4 * m_settings.subdivision ) )
		{
			return false;
		}
		return std::all_of( m_parts.loops.point.begin() + first, m_parts.loops.point.begin() + last,
			[this]( std::uint32_t p ) { return m_surface.point[p].origin.isInterior(); } );
	}

	/// n x n squares. The ring begins anywhere; its lowest corner is where both coordinates are lowest.
	void drawSquare( const FacePart& part )
	{
		const int n = m_settings.subdivision;
		const std::uint32_t first = m_parts.loops.start[part.firstLoop];
		const auto ring = [&]( int k ) { return first + std::uint32_t( k % ( 4 * n ) ); };
		int low = 0;
		for ( int k = 1; k < 4 * n; ++k )
		{
			const Vec2d& a = m_parts.at[ring( k )];
			const Vec2d& b = m_parts.at[ring( low )];
			low = a.x() + a.y() < b.x() + b.y() ? k : low;
		}
		std::vector<std::uint32_t> grid( std::size_t( ( n + 1 ) * ( n + 1 ) ) );
		for ( int v = 0; v <= n; ++v )
		{
			for ( int u = 0; u <= n; ++u )
			{
				// Counter-clockwise: along the lower side, up, back, down.
				const int onRing = v == 0 ? u : u == n ? n + v : v == n ? 3 * n - u : u == 0 ? 4 * n - v : -1;
				grid[std::size_t( v * ( n + 1 ) + u )] = onRing >= 0 ? m_parts.loops.point[ring( low + onRing )]
																	 : addPoint( part, m_parts.at[ring( low )] + Vec2d( u, v ) / n );
			}
		}
		for ( int v = 0; v < n; ++v )
		{
			for ( int u = 0; u < n; ++u )
			{
				const std::uint32_t* c = &grid[std::size_t( v * ( n + 1 ) + u )];
				const std::uint32_t *d = c + n + 1;
				if ( ( u + v ) % 2 == 0 )
				{
					m_drawn.insert( m_drawn.end(), { { c[0], c[1], d[1] }, { c[0], d[1], d[0] } } );
				}
				else
				{
					m_drawn.insert( m_drawn.end(), { { c[0], c[1], d[0] }, { c[1], d[1], d[0] } } );
				}
			}
		}
	}

	std::uint32_t addPoint( const FacePart& part, const Vec2d& at )
	{
		ClipPoint made;
		made.place[part.axis] = positionOfKey( m_surface.extent, part.below )[part.axis] + 1;
		made.place[( part.axis + 1 ) % 3] = at.x();
		made.place[( part.axis + 2 ) % 3] = at.y();
		made.rest = m_warp.backward( made.place );
		m_surface.point.push_back( made );
		return std::uint32_t( m_surface.point.size() - 1 );
	}

	void drawPart( const FacePart& part )
	{
		OutlinePart outline;
		outline.outer = part.firstLoop;
		for ( std::uint32_t loop = part.firstLoop + 1; loop < part.lastLoop; ++loop )
		{
			outline.holes.push_back( loop );
		}
		triangulate( m_parts.loops, m_parts.at, outline, m_drawn, [this]( std::uint32_t a, std::uint32_t b ) {
			return isOnOneTriangle( m_surface.point[m_parts.loops.point[a]].origin, m_surface.point[m_parts.loops.point[b]].origin );
		} );
		for ( std::array<std::uint32_t, 3>& t : m_drawn )
		{
			t = { m_parts.loops.point[t[0]], m_parts.loops.point[t[1]], m_parts.loops.point[t[2]] };
		}
	}

	ClippedSurface& m_surface;
	const FaceParts& m_parts;
	const NoiseWarp& m_warp;
	const CrackSettings& m_settings;
	MarchingSquares& m_squares;
	const Wall* m_before = nullptr; ///< the wall drawn last
	DrawnFaces m_out;
	std::vector<std::array<std::uint32_t, 3>> m_drawn;
};

} // namespace

DrawnFaces drawFaces( ClippedSurface& surface, const FaceParts& parts, const CellOwners& owners, const NoiseWarp& warp, const CrackSettings& settings,
	MarchingSquares& squares )
{
	return FaceDrawer( surface, parts, warp, settings, squares ).run( owners );
}

} // namespace pliant
