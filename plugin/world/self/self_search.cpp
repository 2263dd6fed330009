#include "world/self/self_search.h"

#include "archive/archive.h"
#include "body/levels/levels.h"
#include "lattice/inside/inside_distance.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <algorithm>

namespace pliant {

namespace {

double radiusOf( const SoftBody::Impl& impl, int node )
{
	return double( impl.shape->sphereOfNode( node )->getRadius() );
}

} // namespace

void SelfSearch::relink( const CellsNow& cells )
{
	m_isListed = false;
	if ( !m_depth.empty() )
	{
		std::vector<std::uint32_t> depth;
		depth.reserve( cells.before.size() );
		for ( const std::uint32_t cell : cells.before )
		{
			depth.push_back( m_depth[cell] );
		}
		m_depth.swap( depth );
		if ( !updateInside( cells.lattice, cells.touched, m_depth ) )
		{
			m_depth.clear();
		}
	}
	m_slack.clear();
	m_isFirst = true;
}

void SelfSearch::renumber( const std::vector<std::uint32_t>& nodeNow )
{
	m_isListed = false;
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
	m_soft = &soft;
	m_body = soft.impl().body.get();
	m_step = step;
	m_rotation.clear();
	m_hits.clear();
	const VelocityBounds& velocities = m_body->velocities();
	const double margin = kNearMargin * double( soft.impl().shape->largestRadius() );
	const double closing = step * double( ( Vec3( velocities.high ) - Vec3( velocities.low ) ).norm() );
	// Half of the margin is for the approach within this step, so that one fast node does not make all others candidates.
	if ( !m_isListed || hasMoved( 0.5 * ( margin - std::min( closing, 0.5 * margin ) ) ) )
	{
		listPairs( margin );
	}
	for ( const std::uint64_t pair : m_pairs )
	{
		testPair( int( pair >> 32 ), int( pair & 0xffffffffu ) );
	}
	applySlack();
	return m_hits;
}

/// Whether a node has moved by more than `most`, m, since the pairs were listed, apart from the mean motion: a body in flight does not
/// count as moving.
bool SelfSearch::hasMoved( double most ) const
{
	const NodeState& nodes = m_body->nodes();
	Vec3 mean = Vec3::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		mean += nodes.x.get( i ) - m_listedAt.get( i );
	}
	mean /= float( nodes.count );
	float farthest = 0.0f;
	for ( int i = 0; i < nodes.count; ++i )
	{
		farthest = std::max( farthest, ( nodes.x.get( i ) - m_listedAt.get( i ) - mean ).squaredNorm() );
	}
	return double( farthest ) > most * most;
}

/// Lists the pairs of spheres that are no farther apart than the margin, m, ascending.
void SelfSearch::listPairs( double margin )
{
	m_isListed = true;
	m_listedAt = m_body->nodes().x;
	const SphereRows& rows = m_soft->impl().shape->rows();
	const btScalar most = btScalar( margin );
	const btVector3 approach( most, most, most );
	SphereRows::findPairs( rows, rows, SphereRows::Approach{ btVector3( 0, 0, 0 ), -approach, approach }, m_found );
	m_pairs.clear();
	for ( const SphereRows::NearSpheres& pair : m_found.found )
	{
		const double farthest = double( pair.reach ) + margin;
		if ( pair.nodeA < pair.nodeB && double( pair.squaredDistance ) <= farthest * farthest &&
			!areHeldTogether( pair.nodeA, pair.nodeB ) )
		{
			m_pairs.push_back( std::uint64_t( pair.nodeA ) << 32 | std::uint32_t( pair.nodeB ) );
		}
	}
	std::sort( m_pairs.begin(), m_pairs.end() );
}

