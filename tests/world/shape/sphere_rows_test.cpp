// Searches by rows of spheres find the same as a test of every sphere.

#include "world/levels/adaptive_bodies.h"
#include "world/test_world.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/search/node_search.h"
#include "world/touch/round_surface.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <algorithm>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace pliant::test {
namespace {

constexpr double kSubstep = 1.0 / 240;

double uniform( std::mt19937& random, double low, double high )
{
	return low + ( high - low ) * double( random() % 10000 ) / 1e4;
}

/// Moves nodes at random within `by` and gives them speeds up to `speed`.
void shake( SoftBody& soft, std::mt19937& random, double by, double speed )
{
	SoftBody::Impl& impl = soft.impl();
	NodeState& nodes = impl.body->nodes();
	Vec3 low = Vec3::Zero(), high = Vec3::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 aside( float( uniform( random, -by, by ) ), float( uniform( random, -by, by ) ), float( uniform( random, -by, by ) ) );
		const Vec3 v( float( uniform( random, -speed, speed ) ), float( uniform( random, -speed, speed ) ),
			float( uniform( random, -speed, speed ) ) );
		nodes.x.set( i, nodes.x.get( i ) + aside );
		nodes.v.set( i, v );
		low = low.cwiseMin( v );
		high = high.cwiseMax( v );
	}
	impl.shape->place( nodes, impl.shapeShift );
	impl.shape->setSweep( toBt( kSubstep * low.cast<double>() ), toBt( kSubstep * high.cast<double>() ) );
}

/// Returns a node's position in the shape's own coordinates.
Vec3 positionOf( const SoftBody& soft, int node )
{
	return soft.impl().body->nodes().x.get( node ) - soft.impl().shapeShift;
}

float reachOf( const SoftBody& soft, int node )
{
	return float( soft.impl().shape->sphereOfNode( node )->getRadius() * ( 1 + kContactSlop ) );
}

/// On one level, and on three with nodes split at random.
class SphereRowsOf : public testing::TestWithParam<int>
{
protected:
	SphereRowsOf()
	{
		const int coarse = GetParam();
		for ( int k = 0; k < 2; ++k )
		{
			soft[k] = test.addSoft( block( 9, 7, 6 + k, 0.1f ), at( 0, btScalar( 0.72 * k ), 0 ), stiff( 1e5f ), levels( coarse ) );
			for ( int round = 0; coarse > 0 && round < 2; ++round )
			{
				std::vector<std::uint32_t> split = coarseNodes( *soft[k], anyNode );
				split.erase(
					std::remove_if( split.begin(), split.end(), [this]( std::uint32_t ) { return random() % 3 == 0; } ), split.end() );
				changeLevels( *soft[k], split, {} );
			}
		}
	}

	TestWorld test;
	std::mt19937 random{ 11 };
	SoftBody* soft[2] = { nullptr, nullptr };
};

TEST_P( SphereRowsOf, ABodyFindTheSpheresThatMeetABox )
{
	std::size_t all = 0;
	for ( int round = 0; round < 200; ++round )
	{
		shake( *soft[0], random, 0.01, 0.0 );
		SphereRows::Box box{};
		for ( int axis = 0; axis < 3; ++axis )
		{
			const double one = uniform( random, -0.6, 0.6 ), other = uniform( random, -0.6, 0.6 );
			box.low[axis] = float( std::min( one, other ) );
			box.high[axis] = float( std::max( one, other ) );
		}
		std::vector<int> found, expected;
		soft[0]->impl().shape->rows().visitOverlaps( box, [&found]( int node ) { found.push_back( node ); } );
		for ( int node = 0; node < soft[0]->nodeCount(); ++node )
		{
			const Vec3 x = positionOf( *soft[0], node );
			const float reach = reachOf( *soft[0], node );
			bool meets = soft[0]->impl().shape->childOfNode( node ) >= 0;
			for ( int axis = 0; axis < 3; ++axis )
			{
				meets = meets && x[axis] - reach <= box.high[axis] && x[axis] + reach >= box.low[axis];
			}
			if ( meets )
			{
				expected.push_back( node );
			}
		}
		std::sort( found.begin(), found.end() );
		ASSERT_EQ( found, expected );
		all += found.size();
	}
	EXPECT_GT( all, 2000U );
}

