// Pinned nodes: fixed, following a rigid body, driven by the game. They are exactly at their targets in every frame.

#include "world/test_world.h"

#include <algorithm>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

TEST( Pins, APinnedNodeStaysAndTheBodyHangsFromIt )
{
	TestWorld t;
	SoftBody* bar = t.addSoft( block( 2, 8, 2, 0.1f ), at( 0, 0, 0 ) );
	EXPECT_EQ( bar->pinNodesInside( btVector3( -1, btScalar( 0.3 ), -1 ), btVector3( 1, 1, 1 ) ), 4 );
	const int held = bar->nearestNode( btVector3( 0, 1, 0 ) );
	const btVector3 before = bar->nodePosition( held );
	t.run( 600 );
	EXPECT_EQ( ( bar->nodePosition( held ) - before ).length(), 0 );
	EXPECT_TRUE( bar->isPinned( held ) );
	EXPECT_FALSE( bar->isActive() ) << "a bar that hangs still sleeps";
	EXPECT_NEAR( bar->massCentre().y(), 0, 0.05 );
	for ( int i = 0; i < bar->nodeCount(); ++i )
	{
		bar->releaseNode( i );
	}
	t.run( 30 );
	EXPECT_NEAR( bar->linearVelocity().y(), -9.81 / 2, 0.1 );
}

TEST( Pins, ANodeFollowsItsRigidBodyExactlyUntilThatLeaves )
{
	TestWorld t;
	btRigidBody* handle = t.addBox( 5, btVector3( 0.2f, 0.2f, 0.2f ), at( 0, 1, 0 ) );
	handle->setGravity( btVector3( 0, 0, 0 ) );
	handle->setAngularVelocity( btVector3( 1, 2, 3 ) );
	handle->setLinearVelocity( btVector3( 1, 0, 0 ) );
	SoftBody* bar = t.addSoft( block( 2, 6, 2, 0.1f ), at( 0, btScalar( 0.45 ), 0 ) );
	for ( const int node : { 20, 21, 22, 23 } )
	{
		ASSERT_TRUE( bar->pinNodeToBody( node, handle ).ok() );
	}
	bar->setCollisionFlags( btCollisionObject::CF_NO_CONTACT_RESPONSE );
	const btVector3 inHandle = handle->getWorldTransform().invXform( bar->nodePosition( 22 ) );
	for ( int k = 0; k < 60; ++k )
	{
		t.run( 1 );
		ASSERT_LT( ( bar->nodePosition( 22 ) - handle->getWorldTransform() * inHandle ).length(), btScalar( 2e-6 ) );
	}
	EXPECT_GT( handle->getWorldTransform().getOrigin().x(), btScalar( 0.8 ) );
	t.world.removeRigidBody( handle );
	EXPECT_FALSE( bar->isPinned( 22 ) );
	t.run( 30 );
	EXPECT_LT( bar->linearVelocity().y(), btScalar( -3 ) );
}

// Bullet gives kinematic bodies no angular velocity below 5e-4 rad a step: a brittle bar a metre from the axis was pulled by the
// displacement of a step, in each step, before it could follow.
TEST( Pins, ABodyFollowsAKinematicOneThatTurnsSlowly )
{
	for ( const btScalar perStep : { btScalar( 2e-4 ), btScalar( 4e-3 ) } ) // rad
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		btRigidBody* const turntable = t.addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 0, 0 ) );
		turntable->setCollisionFlags( btCollisionObject::CF_KINEMATIC_OBJECT | btCollisionObject::CF_NO_CONTACT_RESPONSE );
		turntable->setActivationState( DISABLE_DEACTIVATION );
		Material material;
		material.density = 2000.0f;
		material.youngsModulus = 1e9f;
		material.elasticity = Elasticity::Implicit;
		SoftBody* const bar = t.addSoft( block( 2, 2, 8, 0.05f ), at( 1, 0, 0 ), material );
		const int held = bar->nearestNode( btVector3( 1, 0, -1 ) ), free = bar->nearestNode( btVector3( 1, 0, 1 ) );
		const btScalar length = bar->nodePosition( held ).distance( bar->nodePosition( free ) );
		for ( int i = 0; i < bar->nodeCount(); ++i )
		{
			if ( bar->nodePosition( i ).z() < btScalar( -0.15 ) )
			{
				ASSERT_TRUE( bar->pinNodeToBody( i, turntable ).ok() );
			}
		}
		const btVector3 rest = bar->nodePosition( free );
		double worst = 0.0;
		for ( int k = 1; k <= 120; ++k )
		{
			const btQuaternion turned( btVector3( 0, 1, 0 ), perStep * btScalar( k ) );
			turntable->setWorldTransform( btTransform( turned ) );
			t.run( 1 );
			worst = std::max( worst, double( bar->nodePosition( free ).distance( quatRotate( turned, rest ) ) / length ) );
		}
		std::printf( "%.0e rad a step: off by %.1e of its length\n", double( perStep ), worst );
		EXPECT_LT( worst, 0.1 * double( perStep ) / double( length ) );
	}
}

