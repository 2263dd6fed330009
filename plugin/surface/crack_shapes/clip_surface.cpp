// For each axis in rotation, all edges that pass from one slab to another are cut, then every polygon is distributed over the slabs.

#include "surface/crack_shapes/clip_surface.h"

#include "surface/constants.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace pliant {

namespace {

std::uint64_t edgeKey( std::uint32_t a, std::uint32_t b )
{
	return std::uint64_t( std::min( a, b ) ) << 32 | std::max( a, b );
}

/// ( 1 - t ) a + t b. Both lie on one triangle, so at most three vertices have a weight.
SurfaceOrigin blend( const SurfaceOrigin& a, const SurfaceOrigin& b, double t )
{
	SurfaceOrigin out;
	std::size_t count = 0;
	const auto add = [&]( const SurfaceOrigin& o, double fraction ) {
		for ( std::size_t k = 0; k < 3 && o.vertex[k] != SurfaceOrigin::kNone; ++k )
		{
			std::size_t at = 0;
			while ( at < count && out.vertex[at] < o.vertex[k] )
			{
				++at;
			}
			if ( at == count || out.vertex[at] != o.vertex[k] )
			{
				std::copy_backward( out.vertex.begin() + at, out.vertex.end() - 1, out.vertex.end() );
				std::copy_backward( out.weight.begin() + at, out.weight.end() - 1, out.weight.end() );
				out.vertex[at] = o.vertex[k];
				out.weight[at] = 0.0;
				++count;
			}
			out.weight[at] += fraction * o.weight[k];
		}
	};
	add( a, 1.0 - t );
	add( b, t );
	return out;
}

/// A corner of a polygon that is being distributed. Level 2 k: on plane k; 2 k + 1: in slab k.
struct Item
{
	std::uint32_t point;
	std::uint8_t plane;
	int level;
};

class SurfaceClipper
{
public:
	explicit SurfaceClipper( const ClipInput& input ) : m_input( input )
	{
		m_out.extent = input.extent;
		m_out.point.reserve( 3 * input.position.size() );
		for ( std::size_t i = 0; i < input.position.size(); ++i )
		{
			SurfaceOrigin origin;
			origin.vertex[0] = std::uint32_t( i );
			origin.weight[0] = 1.0;
			m_out.point.push_back( { input.warp.forward( input.position[i] ), input.position[i], origin } );
		}
	}

	ClippedSurface run()
	{
		std::vector<Piece> pieces;
		for ( std::size_t t = 0; t < m_input.triangles.size(); ++t )
		{
			pieces.push_back( { m_input.triangles[t], std::uint32_t( t ) } );
		}
		if ( !m_input.warp.isOff() )
		{
			while ( bisectLongEdges( pieces ) )
			{}
		}
		for ( const Piece& piece : pieces )
		{
			for ( const std::uint32_t corner : piece.corner )
			{
				m_out.polygons.point.push_back( corner );
				m_out.polygons.plane.push_back( kNoPlane );
			}
			m_out.polygons.start.push_back( std::uint32_t( m_out.polygons.point.size() ) );
			m_out.polygons.position.push_back( Eigen::Vector3i::Zero() );
			m_out.polygons.triangle.push_back( piece.source );
		}
		for ( int axis = 0; axis < 3; ++axis )
		{
			cutAlong( axis );
		}
		return std::move( m_out );
	}

private:
	struct Piece
	{
		Triangle corner;
		std::uint32_t source;
	};

	/// Adds a point between a and b; the result does not depend on their order.
	std::uint32_t addBetween( std::uint32_t a, std::uint32_t b, double t )
	{
		const ClipPoint& p = m_out.point[a];
		const ClipPoint& q = m_out.point[b];
		ClipPoint made;
		made.origin = blend( p.origin, q.origin, t );
		made.rest.setZero();
		for ( std::size_t k = 0; k < 3 && made.origin.vertex[k] != SurfaceOrigin::kNone; ++k )
		{
			made.rest += made.origin.weight[k] * m_input.position[made.origin.vertex[k]];
		}
		// Clamped to the ends, so that the slab changes monotonically along an edge.
		made.bent = ( p.bent + t * ( q.bent - p.bent ) ).cwiseMax( p.bent.cwiseMin( q.bent ) ).cwiseMin( p.bent.cwiseMax( q.bent ) );
		m_out.point.push_back( made );
		return std::uint32_t( m_out.point.size() - 1 );
	}

