#include "surface/crack_shapes/bent_chain.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace pliant {

namespace {

double distanceToLine( const Vec3d& p, const Vec3d& from, const Vec3d& to )
{
	const Vec3d along = to - from;
	const double square = along.squaredNorm();
	const double fraction = square > 0.0 ? std::clamp( along.dot( p - from ) / square, 0.0, 1.0 ) : 0.0;
	return ( p - from - fraction * along ).norm();
}

void keepBetween(
	const std::vector<Vec3d>& chain, std::size_t first, std::size_t last, double tolerance, std::vector<std::uint8_t>& isKept )
{
	std::size_t farthest = first;
	double most = 0.0;
	for ( std::size_t k = first + 1; k < last; ++k )
	{
		const double distance = distanceToLine( chain[k], chain[first], chain[last] );
		if ( farthest == first || distance > most )
		{
			farthest = k;
			most = distance;
		}
	}
	if ( farthest != first && most >= tolerance )
	{
		isKept[farthest] = 1;
		keepBetween( chain, first, farthest, tolerance, isKept );
		keepBetween( chain, farthest, last, tolerance, isKept );
	}
}

/// The points of the cuts, each with its successor on its face.
class CutChains
{
public:
	CutChains( const ClippedSurface& surface, const std::vector<FaceEdge>& edges, std::vector<std::uint32_t>& merged ) :
		m_surface( surface ), m_merged( merged ), m_link( merged.size() )
	{
		for ( const std::uint32_t to : merged )
		{
			++m_link[to].members;
		}
		for ( const FaceEdge& edge : edges )
		{
			Link& from = m_link[merged[edge.from]];
			Link& to = m_link[merged[edge.to]];
			if ( &from != &to )
			{
				++from.leaving;
				++to.entering;
				from.next = merged[edge.to];
				from.faceOut = edge.face;
				to.faceIn = edge.face;
			}
		}
	}

	void simplify( const std::vector<FaceEdge>& edges, double tolerance )
	{
		m_representative.resize( m_merged.size() );
		std::iota( m_representative.begin(), m_representative.end(), 0u );
		for ( const FaceEdge& edge : edges )
		{
			const std::uint32_t from = m_merged[edge.from], to = m_merged[edge.to];
			if ( !isWithin( from ) && isWithin( to ) )
			{
				simplifyChain( from, to, tolerance );
			}
		}
		simplifyEdges();
		for ( std::uint32_t& p : m_merged )
		{
			p = m_representative[p];
		}
	}

private:
	struct Link
	{
		std::uint32_t members = 0, leaving = 0, entering = 0, next = 0;
		std::uint64_t faceOut = 0, faceIn = 0;
	};

	/// True for a point inside a triangle of the input that lies on one face and is merged with no other.
	bool isWithin( std::uint32_t p ) const
	{
		const Link& link = m_link[p];
		return link.members == 1 && link.leaving == 1 && link.entering == 1 && link.faceIn == link.faceOut &&
			m_surface.point[p].origin.vertex[2] != SurfaceOrigin::kNone;
	}

	void simplifyChain( std::uint32_t from, std::uint32_t to, double tolerance )
	{
		const auto& triangle = m_surface.point[to].origin.vertex;
		bool isOnOneTriangle = true;
		m_chain.assign( 1, from );
		for ( ; isWithin( to ); to = m_link[to].next )
		{
			isOnOneTriangle = isOnOneTriangle && m_surface.point[to].origin.vertex == triangle;
			m_chain.push_back( to );
		}
		if ( !isOnOneTriangle || to == from ) // a closed chain without other ends would shrink to one point
		{
			return;
		}
		m_chain.push_back( to );
		m_position.clear();
		for ( const std::uint32_t p : m_chain )
		{
			m_position.push_back( m_surface.point[p].rest );
		}
		const std::vector<std::uint8_t> isKept = keepBent( m_position, tolerance );
		for ( std::size_t k = 1; k + 1 < m_chain.size(); ++k )
		{
			m_representative[m_chain[k]] = isKept[k] != 0 ? m_chain[k] : m_representative[m_chain[k - 1]];
		}
	}

	/// Merges points that bisect an edge of the input and lie on no face.
	void simplifyEdges()
	{
		std::vector<std::uint32_t> onEdges;
		for ( std::uint32_t p = 0; p < std::uint32_t( m_merged.size() ); ++p )
		{
			const SurfaceOrigin& origin = m_surface.point[p].origin;
			if ( origin.vertex[1] != SurfaceOrigin::kNone && origin.vertex[2] == SurfaceOrigin::kNone )
			{
				onEdges.push_back( p );
			}
		}
		const auto order = [this]( std::uint32_t p ) {
			const SurfaceOrigin& origin = m_surface.point[p].origin;
			return std::make_tuple( origin.vertex[0], origin.vertex[1], origin.weight[1], p );
		};
		std::sort( onEdges.begin(), onEdges.end(), [&]( std::uint32_t a, std::uint32_t b ) { return order( a ) < order( b ); } );
		std::uint32_t before = SurfaceOrigin::kNone;
		for ( std::size_t k = 0; k < onEdges.size(); ++k )
		{
			const std::uint32_t p = onEdges[k];
			const auto& ends = m_surface.point[p].origin.vertex;
			before = k == 0 || m_surface.point[onEdges[k - 1]].origin.vertex != ends ? m_merged[ends[0]] : before;
			const Link& link = m_link[m_merged[p]];
			if ( link.members == 1 && link.leaving == 0 && link.entering == 0 )
			{
				m_representative[p] = before;
			}
			before = m_representative[m_merged[p]];
		}
	}

	const ClippedSurface& m_surface;
	std::vector<std::uint32_t>& m_merged;
	std::vector<Link> m_link;                    ///< by point
	std::vector<std::uint32_t> m_representative; ///< by point: the point it is merged with, or itself
	std::vector<std::uint32_t> m_chain;
	std::vector<Vec3d> m_position;
};

} // namespace

std::vector<std::uint8_t> keepBent( const std::vector<Vec3d>& chain, double tolerance )
{
	std::vector<std::uint8_t> isKept( chain.size(), 0 );
	isKept.front() = isKept.back() = 1;
	keepBetween( chain, 0, chain.size() - 1, tolerance, isKept );
	return isKept;
}

void simplifyCuts( const ClippedSurface& surface, const std::vector<FaceEdge>& edges, double tolerance, std::vector<std::uint32_t>& merged )
{
	CutChains( surface, edges, merged ).simplify( edges, tolerance );
}

} // namespace pliant