TEST( Pins, ADrivenNodeIsAtItsTargetAtTheEndOfEachStep )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	const btVector3 start = cube->nodePosition( 13 );
	for ( int k = 1; k <= 120; ++k )
	{
		const btVector3 target = start + btVector3( btSin( btScalar( k ) / 10 ), btScalar( 0.02 ) * btScalar( k ), 0 );
		ASSERT_TRUE( cube->driveNode( 13, target ).ok() );
		t.run( 1 );
		ASSERT_LT( ( cube->nodePosition( 13 ) - target ).length(), btScalar( 2e-6 ) );
	}
	const btVector3 there = cube->nodePosition( 13 );
	t.run( 20 );
	EXPECT_EQ( ( cube->nodePosition( 13 ) - there ).length(), 0 ) << "it stays until it is driven on or released";
	EXPECT_EQ( cube->driveNode( 13, btVector3( SIMD_INFINITY * 10, 0, 0 ) ).code, ResultCode::BadArgument );
	EXPECT_EQ( cube->pinNode( 27 ).code, ResultCode::BadArgument );
	EXPECT_EQ( cube->pinNode( -1 ).code, ResultCode::BadArgument );
}

TEST( Pins, AMovingHandleWakesTheHangingBody )
{
	TestWorld t;
	btRigidBody* handle = t.addBox( 0, btVector3( 0.2f, 0.2f, 0.2f ), at( 0, 2, 0 ) );
	SoftBody* bar = t.addSoft( block( 2, 4, 2, 0.1f ), at( 0, 0, 0 ) );
	for ( int i = 0; i < bar->nodeCount(); ++i )
	{
		if ( bar->nodePosition( i ).y() > btScalar( 0.1 ) )
		{
			ASSERT_TRUE( bar->pinNodeToBody( i, handle ).ok() );
		}
	}
	t.run( 500 );
	ASSERT_FALSE( bar->isActive() );
	ASSERT_TRUE( bar->driveNode( 0, bar->nodePosition( 0 ) + btVector3( btScalar( 0.1 ), 0, 0 ) ).ok() );
	EXPECT_TRUE( bar->isActive() );
}

TEST( Pins, ForcesImpulsesAndTeleportDoWhatTheySay )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ) );
	const btScalar mass = cube->mass();
	EXPECT_TRUE( cube->applyCentralForce( btVector3( 60 * mass, 0, 0 ) ).ok() );
	t.run( 1 );
	EXPECT_NEAR( cube->linearVelocity().x(), 1, 1e-4 );
	t.run( 1 );
	EXPECT_NEAR( cube->linearVelocity().x(), 1, 1e-4 ) << "a force lasts one step";
	EXPECT_TRUE( cube->applyForce( btVector3( 0, 60 * mass, 0 ), 21 ).ok() );
	t.run( 1 );
	EXPECT_NEAR( cube->linearVelocity().y(), 1, 1e-3 );
	EXPECT_TRUE( cube->applyCentralImpulse( btVector3( -mass, -mass, 0 ) ).ok() );
	EXPECT_NEAR( cube->linearVelocity().length(), 0, 1e-3 );
	EXPECT_TRUE( cube->applyImpulse( btVector3( 0, 0, mass ), 0 ).ok() );
	EXPECT_NEAR( cube->linearVelocity().z(), 1, 1e-4 );
	EXPECT_TRUE( cube->setGravity( btVector3( 0, 0, -60 ) ).ok() );
	t.run( 1 );
	EXPECT_NEAR( cube->linearVelocity().z(), 0, 1e-3 );
	const btVector3 centre = cube->massCentre();
	EXPECT_TRUE( cube->teleport( btTransform( btQuaternion( btVector3( 0, 1, 0 ), SIMD_HALF_PI ), btVector3( 100, 0, 0 ) ) ).ok() );
	EXPECT_NEAR( cube->massCentre().x(), 100 + centre.z(), 1e-4 );
	EXPECT_TRUE( cube->reset( at( 0, 5, 0 ) ).ok() );
	EXPECT_NEAR( cube->massCentre().y(), 5, 1e-5 );
	EXPECT_EQ( cube->linearVelocity().length(), 0 );
}

} // namespace
} // namespace pliant