/// Whether one region holds both nodes, or both are held with the same third node.
bool SelfSearch::areHeldTogether( int a, int b ) const
{
	const Levels* levels = m_body->levels();
	const std::vector<std::uint32_t>& start = levels ? levels->matrix().start : m_body->lattice().linkStart;
	const std::vector<std::uint32_t>& to = levels ? levels->matrix().member : m_body->lattice().linkTo;
	auto ofA = to.begin() + start[std::size_t( a )], ofB = to.begin() + start[std::size_t( b )];
	const auto endA = to.begin() + start[std::size_t( a ) + 1], endB = to.begin() + start[std::size_t( b ) + 1];
	bool isLinked = false; // most pairs are: without a branch
	std::for_each( ofA, endA, [&]( std::uint32_t other ) { isLinked |= other == std::uint32_t( b ); } );
	if ( isLinked )
	{
		return true;
	}
	while ( ofA != endA && ofB != endB && *ofA != *ofB ) // both rows ascend
	{
		*ofA < *ofB ? ++ofA : ++ofB;
	}
	return ofA != endA && ofB != endB;
}

void SelfSearch::testPair( int a, int b )
{
	const NodeState& nodes = m_body->nodes();
	const double radiusA = radiusOf( m_soft->impl(), a ), radii = radiusA + radiusOf( m_soft->impl(), b );
	const Vec3 apart = nodes.x.get( a ) - nodes.x.get( b ), displacement = float( m_step ) * ( nodes.v.get( a ) - nodes.v.get( b ) );
	const double reach = radii + kContactSlop * radiusA + double( displacement.norm() );
	if ( double( apart.squaredNorm() ) > reach * reach )
	{
		return;
	}
	NodeHit hit{ std::uint64_t( a ) << 32 | std::uint32_t( b ), touchOf( a, b, apart ), -1, b };
	// A pair closer at rest than the sum of its radii may stay that close.
	hit.touch.distance += std::max( 0.0, radii - double( ( nodes.x0.get( a ) - nodes.x0.get( b ) ).norm() ) );
	MovingSphere sphere;
	sphere.radius = radiusA;
	sphere.displacement = displacement.cast<double>();
	if ( sphere.reaches( hit.touch.normal, hit.touch.distance ) )
	{
		m_hits.push_back( hit );
	}
}

// The spheres' own normal, n = ( x_a - x_b ) / |x_a - x_b|, as long as it points out of b's material and into a's:
//   n . ( o_b - o_a ) >= 0
// Otherwise their sides have passed through one another, and the normal is along o_b - o_a; the depth is limited to one radius at a time.
Touch SelfSearch::touchOf( int a, int b, const Vec3& apart )
{
	const double radiusA = radiusOf( m_soft->impl(), a ), radiusB = radiusOf( m_soft->impl(), b );
	const Vec3d between = apart.cast<double>();
	const double length = between.norm();
	Touch touch;
	// Coincident centres have no direction; up is as good as any other and the same on every machine.
	touch.normal = length > 0.0 ? Vec3d( between / length ) : Vec3d::UnitY();
	touch.distance = length - radiusB;
	if ( touch.distance > radiusA )
	{
		return touch; // no touch yet
	}
	const Vec3d facing = ( outwardNow( b ) - outwardNow( a ) ).cast<double>();
	if ( facing.norm() > kLeastFacing && touch.normal.dot( facing ) < 0.0 && !faceAwayAtRest( a, b ) )
	{
		touch.normal = facing.normalized();
		touch.distance = touch.normal.dot( between ) - radiusB;
	}
	touch.distance = std::max( touch.distance, radiusA - std::min( radiusA, radiusB ) );
	return touch;
}

// Top and bottom of a plate that is crushed flat resemble sides that have passed through one another, but have not.
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
	return length > kLeastOutward ? Vec3( out / length ) : Vec3( Vec3::Zero() );
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

void SelfSearch::applySlack()
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
		else if ( depth > 0.0 )
		{
			hit.touch.distance += std::max(
				impl.allowance.allowedDepth( hit.node(), depth ), impl.allowance.allowedDepth( hit.other(), depth ) );
		}
	}
	m_slack.swap( m_slackNext );
	m_isFirst = false;
}

void SelfSearch::Slack::archive( Archive& archive )
{
	archive( key, depth );
}

void SelfSearch::archive( Archive& archive )
{
	archive( m_slack, m_isFirst );
	archive.require( std::is_sorted( m_slack.begin(), m_slack.end(), []( const Slack& a, const Slack& b ) { return a.key < b.key; } ),
		"The allowances of a body with itself are not in order." );
	if ( archive.isReading() )
	{
		m_isListed = false;
		m_depth.clear();
		m_rotation.clear();
	}
}

} // namespace pliant
