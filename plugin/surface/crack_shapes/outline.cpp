#include "surface/crack_shapes/outline.h"

#include "surface/constants.h"

#include <algorithm>
#include <limits>

namespace pliant {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Compares the ends of edges regardless of direction.
bool isSameEdge( const OutlineEdge& a, const OutlineEdge& b )
{
	return std::minmax( a.first, a.second ) == std::minmax( b.first, b.second );
}

void cancelOpposites( std::vector<OutlineEdge>& edges )
{
	std::sort( edges.begin(), edges.end(), []( const OutlineEdge& a, const OutlineEdge& b ) {
		const auto p = std::minmax( a.first, a.second ), q = std::minmax( b.first, b.second );
		return p != q ? p < q : a.first < b.first;
	} );
	std::size_t kept = 0;
	for ( std::size_t first = 0, last = 0; first < edges.size(); first = last )
	{
		const OutlineEdge edge = edges[first];
		int balance = 0;
		for ( ; last < edges.size() && isSameEdge( edges[last], edge ); ++last )
		{
			balance += edges[last].first < edges[last].second ? 1 : -1;
		}
		const auto ends = std::minmax( edge.first, edge.second );
		const OutlineEdge remaining = balance > 0 ? OutlineEdge( ends.first, ends.second ) : OutlineEdge( ends.second, ends.first );
		for ( int k = 0; k < std::abs( balance ) && edge.first != edge.second; ++k )
		{
			edges[kept++] = remaining;
		}
	}
	edges.resize( kept );
}

/// True for a point in the triangle or on its border.
bool isWithin( const std::array<Vec2d, 3>& t, const Vec2d& p )
{
	return doubleArea( t[0], t[1], p ) >= 0.0 && doubleArea( t[1], t[2], p ) >= 0.0 && doubleArea( t[2], t[0], p ) >= 0.0;
}

/// Shape quality: 0 for a flat triangle, 1 for an equilateral one.
double shapeOf( const std::array<Vec2d, 3>& t )
{
	const double longest = std::max( { ( t[1] - t[0] ).squaredNorm(), ( t[2] - t[1] ).squaredNorm(), ( t[0] - t[2] ).squaredNorm() } );
	constexpr double kEqualSides = 1.1547005383792515; // 2 / sqrt( 3 )
	return longest > 0.0 ? kEqualSides * doubleArea( t[0], t[1], t[2] ) / longest : 0.0;
}

bool isCrossing( const Vec2d& a, const Vec2d& b, const Vec2d& p, const Vec2d& q )
{
	const double ap = doubleArea( a, b, p ), aq = doubleArea( a, b, q ), pa = doubleArea( p, q, a ), pb = doubleArea( p, q, b );
	return ( ap > 0.0 ) != ( aq > 0.0 ) && ( pa > 0.0 ) != ( pb > 0.0 );
}

/// The outline of one part as a single ring of entries: each hole is joined by a bridge that is passed in both directions.
class Ring
{
public:
	Ring( const Loops& loops, const std::vector<Vec2d>& at, const OutlinePart& part ) : m_loops( loops ), m_at( at )
	{
		m_entry = entriesOf( part.outer );
		std::vector<std::uint32_t> holes = part.holes;
		while ( !holes.empty() )
		{
			bridgeNearest( holes );
		}
	}

	std::vector<std::uint32_t> m_entry;

private:
	std::vector<std::uint32_t> entriesOf( std::uint32_t loop ) const
	{
		std::vector<std::uint32_t> entries;
		for ( std::uint32_t k = m_loops.start[loop]; k < m_loops.start[loop + 1]; ++k )
		{
			entries.push_back( k );
		}
		return entries;
	}

	bool isFree( const Vec2d& a, const Vec2d& b, const std::vector<std::uint32_t>& ring ) const
	{
		for ( std::size_t k = 0; k < ring.size(); ++k )
		{
			const Vec2d& p = m_at[ring[k]];
			const Vec2d& q = m_at[ring[( k + 1 ) % ring.size()]];
			const bool isEnd = p == a || p == b || q == a || q == b;
			if ( !isEnd && isCrossing( a, b, p, q ) )
			{
				return false;
			}
		}
		return true;
	}

