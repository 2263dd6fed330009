#include "world/self_search.h"

#include "body/levels.h"
#include "lattice/inside_distance.h"
#include "world/constants.h"
#include "world/soft_body_impl.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

namespace {

double radiusOf( const SoftBody::Impl& impl, int node )
{
	return double( impl.shape->sphereOfNode( node )->getRadius() );
}

} // namespace

void SelfSearch::forget()
{
	m_placeThen.clear();
	m_depth.clear();
	m_slack.clear();
	m_isFirst = true;
}

void SelfSearch::renumber( const std::vector<std::uint32_t>& nodeNow )
{
	m_placeThen.clear();
	std::size_t kept = 0;
	for ( const Slack& slack : m_slack )
	{
		const std::uint32_t a = nodeNow[slack.key >> 32], b = nodeNow[slack.key & 0xffffffffu];
		if ( a != kNoNode && b != kNoNode )
		{
			m_slack[kept++] = Slack{ std::uint64_t( a ) << 32 | b, slack.depth };
		}
	}
	m_slack.resize( kept );
}

const std::vector<NodeHit>& SelfSearch::find( const SoftBody& soft, double step )
{
	const SoftBody::Impl& impl = soft.impl();
	m_soft = &soft;
	m_body = impl.body.get();
	m_step = step;
	const Levels* levels = m_body->levels();
	m_rowStart = levels ? &levels->matrix().start : &m_body->lattice().linkStart;
	m_rowTo = levels ? &levels->matrix().member : &m_body->lattice().linkTo;
	m_rotation.clear();
	m_hits.clear();
	if ( !mayUseNear() )
	{
		gatherNear();
	}
	for ( const std::uint64_t pair : m_near )
	{
		consider( int( pair >> 32 ), int( pair & 0xffffffffu ) );
	}
	giveSlack();
	return m_hits;
}

namespace {

Vec3 meanPlace( const NodeState& nodes )
{
	Vec3 sum = Vec3::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		sum += nodes.x.get( i );
	}
	return sum / float( nodes.count );
}

} // namespace

// Verlet's neighbour list. A pair further apart then than its radii and the margin has not met as long as
//   2 max | x - x_then | + min( m / 2, 2 h max | v - v_mean | ) <= m
// places relative to their mean: what flies along with all others stays where it is. The second term is what they come closer in this step;
// of what is faster than half a margin a step only that much is seen before.
bool SelfSearch::mayUseNear()
{
	const NodeState& nodes = m_body->nodes();
	if ( int( m_placeThen.size() ) != nodes.count )
	{
		return false;
	}
	const Vec3 mean = meanPlace( nodes );
	Vec3 drift = Vec3::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		drift += nodes.v.get( i );
	}
	drift /= float( nodes.count );
	float moved = 0.0f, fastest = 0.0f;
	for ( int i = 0; i < nodes.count; ++i )
	{
		moved = std::max( moved, ( nodes.x.get( i ) - mean - m_placeThen[std::size_t( i )] ).squaredNorm() );
		fastest = std::max( fastest, ( nodes.v.get( i ) - drift ).squaredNorm() );
	}
	const double closing = 2.0 * m_step * std::sqrt( double( fastest ) );
	return 2.0 * std::sqrt( double( moved ) ) + std::min( m_margin / 2.0, closing ) <= m_margin;
}

void SelfSearch::gatherNear()
{
	const NodeState& nodes = m_body->nodes();
	const NodeShape& shape = *m_soft->impl().shape;
	m_margin = kNearMargin * double( shape.largestRadius() );
	const Vec3 mean = meanPlace( nodes );
	m_placeThen.resize( std::size_t( nodes.count ) );
	for ( int i = 0; i < nodes.count; ++i )
	{
		m_placeThen[std::size_t( i )] = nodes.x.get( i ) - mean;
	}
	m_spheres.clear();
	for ( int node = 0; node < nodes.count; ++node )
	{
		if ( shape.childOfNode( node ) >= 0 )
		{
			m_spheres.push_back( { m_placeThen[std::size_t( node )], float( shape.sphereOfNode( node )->getRadius() ), std::uint32_t( node ) } );
		}
	}
	m_close.clear();
	m_pairs.find( m_spheres, float( kContactSlop ), float( m_margin ), m_close );
	keepFree();
}

// Of the close pairs, those that no region holds together, ascending: linked neither to one another nor to a third. Links go both ways: a third
// stands in both rows.
void SelfSearch::keepFree()
{
	const std::size_t count = m_placeThen.size();
	std::vector<std::uint32_t> start( count + 1, 0 ), other( m_close.size() );
	for ( const std::uint64_t pair : m_close )
	{
		++start[( pair >> 32 ) + 1];
	}
	std::partial_sum( start.begin(), start.end(), start.begin() );
	std::vector<std::uint32_t> next( start.begin(), start.end() - 1 );
	for ( const std::uint64_t pair : m_close )
	{
		other[next[pair >> 32]++] = std::uint32_t( pair );
	}
	m_near.clear();
	std::vector<std::uint32_t> owner( count, kNoNode ); // the last node in whose row each stood
	for ( std::uint32_t a = 0; a < std::uint32_t( count ); ++a )
	{
		for ( std::uint32_t k = ( *m_rowStart )[a]; start[a] < start[a + 1] && k < ( *m_rowStart )[a + 1]; ++k )
		{
			owner[( *m_rowTo )[k]] = a;
		}
		for ( std::uint32_t k = start[a]; k < start[a + 1]; ++k )
		{
			const std::uint32_t b = other[k];
			const auto first = m_rowTo->begin() + ( *m_rowStart )[b], last = m_rowTo->begin() + ( *m_rowStart )[b + 1];
			if ( owner[b] != a && std::none_of( first, last, [&owner, a]( std::uint32_t third ) { return owner[third] == a; } ) )
			{
				m_near.push_back( std::uint64_t( a ) << 32 | b );
			}
		}
	}
	std::sort( m_near.begin(), m_near.end() );
}