	/// One round: bisects every edge that is too long and divides each triangle into two, three or four accordingly.
	bool bisectLongEdges( std::vector<Piece>& pieces )
	{
		std::unordered_map<std::uint64_t, std::uint32_t> middle; // for lookup only: its order has no effect
		std::vector<Piece> next;
		bool isAny = false;
		for ( const Piece& piece : pieces )
		{
			std::array<std::uint32_t, 3> half{};
			int cuts = 0;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				half[k] = halfOf( piece.corner[k], piece.corner[( k + 1 ) % 3], middle );
				cuts += half[k] != SurfaceOrigin::kNone;
			}
			isAny = isAny || cuts > 0;
			addHalves( piece, half, cuts, next );
		}
		pieces = std::move( next );
		return isAny;
	}

	std::uint32_t halfOf( std::uint32_t a, std::uint32_t b, std::unordered_map<std::uint64_t, std::uint32_t>& middle )
	{
		if ( ( m_out.point[a].rest - m_out.point[b].rest ).squaredNorm() <= m_input.longestEdge * m_input.longestEdge )
		{
			return SurfaceOrigin::kNone;
		}
		const auto [entry, isNew] = middle.try_emplace( edgeKey( a, b ), 0u );
		if ( isNew )
		{
			entry->second = addBetween( std::min( a, b ), std::max( a, b ), 0.5 );
			ClipPoint& made = m_out.point[entry->second];
			made.bent = m_input.warp.forward( made.rest );
		}
		return entry->second;
	}

	void addHalves( const Piece& piece, const std::array<std::uint32_t, 3>& half, int cuts, std::vector<Piece>& out ) const
	{
		const auto isCut = [&]( std::size_t k ) { return half[k % 3] != SurfaceOrigin::kNone; };
		const auto add = [&]( std::uint32_t a, std::uint32_t b, std::uint32_t c ) { out.push_back( { { a, b, c }, piece.source } ); };
		std::size_t rotation = 0; // rotates the triangle so that the only cut edge, or the only uncut one, comes last
		while ( rotation < 3 && ( ( cuts == 1 && !isCut( rotation + 2 ) ) || ( cuts == 2 && isCut( rotation + 2 ) ) ) )
		{
			++rotation;
		}
		const std::uint32_t a = piece.corner[rotation % 3], b = piece.corner[( rotation + 1 ) % 3], c = piece.corner[( rotation + 2 ) % 3];
		const std::uint32_t ab = half[rotation % 3], bc = half[( rotation + 1 ) % 3], ca = half[( rotation + 2 ) % 3];
		switch ( cuts )
		{
			case 0: add( a, b, c ); return;
			case 1:
				add( a, b, ca );
				add( b, c, ca );
				return;
			case 2:
				add( ab, b, bc );
				add( a, ab, bc );
				add( a, bc, c );
				return;
			default:
				add( a, ab, ca );
				add( ab, b, bc );
				add( ca, bc, c );
				add( ab, bc, ca );
				return;
		}
	}

	// === Cutting ===

	/// Adds the points on the planes between a and b, with consecutive indices from the lower-numbered end. Returns the first.
	std::uint32_t cutEdge( std::uint32_t a, std::uint32_t b, int axis )
	{
		const std::uint32_t low = std::min( a, b ), high = std::max( a, b );
		const auto [entry, isNew] = m_cut.try_emplace( edgeKey( a, b ), std::uint32_t( m_out.point.size() ) );
		if ( isNew )
		{
			const int from = m_out.positionOf( low, axis ), to = m_out.positionOf( high, axis );
			const double x = m_out.point[low].bent[axis], y = m_out.point[high].bent[axis];
			const int step = to > from ? 1 : -1;
			for ( int k = from; k != to; k += step )
			{
				const int plane = step > 0 ? k + 1 : k;
				const std::uint32_t made = addBetween( low, high, std::clamp( ( plane - x ) / ( y - x ), 0.0, 1.0 ) );
				m_out.point[made].bent[axis] = plane;
			}
		}
		return entry->second;
	}

	void cutAlong( int axis )
	{
		m_cut.clear();
		const ClipPolygons old = std::move( m_out.polygons );
		m_out.polygons = ClipPolygons{};
		for ( std::size_t p = 0; p < old.count(); ++p )
		{
			const std::uint32_t first = old.start[p], last = old.start[p + 1];
			m_items.clear();
			for ( std::uint32_t c = first; c < last; ++c )
			{
				const std::uint32_t next = old.point[c + 1 < last ? c + 1 : first];
				addCorner( old.point[c], next, old.plane[c], axis, old.position[p] );
			}
			distribute( axis, old.position[p], old.triangle[p] );
		}
	}

	/// Adds one corner and the cuts of the edge that leaves it.
	void addCorner( std::uint32_t here, std::uint32_t next, std::uint8_t plane, int axis, const Eigen::Vector3i& position )
	{
		const int from = m_out.positionOf( here, axis ), to = m_out.positionOf( next, axis );
		m_items.push_back( { here, plane, 2 * from + 1 } );
		if ( from == to )
		{
			return;
		}
		const int count = std::abs( to - from );
		const std::uint32_t first = cutEdge( here, next, axis );
		for ( int k = 0; k < count; ++k )
		{
			const std::uint32_t made = first + std::uint32_t( here < next ? k : count - 1 - k );
			const int level = to > from ? 2 * ( from + 1 + k ) : 2 * ( from - k );
			m_items.push_back( { made, plane, level } );
			noteCrossing( m_items.back(), axis, to > from, position );
		}
	}

