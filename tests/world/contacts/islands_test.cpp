// Activation by contact: a soft body forms an island with the bodies it touches, not with all that overlap its box.

#include "world/test_world.h"

namespace pliant::test {
namespace {

/// A diagonal rod that never sleeps, and a cube in a corner of the rod's box, or at the rod.
struct RodAndCube
{
	TestWorld test;
	SoftBody* rod;
	SoftBody* cube;

	explicit RodAndCube( btScalar apart )
	{
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		const btTransform across( btQuaternion( btVector3( 0, 1, 0 ), SIMD_HALF_PI / 2 ), btVector3( 0, 0, 0 ) );
		rod = test.addSoft( block( 16, 2, 2, 0.1f ), across );
		rod->setActivationState( DISABLE_DEACTIVATION );
		const btVector3 away = btVector3( 1, 0, 1 ).normalized();
		cube = test.addSoft( block( 2, 2, 2, 0.1f ), btTransform( across.getRotation(), away * apart ) );
	}
	bool boxesOverlap() const
	{
		btVector3 low[2], high[2];
		rod->getCollisionShape()->getAabb( rod->getWorldTransform(), low[0], high[0] );
		cube->getCollisionShape()->getAabb( cube->getWorldTransform(), low[1], high[1] );
		return TestAabbAgainstAabb2( low[0], high[0], low[1], high[1] );
	}
};

TEST( Islands, BodiesInTheBoxWithoutContactSleep )
{
	RodAndCube t( btScalar( 0.5 ) );
	ASSERT_TRUE( t.boxesOverlap() );
	t.test.run( 180 );
	EXPECT_FALSE( t.cube->isActive() );
	EXPECT_TRUE( t.rod->isActive() );
	EXPECT_NE( t.cube->getIslandTag(), t.rod->getIslandTag() );
}

TEST( Islands, TouchedBodiesStayAwake )
{
	RodAndCube t( btScalar( 0.2 ) );
	t.rod->pinNodesInside( btVector3( -2, -2, -2 ), btVector3( 2, 2, 2 ) );
	EXPECT_TRUE( t.cube->setGravity( btVector3( -1, 0, -1 ) ).ok() ); // it leans against the rod
	t.test.run( 180 );
	EXPECT_TRUE( t.cube->isActive() );
	EXPECT_EQ( t.cube->getIslandTag(), t.rod->getIslandTag() );
}

TEST( Islands, AContactWakesASleepingBody )
{
	RodAndCube t( btScalar( 0.5 ) );
	t.test.run( 180 );
	ASSERT_FALSE( t.cube->isActive() );
	EXPECT_TRUE( t.rod->setLinearVelocity( btVector3( 1, 0, 1 ) ).ok() );
	for ( int frame = 0; frame < 60 && !t.cube->isActive(); ++frame )
	{
		t.test.run( 1 );
	}
	EXPECT_TRUE( t.cube->isActive() );
	t.test.run( 30 );
	EXPECT_GT( t.cube->massCentre().x(), 0.5 );
}

} // namespace
} // namespace pliant::test