TEST_P( SphereRowsOf, TwoBodiesFindThePairsThatMayTouch )
{
	SphereRows::Pairs pairs;
	std::size_t all = 0;
	for ( int round = 0; round < 20; ++round )
	{
		shake( *soft[0], random, 0.01, 0.0 );
		shake( *soft[1], random, 0.01, 0.0 );
		const double fast = round % 2 == 0 ? 0.0 : 0.05;
		const btVector3 displacement(
			btScalar( uniform( random, 0, fast ) ), btScalar( uniform( random, 0, fast ) ), btScalar( uniform( random, 0, fast ) ) );
		const SphereRows::Approach approach{
			btVector3( btScalar( uniform( random, -0.3, 0.3 ) ), btScalar( uniform( random, -0.75, -0.6 ) ), 0 ), -displacement,
			displacement };
		std::vector<std::pair<int, int>> found;
		SphereRows::findPairs( soft[0]->impl().shape->rows(), soft[1]->impl().shape->rows(), approach, pairs );
		for ( const SphereRows::NearSpheres& pair : pairs.found )
		{
			const Vec3 apart = positionOf( *soft[0], pair.nodeA ) + toVec3( approach.shift ) - positionOf( *soft[1], pair.nodeB );
			ASSERT_NEAR( pair.squaredDistance, apart.squaredNorm(), 1e-6f );
			ASSERT_EQ( pair.reach, reachOf( *soft[0], pair.nodeA ) + reachOf( *soft[1], pair.nodeB ) );
			found.push_back( { pair.nodeA, pair.nodeB } );
		}
		std::sort( found.begin(), found.end() );
		ASSERT_EQ( std::adjacent_find( found.begin(), found.end() ), found.end() );
		for ( int a = 0; a < soft[0]->nodeCount(); ++a )
		{
			for ( int b = 0; b < soft[1]->nodeCount(); ++b )
			{
				const bool collide = soft[0]->impl().shape->childOfNode( a ) >= 0 && soft[1]->impl().shape->childOfNode( b ) >= 0;
				const Vec3d apart = positionOf( *soft[0], a ).cast<double>() + toVec3d( approach.shift ) -
					positionOf( *soft[1], b ).cast<double>();
				const Vec3d nearest = ( apart.cwiseAbs() - toVec3d( displacement ) ).cwiseMax( 0.0 ); // at any time during the approach
				const double touching = double( reachOf( *soft[0], a ) + soft[1]->impl().shape->sphereOfNode( b )->getRadius() );
				const double slack = double( kContactSlop * soft[1]->impl().shape->sphereOfNode( b )->getRadius() ) + 1e-6;
				const bool isFound = std::binary_search( found.begin(), found.end(), std::make_pair( a, b ) );
				ASSERT_TRUE( isFound || !collide || nearest.norm() > touching ) << "missed by " << touching - nearest.norm();
				ASSERT_TRUE( !isFound || ( collide && apart.norm() <= touching + double( displacement.length() ) + slack ) )
					<< "a false candidate";
			}
		}
		all += found.size();
	}
	EXPECT_GT( all, 1000U );
}

std::set<int> nodesOf( const std::vector<NodeHit>& hits )
{
	std::set<int> nodes;
	for ( const NodeHit& hit : hits )
	{
		nodes.insert( hit.node() );
	}
	return nodes;
}

/// Returns the node's sphere and its motion relative to a fixed object.
MovingSphere movingSphere( const SoftBody& soft, int node )
{
	const NodeState& nodes = soft.impl().body->nodes();
	MovingSphere sphere;
	sphere.shape = soft.impl().shape->sphereOfNode( node );
	sphere.radius = double( sphere.shape->getRadius() );
	sphere.centre = nodes.x.get( node ).cast<double>();
	sphere.displacement = kSubstep * nodes.v.get( node ).cast<double>();
	return sphere;
}

