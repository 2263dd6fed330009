#include "world/near_pairs.h"

#include "body/levels.h"
#include "world/constants.h"
#include "world/soft_body_impl.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Where more nodes than this ask, all do, by a grid: that takes about as long as for so many to ask everybody, however large the body.
constexpr std::size_t kFewAsking = 300;

constexpr float kNoSphere = -1.0f;

/// A little less than 1, for rounding.
constexpr float kUnder = 0.999f;

} // namespace

float NearPairs::radiusOf( int node ) const
{
	const NodeShape& shape = *m_soft->impl().shape;
	return shape.childOfNode( node ) >= 0 ? float( shape.sphereOfNode( node )->getRadius() ) : kNoSphere;
}

void NearPairs::renumber( const std::vector<std::uint32_t>& nodeNow )
{
	m_isRelinked = true;
	if ( nodeNow.empty() )
	{
		return;
	}
	std::uint32_t count = 0;
	for ( const std::uint32_t now : nodeNow )
	{
		count = now == kNoNode ? count : std::max( count, now + 1 );
	}
	const std::size_t known = std::min( m_then.size(), nodeNow.size() );
	std::vector<std::uint32_t> before( count, kNoNode );
	for ( std::size_t i = 0; i < known; ++i )
	{
		if ( nodeNow[i] != kNoNode )
		{
			before[nodeNow[i]] = std::uint32_t( i );
		}
	}
	std::vector<Then> then( count, Then{ Vec3::Zero(), kNoSphere } );
	std::vector<std::uint32_t> start( 1, 0 ), to;
	to.reserve( m_toThen.size() );
	for ( std::uint32_t node = 0; node < count; ++node )
	{
		const std::uint32_t old = before[node];
		if ( old != kNoNode )
		{
			then[node] = m_then[old];
			for ( std::uint32_t k = m_startThen[old]; k < m_startThen[old + 1]; ++k )
			{
				const std::uint32_t other = m_toThen[k];
				to.push_back( other == kNoNode ? kNoNode : nodeNow[other] ); // one that is gone makes it another row
			}
		}
		start.push_back( std::uint32_t( to.size() ) );
	}
	m_then.swap( then );
	m_startThen.swap( start );
	m_toThen.swap( to );
	std::size_t kept = 0;
	for ( const std::uint64_t pair : m_pairs )
	{
		const std::uint32_t a = nodeNow[pair >> 32], b = nodeNow[pair & 0xffffffffu];
		if ( a != kNoNode && b != kNoNode )
		{
			m_pairs[kept++] = std::uint64_t( std::min( a, b ) ) << 32 | std::max( a, b );
		}
	}
	m_pairs.resize( kept );
	std::sort( m_pairs.begin(), m_pairs.end() ); // nodes need not keep their order
}

const std::vector<std::uint64_t>& NearPairs::of( const SoftBody& soft, double step )
{
	const Body& body = *soft.impl().body;
	const NodeState& nodes = body.nodes();
	const Levels* levels = body.levels();
	m_soft = &soft;
	m_step = step;
	m_rowStart = levels ? &levels->matrix().start : &body.lattice().linkStart;
	m_rowTo = levels ? &levels->matrix().member : &body.lattice().linkTo;
	const double margin = kNearMargin * double( soft.impl().shape->largestRadius() );
	m_mean = m_drift = Vec3::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		m_mean += nodes.x.get( i );
		m_drift += nodes.v.get( i );
	}
	m_mean /= float( nodes.count );
	m_drift /= float( nodes.count );
	if ( margin != m_margin || int( m_then.size() ) > nodes.count )
	{
		m_then.clear();
		m_pairs.clear();
		m_margin = margin;
		m_isRelinked = true;
	}
	if ( m_isRelinked || int( m_then.size() ) != nodes.count )
	{
		follow( nodes );
	}
	findAsking( nodes );
	if ( !m_asking.empty() )
	{
		ask( nodes );
	}
	return m_pairs;
}

