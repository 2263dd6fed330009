// Soft against soft: by the rows of both.

#include "world/constants.h"
#include "world/node_search.h"
#include "world/round_surface.h"
#include "world/soft_body_impl.h"

#include <algorithm>

namespace pliant {

namespace {

std::vector<FreshPair>::iterator findFresh( std::vector<FreshPair>& fresh, unsigned other )
{
	const auto found = std::lower_bound( fresh.begin(), fresh.end(), FreshPair{ other, 0.0 } );
	return found != fresh.end() && found->other == other ? found : fresh.end();
}

/// How deep the spheres of two bodies may overlap that came apart from each other; 0 for all others.
double slackOf( const SoftBody::Impl& a, const SoftBody::Impl& b )
{
	const auto pair = findFresh( a.fresh, b.serial );
	return pair == a.fresh.end() ? 0.0 : pair->slack;
}

void setSlack( const SoftBody::Impl& of, unsigned other, double slack )
{
	const auto pair = findFresh( of.fresh, other );
	if ( pair != of.fresh.end() )
	{
		pair->slack = slack;
		if ( slack == 0.0 )
		{
			of.fresh.erase( pair ); // they have parted
		}
	}
}

/// Further apart than their spheres, with the room that a contact is made ahead in, and what they move against each other, `way`, m. Bodies sweep what
/// their fastest nodes do: of the pairs that those might bring together most are so, and this is sooner said than where they would touch. `room`: how
/// much further their spheres may reach than the nodes' own.
bool staysApart( const SphereRows::Meeting& meeting, const Vec3& way, float room )
{
	const float farthest = meeting.reach + room + way.norm();
	return meeting.square > farthest * farthest;
}

/// Leaves those that do not stay apart.
void keepComing( std::vector<SphereRows::Meeting>& meetings, const NodeState& nodesA, const NodeState& nodesB, double step, float room )
{
	std::size_t kept = 0;
	for ( const SphereRows::Meeting& meeting : meetings )
	{
		meetings[kept] = meeting;
		const Vec3 way = float( step ) * ( nodesA.v.get( meeting.nodeA ) - nodesB.v.get( meeting.nodeB ) );
		kept += staysApart( meeting, way, room ) ? 0 : 1;
	}
	meetings.resize( kept );
}

} // namespace

std::vector<NodeHit>& NodeSearch::againstSoft( const SoftBody& a, const SoftBody& b, double step )
{
	const SoftBody::Impl& implA = a.impl();
	const SoftBody::Impl& implB = b.impl();
	const NodeShape &shapeA = *implA.shape, &shapeB = *implB.shape;
	const NodeState& nodesA = implA.body->nodes();
	const NodeState& nodesB = implB.body->nodes();
	m_soft = &a;
	m_step = step;
	m_hits.clear();
	const double slack = slackOf( implA, implB );
	const bool isRound = slack == 0.0 && meetRound( a, b );
	double deepest = 0.0;
	const Vec3d fromAToB = nodesA.origin - nodesB.origin; // adds to a position of A's to make it one of B's
	const btVector3 shapesApart = toBt( fromAToB + ( implA.shapeShift - implB.shapeShift ).cast<double>() );
	const btScalar room = isRound ? kRoundRoom * ( shapeA.largestRadius() + shapeB.largestRadius() ) : btScalar( 0 );
	const btVector3 around( room, room, room );
	const float farther = float( around.length() ); // as findPairs takes it: cells that are stretched have more room
	const btVector3 low = shapeA.sweepLow() - shapeB.sweepHigh() - around, high = shapeA.sweepHigh() - shapeB.sweepLow() + around;
	SphereRows::findPairs( shapeA.rows(), shapeB.rows(), SphereRows::Approach{ shapesApart, low, high }, m_pairs );
	keepComing( m_pairs.found, nodesA, nodesB, step, farther );
	for ( const SphereRows::Meeting& meeting : m_pairs.found )
	{
		const int nodeA = meeting.nodeA, nodeB = meeting.nodeB;
		const Vec3 speedA = nodesA.v.get( nodeA ), speedB = nodesB.v.get( nodeB );
		MovingSphere sphere;
		sphere.radius = double( shapeA.sphereOfNode( nodeA )->getRadius() );
		sphere.centre = nodesA.x.get( nodeA ).cast<double>();
		sphere.way = step * speedA.cast<double>() - step * speedB.cast<double>();
		Vec3d at = nodesB.x.get( nodeB ).cast<double>() - fromAToB;
		double radius = double( shapeB.sphereOfNode( nodeB )->getRadius() );
		const double own = sphere.radius;
		if ( isRound )
		{
			const RoundSphere one = roundSphere( a, nodeA, at - sphere.centre ), other = roundSphere( b, nodeB, sphere.centre - at );
			sphere.centre += one.inwards;
			sphere.radius += one.inwards.norm();
			at += other.inwards;
			radius += other.inwards.norm();
		}
		Touch touch;
		if ( findBallTouch( radius, at, sphere, touch ) )
		{
			touch.distance -= sphere.radius - own; // of the node's own sphere that would be as near
			sphere.radius = own;
			deepest = std::max( deepest, sphere.radius - touch.distance );
			touch.distance += slack;
			if ( slack > 0.0 && touch.distance > sphere.radius )
			{
				continue;
			}
			m_hits.push_back( NodeHit{ std::uint64_t( nodeA ) << 32 | std::uint32_t( nodeB ), touch, -1, nodeB } );
		}
	}
	if ( slack > 0.0 )
	{
		setSlack( implA, implB.serial, std::min( slack, deepest ) );
		setSlack( implB, implA.serial, std::min( slack, deepest ) );
	}
	giveLeave( a, &b );
	sortHits();
	return m_hits;
}

} // namespace pliant
