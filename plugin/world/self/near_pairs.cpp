#include "world/self/near_pairs.h"

#include "body/levels/levels.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

namespace {

/// Above this number of outdated nodes a grid search for all nodes is as fast as their single searches, for bodies of any size.
constexpr std::size_t kFewOutdated = 300;

constexpr float kNoSphere = -1.0f;

/// Slightly less than 1, against rounding error.
constexpr float kRoundingFactor = 0.999f;

} // namespace

float NearPairs::radiusOf( int node ) const
{
	const NodeShape& shape = *m_soft->impl().shape;
	return shape.childOfNode( node ) >= 0 ? float( shape.sphereOfNode( node )->getRadius() ) : kNoSphere;
}

// Several changes may precede the next step: the stored rows keep their numbers until then.
void NearPairs::renumber( const std::vector<std::uint32_t>& nodeNow )
{
	m_isRelinked = true;
	if ( nodeNow.empty() )
	{
		return;
	}
	if ( !m_isRenumbered )
	{
		m_newNumber.resize( m_records.size() );
		std::iota( m_newNumber.begin(), m_newNumber.end(), 0u );
		m_isRenumbered = true;
	}
	for ( std::uint32_t& now : m_newNumber )
	{
		now = now < nodeNow.size() ? nodeNow[now] : kNoNode; // not an index
	}
}

/// Converts records and pairs to the present numbers; rows are unchanged, with m_oldNumber and m_newNumber mapping between the two.
void NearPairs::applyNumbers()
{
	std::uint32_t count = 0;
	for ( const std::uint32_t now : m_newNumber )
	{
		count = now == kNoNode ? count : std::max( count, now + 1 );
	}
	m_oldNumber.assign( count, kNoNode );
	std::vector<Record> records( count, Record{ Vec3::Zero(), kNoSphere } );
	for ( std::uint32_t i = 0; i < std::uint32_t( m_newNumber.size() ); ++i )
	{
		if ( m_newNumber[i] != kNoNode )
		{
			records[m_newNumber[i]] = m_records[i];
			m_oldNumber[m_newNumber[i]] = i;
		}
	}
	m_records.swap( records );
	std::size_t kept = 0;
	for ( const std::uint64_t pair : m_pairs )
	{
		const std::uint32_t a = m_newNumber[pair >> 32], b = m_newNumber[pair & 0xffffffffu];
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
	if ( m_isRenumbered )
	{
		applyNumbers();
	}
	if ( margin != m_margin || int( m_records.size() ) > nodes.count )
	{
		m_records.clear();
		m_pairs.clear();
		m_margin = margin;
		m_isRelinked = true;
	}
	if ( m_isRelinked || int( m_records.size() ) != nodes.count )
	{
		follow( nodes );
	}
	measureMeanMotion( nodes );
	findOutdated( nodes );
	if ( !m_outdated.empty() )
	{
		update( nodes );
	}
	return m_pairs;
}

/// Mean displacement since the nodes' last searches, and mean velocity. With nodes that come and go a mean position would jump.
void NearPairs::measureMeanMotion( const NodeState& nodes )
{
	Vec3 displacement = Vec3::Zero(), velocity = Vec3::Zero();
	int known = 0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( const Record& record = m_records[std::size_t( i )]; record.radius >= 0.0f )
		{
			displacement += nodes.x.get( i ) - record.position;
			++known;
		}
		velocity += nodes.v.get( i );
	}
	m_meanDisplacement = known > 0 ? Vec3( displacement / float( known ) ) : Vec3( Vec3::Zero() );
	m_meanVelocity = velocity / float( nodes.count );
}

