// The surface crosses each line of the lattice into and out of the material; between crossings the line is entirely inside or outside. The
// border of a face consists of the cuts that the surface leaves on it and of the inside parts of its four sides. Where a cut ends on a
// side, such a part begins or ends, so the border closes without any geometric test.

#include "surface/crack_shapes/crack_faces.h"

#include "lattice/union_find.h"
#include "surface/constants.h"
#include "surface/crack_shapes/bent_chain.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>

namespace pliant {

namespace {

class LineWalker
{
public:
	LineWalker( ClippedSurface& surface, const NoiseWarp& warp, const CrackSettings& settings, std::vector<FaceEdge>& out ) :
		m_surface( surface ), m_warp( warp ), m_subdivision( settings.subdivision ), m_tolerance( double( settings.bendTolerance ) ),
		m_out( out )
	{}

	void run()
	{
		std::vector<LineCrossing>& all = m_surface.lineCrossing;
		const auto order = [this]( const LineCrossing& p ) {
			return std::make_tuple( p.axis, p.first, p.second, m_surface.point[p.point].bent[p.axis], p.point, p.sign );
		};
		std::sort( all.begin(), all.end(), [&]( const LineCrossing& a, const LineCrossing& b ) { return order( a ) < order( b ); } );
		m_winding = 0;
		for ( std::size_t k = 0; k + 1 < all.size(); ++k )
		{
			m_winding += all[k].sign;
			const bool isSameLine = all[k].axis == all[k + 1].axis && all[k].first == all[k + 1].first &&
				all[k].second == all[k + 1].second;
			if ( !isSameLine )
			{
				m_winding = 0; // outside again, unless the surface is open
			}
			else if ( m_winding != 0 )
			{
				walk( all[k], all[k + 1] );
			}
		}
	}

private:
	void walk( const LineCrossing& from, const LineCrossing& to )
	{
		std::uint32_t here = from.point;
		for ( int cell = from.at; cell <= to.at; ++cell )
		{
			const std::uint32_t end = cell < to.at ? corner( from, cell + 1 ) : to.point;
			walkInCell( from, cell, here, end );
			here = end;
		}
	}

	/// The choice of points depends on the line alone, so the four faces around it agree.
	void walkInCell( const LineCrossing& line, int cell, std::uint32_t from, std::uint32_t to )
	{
		const double spacing = 1.0 / m_subdivision;
		const double low = m_surface.point[from].bent[line.axis], high = m_surface.point[to].bent[line.axis];
		m_between.clear();
		m_chain = { m_surface.point[from].rest };
		for ( int k = 1; k < m_subdivision; ++k )
		{
			const double at = cell + k * spacing;
			if ( at > low + kRefineSpacing * spacing && at < high - kRefineSpacing * spacing )
			{
				m_between.push_back( pointAt( line, at ) );
				m_chain.push_back( m_between.back().rest );
			}
		}
		m_chain.push_back( m_surface.point[to].rest );
		const std::vector<std::uint8_t> isKept = keepBent( m_chain, m_tolerance );
		std::uint32_t here = from;
		for ( std::size_t k = 0; k < m_between.size(); ++k )
		{
			if ( isKept[k + 1] != 0 )
			{
				const std::uint32_t made = add( m_between[k] );
				addEdges( line, cell, here, made );
				here = made;
			}
		}
		addEdges( line, cell, here, to );
	}

	ClipPoint pointAt( const LineCrossing& line, double at ) const
	{
		ClipPoint made;
		made.bent[line.axis] = at;
		made.bent[( line.axis + 1 ) % 3] = line.first;
		made.bent[( line.axis + 2 ) % 3] = line.second;
		made.rest = m_warp.backward( made.bent );
		return made;
	}

	std::uint32_t add( const ClipPoint& made )
	{
		m_surface.point.push_back( made );
		return std::uint32_t( m_surface.point.size() - 1 );
	}

	/// The lattice's corner on a line, shared by the three lines that meet there.
	std::uint32_t corner( const LineCrossing& line, int at )
	{
		Eigen::Vector3i plane;
		plane[line.axis] = at;
		plane[( line.axis + 1 ) % 3] = line.first;
		plane[( line.axis + 2 ) % 3] = line.second;
		const auto [entry, isNew] = m_corner.try_emplace( positionKey( m_surface.extent, plane ), 0u );
		if ( isNew )
		{
			entry->second = add( pointAt( line, at ) );
			m_surface.insideCorner.emplace_back( plane, entry->second );
		}
		return entry->second;
	}

	/// Adds an inside part of a line to the four faces around it, in each directed so that the material is on its left.
	void addEdges( const LineCrossing& line, int cell, std::uint32_t from, std::uint32_t to )
	{
		const int b = ( line.axis + 1 ) % 3, c = ( line.axis + 2 ) % 3;
		for ( int side = 0; side < 4; ++side )
		{
			const bool isFirst = side < 2;      // on the plane normal to b, else on the plane normal to c
			const bool isUpper = side % 2 == 0; // the line is the upper side of that face
			Eigen::Vector3i position;
			position[line.axis] = cell;
			position[b] = line.first - ( isFirst || isUpper ? 1 : 0 );
			position[c] = line.second - ( !isFirst || isUpper ? 1 : 0 );
			const int axis = isFirst ? b : c;
			const bool isUp = isFirst == isUpper;
			const std::uint64_t face = 3 * positionKey( m_surface.extent, position ) + std::uint64_t( axis );
			for ( int k = 0; k < std::abs( m_winding ); ++k )
			{
				m_out.push_back( isUp == ( m_winding > 0 ) ? FaceEdge{ face, from, to } : FaceEdge{ face, to, from } );
			}
		}
	}