void SelfSearch::consider( int a, int b )
{
	const NodeState& nodes = m_body->nodes();
	const double radiusA = radiusOf( m_soft->impl(), a ), radii = radiusA + radiusOf( m_soft->impl(), b );
	const Vec3 apart = nodes.x.get( a ) - nodes.x.get( b ), way = float( m_step ) * ( nodes.v.get( a ) - nodes.v.get( b ) );
	const double reach = radii + kContactSlop * radiusA + double( way.norm() );
	if ( double( apart.squaredNorm() ) > reach * reach )
	{
		return;
	}
	NodeHit hit{ std::uint64_t( a ) << 32 | std::uint32_t( b ), touchOf( a, b, apart ), -1, b };
	// Closer at rest than their radii: that close they may be.
	hit.touch.distance += std::max( 0.0, radii - double( ( nodes.x0.get( a ) - nodes.x0.get( b ) ).norm() ) );
	MovingSphere sphere;
	sphere.radius = radiusA;
	sphere.way = way.cast<double>();
	if ( sphere.reaches( hit.touch.normal, hit.touch.distance ) )
	{
		m_hits.push_back( hit );
	}
}

// The spheres' own normal, n = ( x_a - x_b ) / |x_a - x_b|, as long as it leads out of b's material and into a's:
//   n . ( o_b - o_a ) >= 0
// Else their sides have gone through one another, and the way back is along o_b - o_a; no further than one radius at a time.
Touch SelfSearch::touchOf( int a, int b, const Vec3& apart )
{
	const double radiusA = radiusOf( m_soft->impl(), a ), radiusB = radiusOf( m_soft->impl(), b );
	const Vec3d between = apart.cast<double>();
	const double length = between.norm();
	Touch touch;
	// Two centres at one place have no direction; up is as good as any other and the same on every machine.
	touch.normal = length > 0.0 ? Vec3d( between / length ) : Vec3d::UnitY();
	touch.distance = length - radiusB;
	if ( touch.distance > radiusA )
	{
		return touch; // not yet
	}
	const Vec3d facing = ( outwardNow( b ) - outwardNow( a ) ).cast<double>();
	if ( facing.norm() > kFacing && touch.normal.dot( facing ) < 0.0 && !faceAwayAtRest( a, b ) )
	{
		touch.normal = facing.normalized();
		touch.distance = touch.normal.dot( between ) - radiusB;
	}
	touch.distance = std::max( touch.distance, radiusA - std::min( radiusA, radiusB ) );
	return touch;
}

// Top and bottom of a plate that is crushed flat look like sides that have gone through one another, and have not.
bool SelfSearch::faceAwayAtRest( int a, int b )
{
	const NodeState& nodes = m_body->nodes();
	const Vec3 apart = nodes.x0.get( a ) - nodes.x0.get( b );
	const double radii = radiusOf( m_soft->impl(), a ) + radiusOf( m_soft->impl(), b );
	return double( apart.norm() ) < kCrushedNodes * radii && apart.dot( outwardAtRest( b ) - outwardAtRest( a ) ) < 0.0f;
}

/// Unit length, or zero.
Vec3 SelfSearch::outwardAtRest( int node )
{
	const Lattice& lattice = m_body->lattice();
	if ( m_depth.empty() )
	{
		m_depth = floodInside( lattice );
	}
	Vec3 out = Vec3::Zero();
	if ( const Levels* levels = m_body->levels() )
	{
		const Octree& octree = levels->octree();
		const std::uint32_t above = levels->cut().node[std::size_t( node )];
		for ( std::uint32_t k = 0; k < octree.cellCount[above]; ++k )
		{
			out += outwardOf( lattice, m_depth, octree.cells[octree.cellStart[above] + k] );
		}
	}
	else
	{
		out = outwardOf( lattice, m_depth, std::uint32_t( node ) );
	}
	const float length = out.norm();
	return length > kNoSide ? Vec3( out / length ) : Vec3( Vec3::Zero() );
}

Vec3 SelfSearch::outwardNow( int node )
{
	if ( m_rotation.empty() )
	{
		m_rotation.resize( std::size_t( m_body->nodes().padded ) * 4 );
		m_body->nodeRotations( m_rotation.data() );
	}
	return Eigen::Map<const Eigen::Quaternionf>( m_rotation.data() + 4 * std::size_t( node ) ) * outwardAtRest( node );
}

void SelfSearch::giveSlack()
{
	const SoftBody::Impl& impl = m_soft->impl();
	m_slackNext.clear();
	auto known = m_slack.begin();
	for ( NodeHit& hit : m_hits )
	{
		while ( known != m_slack.end() && known->key < hit.key )
		{
			++known;
		}
		const bool isKnown = known != m_slack.end() && known->key == hit.key;
		const double depth = radiusOf( impl, hit.node() ) - hit.touch.distance;
		if ( depth > 0.0 && ( m_isFirst || isKnown ) )
		{
			m_slackNext.push_back( Slack{ hit.key, m_isFirst ? depth : std::min( depth, known->depth ) } );
			hit.touch.distance += m_slackNext.back().depth;
		}
	}
	m_slack.swap( m_slackNext );
	m_isFirst = false;
}

} // namespace pliant