	void bridgeNearest( std::vector<std::uint32_t>& holes )
	{
		double best[2] = { kFar, kFar }; // of bridges that cross nothing; of any bridge
		std::array<std::size_t, 3> found[2]{};
		for ( std::size_t h = 0; h < holes.size(); ++h )
		{
			const std::vector<std::uint32_t> hole = entriesOf( holes[h] );
			for ( std::size_t j = 0; j < hole.size(); ++j )
			{
				for ( std::size_t i = 0; i < m_entry.size(); ++i )
				{
					const Vec2d& a = m_at[m_entry[i]];
					const Vec2d& b = m_at[hole[j]];
					const double distance = ( a - b ).squaredNorm();
					if ( distance < best[1] )
					{
						best[1] = distance;
						found[1] = { h, i, j };
					}
					if ( distance < best[0] && isFree( a, b, m_entry ) && isFree( a, b, hole ) )
					{
						best[0] = distance;
						found[0] = { h, i, j };
					}
				}
			}
		}
		const auto [h, i, j] = found[best[0] < kFar ? 0 : 1];
		const std::vector<std::uint32_t> hole = entriesOf( holes[h] );
		std::vector<std::uint32_t> bridged( m_entry.begin(), m_entry.begin() + std::ptrdiff_t( i ) + 1 );
		for ( std::size_t k = 0; k <= hole.size(); ++k )
		{
			bridged.push_back( hole[( j + k ) % hole.size()] );
		}
		bridged.insert( bridged.end(), m_entry.begin() + std::ptrdiff_t( i ), m_entry.end() );
		m_entry = std::move( bridged );
		holes.erase( holes.begin() + std::ptrdiff_t( h ) );
	}

	const Loops& m_loops;
	const std::vector<Vec2d>& m_at;
};

} // namespace

void Loops::clear()
{
	start.assign( 1, 0 );
	point.clear();
}

bool traceLoops( std::vector<OutlineEdge>& edges, Loops& out )
{
	cancelOpposites( edges );
	std::sort( edges.begin(), edges.end() );
	std::vector<std::uint8_t> isUsed( edges.size(), 0 );
	const auto leaving = [&]( std::uint32_t from ) {
		auto e = std::lower_bound( edges.begin(), edges.end(), OutlineEdge( from, 0 ) );
		while ( e != edges.end() && e->first == from && isUsed[std::size_t( e - edges.begin() )] )
		{
			++e;
		}
		return e != edges.end() && e->first == from ? std::size_t( e - edges.begin() ) : edges.size();
	};
	bool isWhole = true;
	std::vector<std::uint32_t> path;
	for ( std::size_t seed = 0; seed < edges.size(); ++seed )
	{
		path.clear();
		std::uint32_t here = edges[seed].first;
		for ( std::size_t e = isUsed[seed] ? edges.size() : seed; e < edges.size(); e = leaving( here ) )
		{
			isUsed[e] = 1;
			path.push_back( here );
			here = edges[e].second;
			const auto met = std::find( path.begin(), path.end(), here );
			if ( met != path.end() )
			{
				out.point.insert( out.point.end(), met, path.end() );
				out.close();
				path.erase( met, path.end() );
			}
		}
		isWhole = isWhole && path.empty();
	}
	return isWhole;
}

double loopArea( const Loops& loops, const std::vector<Vec2d>& at, std::size_t loop )
{
	const std::size_t first = loops.start[loop], last = loops.start[loop + 1];
	double sum = 0.0;
	for ( std::size_t k = first + 1; k + 1 < last; ++k )
	{
		sum += doubleArea( at[first], at[k], at[k + 1] );
	}
	return 0.5 * sum;
}

namespace {

bool isInLoop( const Loops& loops, const std::vector<Vec2d>& at, std::size_t loop, const Vec2d& p )
{
	bool isIn = false;
	const std::size_t first = loops.start[loop], last = loops.start[loop + 1];
	for ( std::size_t k = first, before = last - 1; k < last; before = k++ )
	{
		const Vec2d& a = at[before];
		const Vec2d& b = at[k];
		if ( ( a.y() > p.y() ) != ( b.y() > p.y() ) && ( doubleArea( a, b, p ) > 0.0 ) == ( b.y() > a.y() ) )
		{
			isIn = !isIn;
		}
	}
	return isIn;
}

} // namespace