	ClippedSurface& m_surface;
	const NoiseWarp& m_warp;
	int m_subdivision;
	double m_tolerance;
	std::vector<FaceEdge>& m_out;
	std::unordered_map<std::uint64_t, std::uint32_t> m_corner; ///< for lookup only
	int m_winding = 0;
	std::vector<ClipPoint> m_between;
	std::vector<Vec3d> m_chain;
};

/// Adds the edges of pieces of surface that lie on the upper plane of their position, reversed.
void addCuts( const ClippedSurface& surface, std::vector<FaceEdge>& out )
{
	const ClipPolygons& polygons = surface.polygons;
	for ( std::size_t p = 0; p < polygons.count(); ++p )
	{
		const std::uint32_t first = polygons.start[p], last = polygons.start[p + 1];
		for ( std::uint32_t c = first; c < last; ++c )
		{
			for ( int axis = 0; axis < 3; ++axis )
			{
				if ( polygons.plane[c] == planeTag( axis, true ) )
				{
					const std::uint64_t face = 3 * positionKey( surface.extent, polygons.position[p] ) + std::uint64_t( axis );
					out.push_back( { face, polygons.point[c + 1 < last ? c + 1 : first], polygons.point[c] } );
				}
			}
		}
	}
}

} // namespace

std::uint64_t positionKey( const Eigen::Vector3i& extent, const Eigen::Vector3i& position )
{
	const Eigen::Matrix<std::uint64_t, 3, 1> n = extent.cast<std::uint64_t>(), p = position.cast<std::uint64_t>();
	return ( p.z() * n.y() + p.y() ) * n.x() + p.x();
}

Eigen::Vector3i positionOfKey( const Eigen::Vector3i& extent, std::uint64_t key )
{
	const Eigen::Matrix<std::uint64_t, 3, 1> n = extent.cast<std::uint64_t>();
	return { int( key % n.x() ), int( key / n.x() % n.y() ), int( key / n.x() / n.y() ) };
}

std::vector<FaceEdge> makeFaceEdges( ClippedSurface& surface, const NoiseWarp& warp, const CrackSettings& settings )
{
	std::vector<FaceEdge> edges;
	addCuts( surface, edges );
	LineWalker( surface, warp, settings, edges ).run();
	std::sort( edges.begin(), edges.end(),
		[]( const FaceEdge& a, const FaceEdge& b ) { return std::tie( a.face, a.from, a.to ) < std::tie( b.face, b.from, b.to ); } );
	return edges;
}

std::vector<std::uint32_t> mergeClosePoints( const ClippedSurface& surface, const std::vector<FaceEdge>& edges )
{
	UnionFind sets( surface.point.size() );
	// Vertices of the input have the lowest indices, so they become the representatives of their sets.
	const auto join = [&]( std::uint32_t a, std::uint32_t b ) {
		a = sets.find( a );
		b = sets.find( b );
		const bool isNear = ( surface.point[a].bent - surface.point[b].bent ).squaredNorm() < kCrackMergeDistance * kCrackMergeDistance;
		if ( a != b && isNear && !( surface.point[a].origin.isInput() && surface.point[b].origin.isInput() ) )
		{
			sets.join( a, b );
		}
	};
	const ClipPolygons& polygons = surface.polygons;
	for ( std::size_t p = 0; p < polygons.count(); ++p )
	{
		for ( std::uint32_t c = polygons.start[p], last = polygons.start[p + 1]; c < last; ++c )
		{
			join( polygons.point[c], polygons.point[c + 1 < last ? c + 1 : polygons.start[p]] );
		}
	}
	for ( const FaceEdge& edge : edges )
	{
		join( edge.from, edge.to );
	}
	std::vector<std::uint32_t> merged( surface.point.size() );
	for ( std::size_t i = 0; i < merged.size(); ++i )
	{
		merged[i] = sets.find( std::uint32_t( i ) );
	}
	return merged;
}

FaceParts traceFaces( const ClippedSurface& surface, const std::vector<FaceEdge>& edges, const std::vector<std::uint32_t>& merged )
{
	FaceParts out;
	std::vector<OutlineEdge> border;
	Loops loops;
	std::vector<Vec2d> at;
	for ( std::size_t first = 0, last = 0; first < edges.size(); first = last )
	{
		const std::uint64_t face = edges[first].face;
		border.clear();
		for ( ; last < edges.size() && edges[last].face == face; ++last )
		{
			border.emplace_back( merged[edges[last].from], merged[edges[last].to] );
		}
		loops.clear();
		if ( !traceLoops( border, loops ) )
		{
			out.broken.push_back( face );
			continue;
		}
		const int axis = int( face % 3 );
		at.clear();
		for ( const std::uint32_t p : loops.point )
		{
			const Vec3d& bent = surface.point[p].bent;
			at.emplace_back( bent[( axis + 1 ) % 3], bent[( axis + 2 ) % 3] );
		}
		for ( const OutlinePart& part : groupLoops( loops, at ) )
		{
			const std::uint32_t firstLoop = std::uint32_t( out.loops.count() );
			const auto copy = [&]( std::uint32_t loop ) {
				for ( std::uint32_t k = loops.start[loop]; k < loops.start[loop + 1]; ++k )
				{
					out.loops.point.push_back( loops.point[k] );
					out.at.push_back( at[k] );
				}
				out.loops.close();
			};
			copy( part.outer );
			std::for_each( part.holes.begin(), part.holes.end(), copy );
			out.part.push_back( { face / 3, axis, firstLoop, std::uint32_t( out.loops.count() ) } );
		}
	}
	return out;
}

} // namespace pliant
