#include "surface/crack_complex/face_drawing.h"

#include "surface/constants.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace pliant {

namespace {

/// A part of a face that separates two cells.
struct Wall
{
	std::uint32_t a, b; ///< a < b
	std::uint32_t part;
	bool isAUpper;
};

/// True where a piece of surface may draw the same edge, which would then have four triangles.
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
	FaceDrawer(
		ClippedSurface& surface, const FaceParts& parts, const NoiseWarp& warp, const CrackSettings& settings, MarchingSquares& squares ) :
		m_surface( surface ),
		m_parts( parts ), m_warp( warp ), m_settings( settings ), m_squares( squares )
	{}

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
		std::sort( walls.begin(), walls.end(),
			[]( const Wall& x, const Wall& y ) { return std::tie( x.a, x.b, x.part ) < std::tie( y.a, y.b, y.part ); } );
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
			m_out.incidence.emplace_back( m_parts.loops.point[k], std::uint32_t( m_out.face.size() - 1 ) );
		}
		for ( std::uint32_t k = part.firstCut; k < part.lastCut; ++k )
		{
			m_out.incidence.emplace_back( m_parts.cutPoint[k], std::uint32_t( m_out.face.size() - 1 ) );
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
				m_out.incidence.emplace_back( p, std::uint32_t( m_out.face.size() - 1 ) );
			}
			m_out.triangle.push_back( t );
			m_out.axis.push_back( std::uint8_t( 2 * part.axis + ( wall.isAUpper ? 1 : 0 ) ) );
		}
	}

	/// Draws a square once between two cells, regardless of how many parts it has there.
	void drawCoarsely( const Wall& wall )
	{
		const FacePart& part = m_parts.part[wall.part];
		const Wall* previous = std::exchange( m_previous, &wall );
		const bool isKnown = previous && previous->a == wall.a && previous->b == wall.b &&
			m_parts.part[previous->part].below == part.below && m_parts.part[previous->part].axis == part.axis;
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

	/// True for a part bordered by the lattice's lines only: it has all four corners and, between them, the points that the lines kept.
	bool isWholeSquare( const FacePart& part ) const
	{
		const std::uint32_t first = m_parts.loops.start[part.firstLoop], last = m_parts.loops.start[part.firstLoop + 1];
		if ( part.lastLoop != part.firstLoop + 1 || last - first > std::uint32_t( 4 * m_settings.subdivision ) )
		{
			return false;
		}
		int corners = 0;
		for ( std::uint32_t k = first; k < last; ++k )
		{
			const Vec2d at = onGrid( part, k );
			corners += isCorner( at ) ? 1 : 0;
			if ( !m_surface.point[m_parts.loops.point[k]].origin.isInterior() ||
				( at - at.array().round().matrix() ).cwiseAbs().maxCoeff() > kOffGrid )
			{
				return false;
			}
		}
		return corners == 4;
	}

	/// Grid coordinates of an entry of the loops along the face's sides, 0 to subdivision.
	Vec2d onGrid( const FacePart& part, std::uint32_t entry ) const
	{
		const Eigen::Vector3i below = positionOfKey( m_surface.extent, part.below );
		return m_settings.subdivision * ( m_parts.at[entry] - Vec2d( below[( part.axis + 1 ) % 3], below[( part.axis + 2 ) % 3] ) );
	}

	bool isCorner( const Vec2d& at ) const
	{
		const auto isEnd = [n = double( m_settings.subdivision )](
							   double x ) { return std::abs( x ) < kOffGrid || std::abs( x - n ) < kOffGrid; };
		return isEnd( at.x() ) && isEnd( at.y() );
	}

	/// Draws n x n squares, or the border alone if no inner point would deviate from it.
	void drawSquare( const FacePart& part )
	{
		const int n = m_settings.subdivision;
		std::vector<ClipPoint> within;
		for ( int k = 0; k < ( n - 1 ) * ( n - 1 ); ++k )
		{
			within.push_back( pointAt( part, 1 + k % ( n - 1 ), 1 + k / ( n - 1 ) ) );
		}
		drawPart( part );
		if ( !within.empty() &&
			std::all_of( within.begin(), within.end(), [&]( const ClipPoint& p ) { return isDrawnAlready( part, p ); } ) )
		{
			return;
		}
		m_drawn.clear();
		std::vector<std::uint32_t> grid( std::size_t( ( n + 1 ) * ( n + 1 ) ), SurfaceOrigin::kNone );
		const auto at = [&grid, n]( int u, int v ) -> std::uint32_t& { return grid[std::size_t( v * ( n + 1 ) + u )]; };
		for ( std::uint32_t k = m_parts.loops.start[part.firstLoop]; k < m_parts.loops.start[part.lastLoop]; ++k )
		{
			const Vec2d position = onGrid( part, k );
			at( int( std::lround( position.x() ) ), int( std::lround( position.y() ) ) ) = m_parts.loops.point[k];
		}
		for ( int v = 0; v <= n; ++v )
		{
			for ( int u = 0; u <= n; ++u )
			{
				if ( u % n != 0 && v % n != 0 )
				{
					m_surface.point.push_back( within[std::size_t( ( v - 1 ) * ( n - 1 ) + u - 1 )] );
					at( u, v ) = std::uint32_t( m_surface.point.size() - 1 );
				}
				else if ( at( u, v ) == SurfaceOrigin::kNone ) // left out: replaced by the previous point of the side
				{
					at( u, v ) = u % n != 0 ? at( u - 1, v ) : at( u, v - 1 );
				}
			}
		}
		drawGrid( grid );
	}

	void drawGrid( const std::vector<std::uint32_t>& grid )
	{
		const int n = m_settings.subdivision;
		const auto add = [this]( std::uint32_t a, std::uint32_t b, std::uint32_t c ) {
			if ( a != b && b != c && c != a )
			{
				m_drawn.push_back( { a, b, c } );
			}
		};
		for ( int v = 0; v < n; ++v )
		{
			for ( int u = 0; u < n; ++u )
			{
				const std::uint32_t* c = &grid[std::size_t( v * ( n + 1 ) + u )];
				const std::uint32_t* d = c + n + 1;
				const bool isEven = ( u + v ) % 2 == 0;
				add( c[0], c[1], isEven ? d[1] : d[0] );
				isEven ? add( c[0], d[1], d[0] ) : add( c[1], d[1], d[0] );
			}
		}
	}

	ClipPoint pointAt( const FacePart& part, int u, int v ) const
	{
		const Eigen::Vector3i below = positionOfKey( m_surface.extent, part.below );
		ClipPoint made;
		made.bent[part.axis] = below[part.axis] + 1;
		made.bent[( part.axis + 1 ) % 3] = below[( part.axis + 1 ) % 3] + double( u ) / m_settings.subdivision;
		made.bent[( part.axis + 2 ) % 3] = below[( part.axis + 2 ) % 3] + double( v ) / m_settings.subdivision;
		made.rest = m_warp.backward( made.bent );
		return made;
	}

	/// True where the drawn triangles pass within the tolerance of a point of the face.
	bool isDrawnAlready( const FacePart& part, const ClipPoint& p ) const
	{
		const auto flat = [axis = part.axis](
							  const ClipPoint& of ) { return Vec2d( of.bent[( axis + 1 ) % 3], of.bent[( axis + 2 ) % 3] ); };
		const auto found = std::find_if( m_drawn.begin(), m_drawn.end(), [&]( const std::array<std::uint32_t, 3>& t ) {
			const Vec2d a = flat( m_surface.point[t[0]] ), b = flat( m_surface.point[t[1]] ), c = flat( m_surface.point[t[2]] );
			return doubleArea( a, b, flat( p ) ) >= 0.0 && doubleArea( b, c, flat( p ) ) >= 0.0 && doubleArea( c, a, flat( p ) ) >= 0.0;
		} );
		if ( found == m_drawn.end() )
		{
			return false;
		}
		const Vec3d& a = m_surface.point[( *found )[0]].rest;
		const Vec3d normal = ( m_surface.point[( *found )[1]].rest - a ).cross( m_surface.point[( *found )[2]].rest - a ).normalized();
		return std::abs( normal.dot( p.rest - a ) ) < double( m_settings.bendTolerance );
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
	const Wall* m_previous = nullptr; ///< drawn last
	DrawnFaces m_out;
	std::vector<std::array<std::uint32_t, 3>> m_drawn;
};

} // namespace

DrawnFaces drawFaces( ClippedSurface& surface, const FaceParts& parts, const CellOwners& owners, const NoiseWarp& warp,
	const CrackSettings& settings, MarchingSquares& squares )
{
	return FaceDrawer( surface, parts, warp, settings, squares ).run( owners );
}

} // namespace pliant