	/// Notes where an edge on a plane is cut by another plane: a line of the lattice passes there. Done only from below the first plane.
	void noteCrossing( const Item& item, int axis, bool isAscending, const Eigen::Vector3i& position )
	{
		for ( int other = 0; other < axis; ++other )
		{
			if ( item.plane != planeTag( other, true ) )
			{
				continue;
			}
			// The face's edge is opposite to the edge of the surface; see crack_faces.cpp for the resulting orientation.
			const bool isNext = axis == ( other + 1 ) % 3;
			const int sign = ( isAscending != isNext ) ? 1 : -1;
			const int line = 3 - axis - other;
			Eigen::Vector3i plane = Eigen::Vector3i::Zero();
			plane[other] = position[other] + 1;
			plane[axis] = item.level / 2;
			m_out.lineCrossing.push_back(
				{ item.point, std::int8_t( line ), std::int8_t( sign ), plane[( line + 1 ) % 3], plane[( line + 2 ) % 3], 0 } );
		}
	}

	void emit( const std::vector<Item>& items, int axis, int slab, Eigen::Vector3i position, std::uint32_t triangle )
	{
		position[axis] = slab;
		for ( const Item& item : items )
		{
			m_out.polygons.point.push_back( item.point );
			m_out.polygons.plane.push_back( item.plane );
		}
		m_out.polygons.start.push_back( std::uint32_t( m_out.polygons.point.size() ) );
		m_out.polygons.position.push_back( position );
		m_out.polygons.triangle.push_back( triangle );
	}

	void distribute( int axis, const Eigen::Vector3i& position, std::uint32_t triangle )
	{
		int lowest = m_items[0].level, highest = lowest;
		for ( const Item& item : m_items )
		{
			lowest = std::min( lowest, item.level );
			highest = std::max( highest, item.level );
		}
		std::vector<std::vector<Item>>& open = m_open;
		open.assign( 1, m_items );
		for ( int plane = lowest / 2 + 1; plane <= highest / 2; ++plane )
		{
			std::vector<std::vector<Item>> above;
			for ( const std::vector<Item>& polygon : open )
			{
				split( polygon, axis, plane, above );
				emit( m_below, axis, plane - 1, position, triangle );
			}
			open = std::move( above );
		}
		for ( const std::vector<Item>& polygon : open )
		{
			emit( polygon, axis, highest / 2, position, triangle );
		}
	}

	/// Each section of the outline above the plane becomes a polygon of its own, and a straight edge of the remaining polygon below.
	void split( const std::vector<Item>& items, int axis, int plane, std::vector<std::vector<Item>>& above )
	{
		const std::size_t count = items.size();
		m_below.clear();
		std::size_t start = 0;
		while ( start < count && items[start].level >= 2 * plane )
		{
			++start;
		}
		bool isAbove = false;
		for ( std::size_t k = 0; k < count; ++k )
		{
			const Item& item = items[( start + k ) % count];
			if ( item.level != 2 * plane )
			{
				( isAbove ? above.back() : m_below ).push_back( item );
			}
			else if ( !isAbove )
			{
				above.push_back( { item } );
				m_below.push_back( { item.point, planeTag( axis, true ), item.level } );
				isAbove = true;
			}
			else
			{
				above.back().push_back( { item.point, planeTag( axis, false ), item.level } );
				m_below.push_back( item );
				isAbove = false;
			}
		}
	}

	const ClipInput& m_input;
	ClippedSurface m_out;
	std::unordered_map<std::uint64_t, std::uint32_t> m_cut; ///< of this axis: first point on an edge; for lookup only
	std::vector<Item> m_items, m_below;
	std::vector<std::vector<Item>> m_open;
};

} // namespace

int ClippedSurface::positionOf( std::uint32_t p, int axis ) const
{
	return int( std::clamp( std::floor( point[p].bent[axis] ), 0.0, double( extent[axis] - 1 ) ) );
}

double longestBentEdge( const CrackSettings& settings )
{
	return std::min( kPiecesOfEdge / settings.subdivision, kWaveOfEdge * double( settings.noiseWavelength ) );
}

ClippedSurface clipSurface( const ClipInput& input )
{
	ClippedSurface out = SurfaceClipper( input ).run();
	for ( LineCrossing& lineCrossing : out.lineCrossing )
	{
		lineCrossing.at = out.positionOf( lineCrossing.point, lineCrossing.axis );
	}
	return out;
}

} // namespace pliant
