// Boxes, hulls and planes give the same contacts to spheres that are sorted out before as to single ones; marked nodes are returned in
// order.

#include "world/constants.h"
#include "world/shape/node_marks.h"
#include "world/touch/box_touch.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

namespace pliant {
namespace {

struct Count
{
	int clear = 0, outside = 0, inside = 0, swept = 0;
};

/// Spheres around boxes whose centre is up to `away` from the origin; displacements up to `fastest`, m.
Count compareBoth( double away, double fastest )
{
	std::mt19937 random( 5 );
	std::uniform_real_distribution<double> any( -1.0, 1.0 );
	const auto some = [&] { return Vec3d( any( random ), any( random ), any( random ) ); };
	Count count;
	for ( int round = 0; round < 60; ++round )
	{
		const Vec3d half = Vec3d::Constant( 0.8 ) + 0.5 * some();
		const btBoxShape shape( btVector3( btScalar( half.x() ), btScalar( half.y() ), btScalar( half.z() ) ) );
		Obstacle box;
		box.shape = &shape;
		if ( round % 4 != 0 )
		{
			box.basis = Eigen::Quaterniond( any( random ), any( random ), any( random ), any( random ) ).normalized().toRotationMatrix();
		}
		box.position = away * some();
		const BoxTouch boxTouch( box );
		for ( int k = 0; k < 500; ++k )
		{
			MovingSphere sphere;
			sphere.radius = 0.2 + 0.1 * any( random );
			sphere.displacement = fastest * some();
			sphere.centre = box.position + 1.8 * some();
			Touch one, many;
			const bool isTouching = findTouch( box, sphere, one );
			const bool isFound = boxTouch.find( sphere, many );
			EXPECT_EQ( isTouching, isFound );
			if ( isTouching && isFound )
			{
				EXPECT_EQ( one.normal, many.normal );
				EXPECT_EQ( one.distance, many.distance );
			}
			++( !isTouching                                                                    ? count.clear
					: sphere.isFast() && one.distance > sphere.radius * ( 1.0 + kContactSlop ) ? count.swept
					: one.distance < 0.0                                                       ? count.inside
																							   : count.outside );
		}
	}
	return count;
}

TEST( BoxTouch, BatchesEqualSingleQueries )
{
	const Count slow = compareBoth( 5.0, 0.03 );
	EXPECT_GT( slow.clear, 5000 );
	EXPECT_GT( slow.outside, 1500 );
	EXPECT_GT( slow.inside, 1500 );
	const Count fast = compareBoth( 5.0, 0.6 );
	EXPECT_GT( fast.clear, 5000 );
	EXPECT_GT( fast.swept, 500 );
}

TEST( BoxTouch, WorksAThousandKilometresOut )
{
	compareBoth( 1e6, 0.3 );
}

TEST( NodeMarks, AreReturnedInOrderAndOnce )
{
	std::mt19937 random( 3 );
	NodeMarks marks;
	for ( const int count : { 1, 64, 65, 700, 130 } )
	{
		marks.fit( count );
		std::set<int> given;
		for ( int k = 0; k < count / 2 + 1; ++k )
		{
			const int node = int( random() % unsigned( count ) );
			given.insert( node );
			marks.add( node );
		}
		marks.add( count - 1 );
		given.insert( count - 1 );
		std::vector<int> taken;
		marks.takeAll( [&taken]( int node ) { taken.push_back( node ); } );
		EXPECT_EQ( taken, std::vector<int>( given.begin(), given.end() ) );
		marks.takeAll( []( int ) { FAIL(); } );
	}
}

TEST( HullTouch, LeavesOutNoSphereThatGjkFindsInReach )
{
	std::mt19937 random( 7 );
	std::uniform_real_distribution<double> any( -1.0, 1.0 );
	const auto some = [&] { return Vec3d( any( random ), any( random ), any( random ) ); };
	int touching = 0, clear = 0;
	for ( int round = 0; round < 60; ++round )
	{
		const Vec3d half( 1.0, 0.6, round % 3 == 0 ? 0.05 : 0.7 );
		btConvexHullShape hull;
		hull.setMargin( btScalar( 0.05 ) );
		for ( int k = 0; k < 4 + round % 20; ++k )
		{
			const Vec3d point = half.cwiseProduct( some() );
			hull.addPoint( btVector3( btScalar( point.x() ), btScalar( point.y() ), btScalar( point.z() ) ), true );
		}
		Obstacle obstacle;
		obstacle.shape = &hull;
		obstacle.basis = Eigen::Quaterniond( any( random ), any( random ), any( random ), any( random ) ).normalized().toRotationMatrix();
		obstacle.position = some();
		btSphereShape ball( btScalar( 0.1 ) );
		for ( int k = 0; k < 300; ++k )
		{
			MovingSphere sphere;
			sphere.shape = &ball;
			sphere.radius = 0.1;
			sphere.displacement = 0.02 * some();
			sphere.centre = obstacle.position + 1.2 * some();
			Touch found, nearest;
			ASSERT_FALSE( sphere.isFast() );
			const bool isTouching = findTouch( obstacle, sphere, found );
			const bool reaches = findNearest( obstacle, sphere, nearest ) && sphere.reaches( nearest.normal, nearest.distance );
			EXPECT_EQ( isTouching, reaches ) << nearest.distance;
			EXPECT_TRUE( !isTouching || ( found.normal == nearest.normal && found.distance == nearest.distance ) );
			++( isTouching ? touching : clear );
		}
	}
	EXPECT_GT( touching, 1500 );
	EXPECT_GT( clear, 5000 );
}

TEST( FarPlane, BlocksAreClearOnlyWhereEachNodeIs )
{
	std::mt19937 random( 9 );
	std::uniform_real_distribution<double> any( -1.0, 1.0 );
	const auto some = [&] { return Vec3d( any( random ), any( random ), any( random ) ); };
	constexpr double kStep = 0.01, kRadius = 0.1;
	int blocks = 0, allClear = 0;
	NodeState nodes;
	nodes.count = nodes.padded = FarPlane::kBlock;
	nodes.x.resize( nodes.padded );
	nodes.v.resize( nodes.padded );
	for ( int round = 0; round < 4000; ++round )
	{
		const Vec3d normal = some().normalized();
		const btStaticPlaneShape shape( btVector3( btScalar( normal.x() ), btScalar( normal.y() ), btScalar( normal.z() ) ), 0 );
		Obstacle plane;
		plane.shape = &shape;
		plane.position = 100.0 * some();
		const FarPlane far( plane );
		const Vec3d middle = plane.position + ( 0.15 + 0.1 * any( random ) ) * normal;
		bool areAll = true;
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3d across = some(), at = middle + across - across.dot( normal ) * normal + 0.02 * some();
			nodes.x.set( i, at.cast<float>() );
			nodes.v.set( i, some().cast<float>() );
			areAll = areAll && far.isClear( nodes.x.get( i ).cast<double>(), kStep * nodes.v.get( i ).cast<double>(), kRadius );
		}
		const bool isBlock = far.areClear( nodes, 0, kStep, kRadius );
		EXPECT_TRUE( areAll || !isBlock );
		blocks += isBlock;
		allClear += areAll;
	}
	EXPECT_GT( blocks, 500 );
	EXPECT_GT( blocks, allClear * 9 / 10 );
}

} // namespace
} // namespace pliant