// A pair that was farther apart at its last search than its radii and the margin m cannot have met as long as
//   2 max | x - x_then | + min( m / 2, 2 h max | v - v_mean | ) <= m
// with positions relative to the mean motion: a body in flight does not count as moving. The second term is the approach within this step,
// of which at most half a margin is taken into account. The condition is tested per node: where both nodes of a pair satisfy it, each
// accounts for half of each sum.
void NearPairs::findOutdated( const NodeState& nodes )
{
	m_outdated.clear();
	m_isOutdated.assign( std::size_t( nodes.count ), 0 );
	const float farEnough = float( m_margin * m_margin / 16.0 ) * kRoundingFactor;
	for ( int i = 0; i < nodes.count; ++i )
	{
		Record& record = m_records[std::size_t( i )];
		bool isOutdated = record.radius == kNoSphere && m_soft->impl().shape->childOfNode( i ) >= 0;
		const Vec3 displacement = nodes.x.get( i ) - m_meanDisplacement - record.position;
		if ( record.radius >= 0.0f && displacement.squaredNorm() > farEnough ) // the approach takes half of the margin at most
		{
			const double moved = double( displacement.norm() ), closing = m_step * double( ( nodes.v.get( i ) - m_meanVelocity ).norm() );
			isOutdated = 2.0 * moved + std::min( m_margin / 2.0, 2.0 * closing ) > m_margin;
		}
		if ( isOutdated )
		{
			m_outdated.push_back( std::uint32_t( i ) );
			m_isOutdated[std::size_t( i )] = 1;
		}
	}
}

bool NearPairs::hasSameRow( std::uint32_t node ) const
{
	const std::vector<std::uint32_t>& start = *m_rowStart;
	const std::uint32_t old = m_isRenumbered ? m_oldNumber[node] : node;
	if ( old + 1 >= m_recordedStart.size() || start[node + 1] - start[node] != m_recordedStart[old + 1] - m_recordedStart[old] )
	{
		return false;
	}
	const auto now = m_rowTo->begin() + start[node], end = m_rowTo->begin() + start[node + 1],
			   then = m_recordedTo.begin() + m_recordedStart[old];
	// A removed neighbour makes it a different row.
	return m_isRenumbered ? std::equal( now, end, then, [this]( std::uint32_t a, std::uint32_t b ) { return a == m_newNumber[b]; } )
						  : std::equal( now, end, then );
}

// Whether two nodes are held together depends on their rows alone: only nodes whose row or sphere has changed need a new search.
void NearPairs::follow( const NodeState& nodes )
{
	m_isRelinked = false;
	m_records.resize( std::size_t( nodes.count ), Record{ Vec3::Zero(), kNoSphere } );
	for ( int i = 0; i < nodes.count; ++i )
	{
		Record& record = m_records[std::size_t( i )];
		if ( record.radius >= 0.0f && ( record.radius != radiusOf( i ) || !hasSameRow( std::uint32_t( i ) ) ) )
		{
			record.radius = kNoSphere;
		}
	}
	m_isRenumbered = false;
	m_recordedStart = *m_rowStart;
	m_recordedTo = *m_rowTo;
	const auto isGone = [this]( std::uint64_t pair ) {
		return m_records[pair >> 32].radius < 0.0f || m_records[pair & 0xffffffffu].radius < 0.0f;
	};
	m_pairs.erase( std::remove_if( m_pairs.begin(), m_pairs.end(), isGone ), m_pairs.end() );
}

void NearPairs::update( const NodeState& nodes )
{
	m_queryCount += (long long)( m_outdated.size() );
	m_spheres.clear();
	for ( const std::uint32_t node : m_outdated )
	{
		m_records[node] = Record{ nodes.x.get( int( node ) ) - m_meanDisplacement, radiusOf( int( node ) ) };
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( const Record& record = m_records[std::size_t( i )]; record.radius >= 0.0f )
		{
			m_spheres.push_back( { record.position, record.radius, std::uint32_t( i ) } );
		}
	}
	const ClosePairs::Held held{ *m_rowStart, *m_rowTo };
	if ( m_outdated.size() > kFewOutdated )
	{
		m_pairs.clear();
		m_close.find( m_spheres, float( kContactSlop ), float( m_margin ), &held, m_pairs );
	}
	else
	{
		const auto isOutdated = [this](
									std::uint64_t pair ) { return ( m_isOutdated[pair >> 32] | m_isOutdated[pair & 0xffffffffu] ) != 0; };
		m_pairs.erase( std::remove_if( m_pairs.begin(), m_pairs.end(), isOutdated ), m_pairs.end() );
		m_close.findOf( m_spheres, m_isOutdated, float( kContactSlop ), float( m_margin ), &held, m_pairs );
	}
	std::sort( m_pairs.begin(), m_pairs.end() );
}

} // namespace pliant
