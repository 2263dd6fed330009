// The plane that represents an object sliding over a node is that at the node's future position (node_touch.h).

#include "world/touch/obstacle_motion.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kStep = 1.0 / 60.0;

/// A fixed sphere of radius .05, and an object that meets it.
struct Scene
{
	explicit Scene( const btCollisionShape& shape, const Vec3d& position )
	{
		obstacle.shape = &shape, obstacle.position = motion.centre = position;
	}

	MovingSphere sphere() const
	{
		MovingSphere sphere;
		sphere.radius = 0.05;
		sphere.displacement = -motion.displacement( sphere.centre, kStep );
		return sphere;
	}
	bool looksAhead( Touch& touch ) const
	{
		const MovingSphere s = sphere();
		return findTouch( obstacle, s, touch ) &&
			lookAhead( motion.moved( obstacle, kStep ), s, Ahead{ Vec3d::Zero(), s.displacement }, touch );
	}

	Obstacle obstacle;
	ObstacleMotion motion;
};

const btBoxShape kBox( btVector3( 0.2f, 0.1f, 0.2f ) );

/// The box is at the height of the sphere, its lower edge `before` it, and approaches at `speed`.
Scene sliding( double before, double speed, double lower = 0.0 )
{
	Scene scene( kBox, Vec3d( -before - 0.2, 0.15 - lower, 0.0 ) );
	scene.motion.linear = Vec3d( speed, 0, 0 );
	return scene;
}

TEST( LookAhead, AnEdgeThatWillHavePassedIsAFace )
{
	for ( const double speed : { 1.5, 4.0 } )
	{
		Touch start, touch;
		const Scene scene = sliding( 0.02, speed );
		ASSERT_TRUE( findTouch( scene.obstacle, scene.sphere(), start ) );
		EXPECT_GT( start.normal.x(), 0.15 ); // otherwise it would have to push the sphere or turn back
		ASSERT_TRUE( scene.looksAhead( touch ) );
		EXPECT_LT( ( touch.normal - Vec3d( 0, -1, 0 ) ).norm(), 1e-6 );
		EXPECT_NEAR( touch.distance, 0.05, 1e-6 );
	}
}

TEST( LookAhead, AnEdgeThatWillNotHavePassedStaysAslant )
{
	Touch touch;
	const Scene scene = sliding( 0.02, 0.6, 0.003 ); // comes within .01 of it
	ASSERT_TRUE( scene.looksAhead( touch ) );
	EXPECT_NEAR( touch.normal.x() / touch.normal.y(), 0.01 / -0.047, 1e-5 );
}

// Without the displacement the edge would be hit on the way to the position where it passes.
TEST( LookAhead, ObjectsThatPassAboveAreNotTouched )
{
	Touch touch;
	const Scene scene = sliding( 0.02, 1.5, -0.003 );
	ASSERT_TRUE( findTouch( scene.obstacle, scene.sphere(), touch ) );
	EXPECT_FALSE( scene.looksAhead( touch ) );
}

// The normal must not rotate with the ball.
TEST( LookAhead, ASpinningBallPressesLikeOneThatDoesNotSpin )
{
	const btSphereShape ball( btScalar( 0.2 ) );
	Scene scene( ball, Vec3d( 0, 0.249, 0 ) );
	scene.motion.angular = Vec3d( 0, 3, 20 );
	Touch touch;
	ASSERT_TRUE( scene.looksAhead( touch ) );
	EXPECT_LT( ( touch.normal - Vec3d( 0, -1, 0 ) ).norm(), 1e-6 );
	EXPECT_NEAR( touch.distance, 0.049, 1e-6 );
}

TEST( LookAhead, ATippingBoxRotatesItsFace )
{
	Scene scene( kBox, Vec3d( 0, 0.149, 0 ) );
	scene.motion.angular = Vec3d( 0, 0, 6 );
	Touch touch;
	ASSERT_TRUE( scene.looksAhead( touch ) );
	EXPECT_NEAR( touch.normal.x() / -touch.normal.y(), std::tan( 0.1 ), 1e-5 );
}

// An object so fast that the sphere would end up in its middle or behind it is met on its near side.
TEST( LookAhead, ObjectsThatWouldPassThroughAreMetInFront )
{
	const btBoxShape wall( btVector3( 0.01f, 1, 1 ) );
	for ( const double speed : { 1.0, 5.0, 8.0, 50.0 } )
	{
		Scene scene( wall, Vec3d( -0.07, 0, 0 ) );
		scene.motion.linear = Vec3d( speed, 0, 0 );
		Touch touch;
		ASSERT_TRUE( scene.looksAhead( touch ) );
		EXPECT_LT( ( touch.normal - Vec3d( 1, 0, 0 ) ).norm(), 1e-6 ) << speed;
		EXPECT_NEAR( touch.distance, 0.06, 1e-6 );
	}
}

} // namespace
} // namespace pliant
