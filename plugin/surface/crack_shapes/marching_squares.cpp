#include "surface/crack_shapes/marching_squares.h"

#include "surface/constants.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace pliant {

MarchingSquares::MarchingSquares(
	ClippedSurface& surface, const NoiseWarp& warp, std::vector<std::uint32_t>& merged, InsideTest isInside ) :
	m_surface( surface ),
	m_warp( warp ), m_merged( merged ), m_isInside( std::move( isInside ) )
{
	for ( const auto& [plane, point] : surface.insideCorner )
	{
		m_corner.emplace( cornerKey( plane ), merged[point] );
		m_isCornerInside.emplace( cornerKey( plane ), true );
	}
	if ( m_isInside )
	{
		m_isCornerInside.clear();
	}
}

/// Unlike positions, corners also lie on the outermost planes.
std::uint64_t MarchingSquares::cornerKey( const Eigen::Vector3i& plane ) const
{
	return positionKey( m_surface.extent + Eigen::Vector3i::Ones(), plane );
}

void MarchingSquares::square( const Eigen::Vector3i& below, int axis, std::vector<std::uint32_t>& points )
{
	points.clear();
	for ( const auto& [u, v] : { std::pair( 0, 0 ), std::pair( 1, 0 ), std::pair( 1, 1 ), std::pair( 0, 1 ) } )
	{
		Eigen::Vector3i plane = below;
		plane[axis] += 1;
		plane[( axis + 1 ) % 3] += u;
		plane[( axis + 2 ) % 3] += v;
		points.push_back( cornerPoint( plane ) );
	}
}

void MarchingSquares::outline( const Eigen::Vector3i& below, int axis, std::vector<std::uint32_t>& points )
{
	points.clear();
	const int u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
	std::array<Eigen::Vector3i, 4> corner;
	std::array<bool, 4> isInside{};
	for ( std::size_t k = 0; k < 4; ++k )
	{
		corner[k] = below;
		corner[k][axis] += 1;
		corner[k][u] += k == 1 || k == 2 ? 1 : 0;
		corner[k][v] += k >= 2 ? 1 : 0;
		isInside[k] = isCornerInside( corner[k] );
	}
	for ( std::size_t k = 0; k < 4; ++k )
	{
		if ( isInside[k] )
		{
			points.push_back( cornerPoint( corner[k] ) );
		}
		const std::size_t next = ( k + 1 ) % 4;
		if ( isInside[k] != isInside[next] )
		{
			const int along = k % 2 == 0 ? u : v;
			const bool isUp = k < 2; // the outline follows the line of this side upwards
			const Eigen::Vector3i& low = corner[isUp ? k : next];
			const Side side{ along, low[( along + 1 ) % 3], low[( along + 2 ) % 3], low[along] };
			points.push_back( crossing( side, isUp ? isInside[k] : isInside[next] ) );
		}
	}
	// Removes coincident crossings, where the surface passes through a corner.
	points.erase( std::unique( points.begin(), points.end() ), points.end() );
	while ( points.size() > 1 && points.front() == points.back() )
	{
		points.pop_back();
	}
}

bool MarchingSquares::isCornerInside( const Eigen::Vector3i& plane )
{
	const auto found = m_isCornerInside.find( cornerKey( plane ) );
	if ( found != m_isCornerInside.end() || !m_isInside )
	{
		return found != m_isCornerInside.end() && found->second;
	}
	return m_isCornerInside[cornerKey( plane )] = m_isInside( m_warp.backward( plane.cast<double>() ) );
}

std::uint32_t MarchingSquares::addPoint( const Vec3d& bent )
{
	ClipPoint made;
	made.bent = bent;
	made.rest = m_warp.backward( bent );
	m_surface.point.push_back( made );
	m_merged.push_back( std::uint32_t( m_surface.point.size() - 1 ) );
	return m_merged.back();
}

std::uint32_t MarchingSquares::cornerPoint( const Eigen::Vector3i& plane )
{
	const auto [entry, isNew] = m_corner.try_emplace( cornerKey( plane ), 0u );
	if ( isNew )
	{
		entry->second = addPoint( plane.cast<double>() );
	}
	return entry->second;
}

Vec3d MarchingSquares::bentPositionOn( const Side& side, double at ) const
{
	Vec3d bent;
	bent[side.axis] = at;
	bent[( side.axis + 1 ) % 3] = side.first;
	bent[( side.axis + 2 ) % 3] = side.second;
	return bent;
}

/// The crossing of the surface with a side that is nearest to the inside end.
std::uint32_t MarchingSquares::crossing( const Side& side, bool isLowInside )
{
	const auto line = []( const auto& s ) { return std::make_tuple( int( s.axis ), s.first, s.second, s.at ); };
	const std::vector<LineCrossing>& all = m_surface.lineCrossing; // sorted in this order by makeFaceEdges
	const auto first = std::lower_bound(
		all.begin(), all.end(), side, [&]( const LineCrossing& p, const Side& s ) { return line( p ) < line( s ); } );
	const auto last = std::upper_bound(
		first, all.end(), side, [&]( const Side& s, const LineCrossing& p ) { return line( s ) < line( p ); } );
	if ( first != last )
	{
		return m_merged[isLowInside ? first->point : std::prev( last )->point];
	}
	Eigen::Vector3i plane = bentPositionOn( side, side.at ).cast<int>();
	const auto [entry, isNew] = m_crossing.try_emplace( 3 * cornerKey( plane ) + std::uint64_t( side.axis ), 0u );
	if ( isNew )
	{
		entry->second = addPoint( bentPositionOn( side, bisect( side, isLowInside ) ) );
	}
	return entry->second;
}

double MarchingSquares::bisect( const Side& side, bool isLowInside ) const
{
	double low = side.at, high = side.at + 1.0;
	for ( int k = 0; k < kBisections && m_isInside; ++k )
	{
		const double middle = 0.5 * ( low + high );
		( m_isInside( m_warp.backward( bentPositionOn( side, middle ) ) ) == isLowInside ? low : high ) = middle;
	}
	return 0.5 * ( low + high );
}

void closeByMarchingSquares( FaceParts& parts, const std::vector<FaceEdge>& edges, const ClippedSurface& surface, MarchingSquares& squares,
	const std::vector<std::uint32_t>& merged )
{
	std::vector<std::uint32_t> points;
	for ( const std::uint64_t face : parts.broken )
	{
		const int axis = int( face % 3 );
		squares.outline( positionOfKey( surface.extent, face / 3 ), axis, points );
		if ( points.size() < 3 )
		{
			continue;
		}
		const std::uint32_t loop = std::uint32_t( parts.loops.count() );
		for ( const std::uint32_t p : points )
		{
			const Vec3d& bent = surface.point[p].bent;
			parts.loops.point.push_back( p );
			parts.at.emplace_back( bent[( axis + 1 ) % 3], bent[( axis + 2 ) % 3] );
		}
		parts.loops.close();
		FacePart part{ face / 3, axis, loop, loop + 1, std::uint32_t( parts.cutPoint.size() ), 0 };
		// The surface separates along its own cuts, although the drawn face does not reach them.
		const auto cuts = std::equal_range(
			edges.begin(), edges.end(), FaceEdge{ face, 0, 0 }, []( const FaceEdge& a, const FaceEdge& b ) { return a.face < b.face; } );
		for ( auto e = cuts.first; e != cuts.second; ++e )
		{
			parts.cutPoint.insert( parts.cutPoint.end(), { merged[e->from], merged[e->to] } );
		}
		part.lastCut = std::uint32_t( parts.cutPoint.size() );
		parts.part.push_back( part );
	}
}

} // namespace pliant