std::vector<OutlinePart> groupLoops( const Loops& loops, const std::vector<Vec2d>& at )
{
	std::vector<OutlinePart> parts;
	std::vector<double> area( loops.count() );
	for ( std::size_t i = 0; i < loops.count(); ++i )
	{
		area[i] = loopArea( loops, at, i );
		if ( area[i] >= 0.0 )
		{
			parts.push_back( { std::uint32_t( i ), {} } );
		}
	}
	const std::size_t outers = parts.size();
	for ( std::size_t i = 0; i < loops.count(); ++i )
	{
		if ( area[i] >= 0.0 )
		{
			continue;
		}
		// The midpoint of an edge is tested, because corners may lie on the outer loop.
		const Vec2d middle = 0.5 * ( at[loops.start[i]] + at[loops.start[i] + 1] );
		std::size_t holder = outers;
		for ( std::size_t k = 0; k < outers; ++k )
		{
			const bool isSmaller = holder == outers || area[parts[k].outer] < area[parts[holder].outer];
			if ( area[parts[k].outer] > -area[i] && isSmaller && isInLoop( loops, at, parts[k].outer, middle ) )
			{
				holder = k;
			}
		}
		if ( holder < outers )
		{
			parts[holder].holes.push_back( std::uint32_t( i ) );
		}
		else
		{
			parts.push_back( { std::uint32_t( i ), {} } ); // a loop of rounding size, or a surface that intersects itself
		}
	}
	return parts;
}

namespace {

/// Quality of the ear at k. Flat ears are worse than any other ear and better than corners that are no ear.
double earAt( const std::vector<std::uint32_t>& ring, std::size_t k, const std::vector<Vec2d>& at )
{
	const std::size_t count = ring.size();
	const auto corner = [&]( std::size_t i ) -> const Vec2d& { return at[ring[i % count]]; };
	const std::array<Vec2d, 3> t = { corner( k + count - 1 ), corner( k ), corner( k + 1 ) };
	const double shape = shapeOf( t );
	for ( std::size_t m = 2; m + 1 < count && shape > 0.0; ++m )
	{
		const Vec2d& p = corner( k + m );
		if ( p != t[0] && p != t[1] && p != t[2] && isWithin( t, p ) )
		{
			return shape + kNoEar;
		}
	}
	return shape;
}

} // namespace

void triangulate( const Loops& loops, const std::vector<Vec2d>& at, const OutlinePart& part, std::vector<std::array<std::uint32_t, 3>>& out,
	const EdgeTest& isUnwanted )
{
	std::vector<std::uint32_t> ring = std::move( Ring( loops, at, part ).m_entry );
	std::vector<double> ear( ring.size() );
	const auto measure = [&]( std::size_t k ) {
		const std::size_t count = ring.size();
		ear[k] = earAt( ring, k, at );
		if ( ear[k] > 0.0 && isUnwanted && isUnwanted( ring[( k + count - 1 ) % count], ring[( k + 1 ) % count] ) )
		{
			ear[k] *= kUnwantedEar;
		}
	};
	for ( std::size_t k = 0; k < ring.size() && ring.size() > 3; ++k )
	{
		measure( k );
	}
	while ( ring.size() > 3 )
	{
		const std::size_t best = std::size_t( std::max_element( ear.begin(), ear.end() ) - ear.begin() );
		out.push_back( { ring[( best + ring.size() - 1 ) % ring.size()], ring[best], ring[( best + 1 ) % ring.size()] } );
		ring.erase( ring.begin() + std::ptrdiff_t( best ) );
		ear.erase( ear.begin() + std::ptrdiff_t( best ) );
		// Removing an ear changes only its neighbours and corners that were blocked by its tip.
		for ( std::size_t k = 0; k < ring.size(); ++k )
		{
			const bool isNeighbour = k == best % ring.size() || k == ( best + ring.size() - 1 ) % ring.size();
			if ( isNeighbour || ear[k] <= 0.0 )
			{
				measure( k );
			}
		}
	}
	if ( ring.size() == 3 )
	{
		out.push_back( { ring[0], ring[1], ring[2] } );
	}
}

} // namespace pliant
