// A box gives the same contacts to a batch of spheres as to single ones; marked nodes are returned in order.

#include "world/constants.h"
#include "world/shape/node_marks.h"
#include "world/touch/box_touch.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>

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

} // namespace
} // namespace pliant