// A pair further apart then than its radii and the margin has not met as long as
//   2 max | x - x_then | + min( m / 2, 2 h max | v - v_mean | ) <= m
// places relative to their mean: what flies along with all others stays where it is. The second term is what they come closer in this step;
// of what is faster than half a margin a step only that much is seen before. Each node is asked for its share: where it holds for both of a
// pair, half of each sum is each one's.
void NearPairs::findAsking( const NodeState& nodes )
{
	m_asking.clear();
	m_isAsking.assign( std::size_t( nodes.count ), 0 );
	const float farEnough = float( m_margin * m_margin / 16.0 ) * kUnder;
	for ( int i = 0; i < nodes.count; ++i )
	{
		Then& then = m_then[std::size_t( i )];
		bool asks = then.radius == kNoSphere && m_soft->impl().shape->childOfNode( i ) >= 0;
		const Vec3 way = nodes.x.get( i ) - m_mean - then.place;
		if ( then.radius >= 0.0f && way.squaredNorm() > farEnough ) // what closes in is half of the margin at most
		{
			const double moved = double( way.norm() ), closing = m_step * double( ( nodes.v.get( i ) - m_drift ).norm() );
			asks = 2.0 * moved + std::min( m_margin / 2.0, 2.0 * closing ) > m_margin;
		}
		if ( asks )
		{
			m_asking.push_back( std::uint32_t( i ) );
			m_isAsking[std::size_t( i )] = 1;
		}
	}
}

bool NearPairs::hasSameRow( std::uint32_t node ) const
{
	const auto now = m_rowTo->begin(), then = m_toThen.begin();
	const std::vector<std::uint32_t>& start = *m_rowStart;
	return node + 1 < m_startThen.size() && std::equal( now + start[node], now + start[node + 1], then + m_startThen[node], then + m_startThen[node + 1] );
}

// Whether two nodes are held together follows from their rows alone: only those whose own has changed need ask again, and those whose sphere has.
void NearPairs::follow( const NodeState& nodes )
{
	m_isRelinked = false;
	m_then.resize( std::size_t( nodes.count ), Then{ Vec3::Zero(), kNoSphere } );
	for ( int i = 0; i < nodes.count; ++i )
	{
		Then& then = m_then[std::size_t( i )];
		if ( then.radius >= 0.0f && ( then.radius != radiusOf( i ) || !hasSameRow( std::uint32_t( i ) ) ) )
		{
			then.radius = kNoSphere;
		}
	}
	m_startThen = *m_rowStart;
	m_toThen = *m_rowTo;
	const auto isGone = [this]( std::uint64_t pair ) { return m_then[pair >> 32].radius < 0.0f || m_then[pair & 0xffffffffu].radius < 0.0f; };
	m_pairs.erase( std::remove_if( m_pairs.begin(), m_pairs.end(), isGone ), m_pairs.end() );
}

void NearPairs::ask( const NodeState& nodes )
{
	m_asked += (long long)( m_asking.size() );
	m_spheres.clear();
	for ( const std::uint32_t node : m_asking )
	{
		m_then[node] = Then{ nodes.x.get( int( node ) ) - m_mean, radiusOf( int( node ) ) };
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( const Then& then = m_then[std::size_t( i )]; then.radius >= 0.0f )
		{
			m_spheres.push_back( { then.place, then.radius, std::uint32_t( i ) } );
		}
	}
	const ClosePairs::Held held{ *m_rowStart, *m_rowTo };
	if ( m_asking.size() > kFewAsking )
	{
		m_pairs.clear();
		m_close.find( m_spheres, float( kContactSlop ), float( m_margin ), &held, m_pairs );
	}
	else
	{
		const auto isAsking = [this]( std::uint64_t pair ) { return ( m_isAsking[pair >> 32] | m_isAsking[pair & 0xffffffffu] ) != 0; };
		m_pairs.erase( std::remove_if( m_pairs.begin(), m_pairs.end(), isAsking ), m_pairs.end() );
		m_close.findOf( m_spheres, m_isAsking, float( kContactSlop ), float( m_margin ), &held, m_pairs );
	}
	std::sort( m_pairs.begin(), m_pairs.end() );
}

} // namespace pliant