TEST_P( SphereRowsOf, AnObjectFindTheNodesThatItMeets )
{
	// So wide that they meet the spheres and not the drawn surface.
	btBoxShape box( btVector3( btScalar( 0.65 ), btScalar( 0.21 ), btScalar( 0.62 ) ) );
	btSphereShape ball( btScalar( 0.62 ) );
	btCapsuleShape capsule( btScalar( 0.62 ), btScalar( 0.35 ) );
	btCylinderShape cylinder( btVector3( btScalar( 0.62 ), btScalar( 0.21 ), btScalar( 0.62 ) ) );
	std::size_t all = 0;
	NodeSearch search;
	for ( btCollisionShape* const shape : std::initializer_list<btCollisionShape*>{ &box, &ball, &capsule, &cylinder } )
	{
		for ( int round = 0; round < 30; ++round )
		{
			shake( *soft[0], random, 0.005, round % 2 == 0 ? 0.5 : 25.0 );
			btCollisionObject object;
			object.setCollisionShape( shape );
			const btVector3 position( btScalar( uniform( random, -0.6, 0.6 ) ), btScalar( 0.5 ), btScalar( uniform( random, -0.5, 0.5 ) ) );
			object.setWorldTransform( btTransform( btQuaternion( btVector3( 1, 2, 3 ).normalized(), btScalar( round ) ), position ) );
			const btCollisionObjectWrapper wrapper( nullptr, shape, &object, object.getWorldTransform(), -1, -1 );
			const std::set<int> found = nodesOf( search.againstRigid( *soft[0], wrapper, kSubstep ) );
			Obstacle obstacle;
			obstacle.shape = shape;
			obstacle.basis = toMatrix3d( object.getWorldTransform().getBasis() );
			obstacle.position = toVec3d( object.getWorldTransform().getOrigin() ) - soft[0]->impl().body->nodes().origin;
			std::set<int> expected;
			for ( int node = 0; node < soft[0]->nodeCount(); ++node )
			{
				Touch touch;
				if ( soft[0]->impl().shape->childOfNode( node ) >= 0 && findTouch( obstacle, movingSphere( *soft[0], node ), touch ) )
				{
					expected.insert( node );
				}
			}
			ASSERT_EQ( found, expected ) << shape->getName() << " " << round;
			all += found.size();
		}
	}
	EXPECT_GT( all, 500U );
}

TEST_P( SphereRowsOf, TwoBodiesFindTheNodesThatMeet )
{
	std::size_t all = 0;
	NodeSearch search;
	for ( int round = 0; round < 30; ++round )
	{
		shake( *soft[0], random, 0.005, round % 2 == 0 ? 0.5 : 25.0 );
		shake( *soft[1], random, 0.005, round % 2 == 0 ? 0.5 : 25.0 );
		std::vector<std::uint64_t> found, expected;
		for ( const NodeHit& hit : search.againstSoft( *soft[0], *soft[1], kSubstep ) )
		{
			found.push_back( hit.key );
		}
		const NodeState& others = soft[1]->impl().body->nodes();
		const Vec3d apart = soft[0]->impl().body->nodes().origin - others.origin;
		for ( int a = 0; a < soft[0]->nodeCount(); ++a )
		{
			for ( int b = 0; b < soft[1]->nodeCount(); ++b )
			{
				MovingSphere sphere = movingSphere( *soft[0], a );
				sphere.displacement -= kSubstep * others.v.get( b ).cast<double>();
				Vec3d at = others.x.get( b ).cast<double>() - apart;
				double radius = double( soft[1]->impl().shape->sphereOfNode( b )->getRadius() );
				if ( useRoundSpheres( *soft[0], *soft[1] ) )
				{
					const Vec3d between = at - sphere.centre;
					const RoundSphere one = roundSphere( *soft[0], a, between ), other = roundSphere( *soft[1], b, -between );
					sphere.centre += one.inwards;
					sphere.radius += one.inwards.norm();
					at += other.inwards;
					radius += other.inwards.norm();
				}
				Touch touch;
				const bool collide = soft[0]->impl().shape->childOfNode( a ) >= 0 && soft[1]->impl().shape->childOfNode( b ) >= 0;
				if ( collide && findBallTouch( radius, at, sphere, touch ) )
				{
					expected.push_back( std::uint64_t( a ) << 32 | std::uint32_t( b ) );
				}
			}
		}
		ASSERT_EQ( found, expected );
		all += found.size();
	}
	EXPECT_GT( all, 500U );
}

INSTANTIATE_TEST_SUITE_P( Levels, SphereRowsOf, testing::Values( 0, 2 ) );

} // namespace
} // namespace pliant::test
