// Templates and bodies of other sizes.

#include "world/game/hollow_box.h"
#include "world/test_world.h"

#include <cmath>
#include <limits>

namespace pliant::test {

TEST( Scaling, AScaledTemplateIsThatOfTheScaledMesh )
{
	TestWorld t;
	t.addFloor();
	const auto made = block( 4, 4, 4, 0.1f )->scaled( 2.5f );
	ASSERT_TRUE( made.ok() ) << made.status.sentence;
	EXPECT_NEAR( made.value->cellSize(), 0.25f, 1e-6f );
	EXPECT_NEAR( made.value->report().volume, 1.0, 1e-5 );
	SoftBody* scaled = t.addSoft( made.value, at( 0, 1, 0 ) );
	SoftBody* built = t.addSoft( block( 4, 4, 4, 0.25f ), at( 5, 1, 0 ) );
	EXPECT_NEAR( scaled->mass(), built->mass(), 1e-3 * built->mass() );
	t.run( 120 );
	for ( int node = 0; node < built->nodeCount(); ++node )
	{
		EXPECT_NEAR( ( scaled->nodePosition( node ) - built->nodePosition( node ) ).y(), 0, 2e-3 );
		EXPECT_NEAR( scaled->nodeRadius( node ), built->nodeRadius( node ), 1e-6 );
	}
	const SurfaceView a = scaled->surface(), b = built->surface();
	ASSERT_EQ( a.vertexCount, b.vertexCount );
	for ( int k = 0; k < a.vertexCount; ++k )
	{
		EXPECT_NEAR( double( a.origin.y() ) + a.positions[3 * k + 1], double( b.origin.y() ) + b.positions[3 * k + 1], 2e-3 );
	}
}

TEST( Scaling, AScaledTemplateBreaksLikeAnyOther )
{
	TestWorld t;
	const auto made = block( 4, 4, 4, 0.1f )->scaled( 2.5f );
	ASSERT_TRUE( made.ok() );
	SoftBody* cube = t.addSoft( made.value, at( 0, 1, 0 ) );
	ASSERT_GT( cube->surface().vertexCount, 0 );
	EXPECT_GT( cube->cutPlane( btVector3( 0, 1, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	t.run( 2 );
	ASSERT_EQ( t.world.softBodyCount(), 2 );
	EXPECT_GT( cube->surface().triangleCount, 12 ) << "crack faces";
}

TEST( Scaling, ABodyGrowsOnTheFloorStepByStep )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		t.addFloor();
		Material material = stiff( 3e5f );
		material.elasticity = elasticity;
		SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.2f, 0 ), material );
		const btScalar mass = cube->mass(), radius = cube->nodeRadius( 0 );
		t.run( 30 );
		btScalar fastest = 0;
		for ( int frame = 1; frame <= 100; ++frame )
		{
			ASSERT_TRUE( cube->setScale( 1 + btScalar( frame ) / 100 ).ok() );
			t.run( 1 );
			fastest = btMax( fastest, cube->linearVelocity().length() );
			ASSERT_TRUE( cube->isHealthy() );
		}
		EXPECT_LT( fastest, 1 ) << "its centre rises by 0.12 m/s";
		EXPECT_NEAR( cube->mass(), 8 * mass, 1e-3 * 8 * mass );
		EXPECT_NEAR( cube->nodeRadius( 0 ), 2 * radius, 0.05 * radius );
		t.run( 120 );
		EXPECT_NEAR( cube->massCentre().y(), 0.4, 0.02 );
		EXPECT_EQ( cube->scale(), 2 );
		ASSERT_TRUE( cube->setScale( 1 ).ok() );
		EXPECT_NEAR( cube->mass(), mass, 1e-3 * mass );
		t.run( 60 );
		EXPECT_NEAR( cube->massCentre().y(), 0.2, 0.02 );
		EXPECT_NEAR( cube->bodyTemplate().cellSize(), 0.1f, 1e-6f );
	}
}

TEST( Scaling, KeepsVelocityPinsGasAndFracture )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* ball = t.addSoft( hollowBox( 1, 0.125f ), at( 0, 0, 0 ), stiff( 1e6f ) );
	Fracture fracture;
	fracture.rule = BreakRule::Distance;
	fracture.breakStrain = 0.5f;
	ASSERT_TRUE( ball->setFracture( fracture ).ok() );
	ASSERT_TRUE( ball->setGas( Gas{ GasLaw::Constant, 100, 0 } ).ok() );
	ASSERT_TRUE( ball->setLinearVelocity( btVector3( 1, 0, 0 ) ).ok() );
	const btScalar volume = ball->gasVolume();
	ASSERT_TRUE( ball->setScale( 2 ).ok() );
	EXPECT_NEAR( ball->gasVolume(), 8 * volume, 0.01 * 8 * volume );
	t.run( 30 );
	EXPECT_NEAR( ball->linearVelocity().x(), 1, 1e-3 );
	EXPECT_EQ( t.world.softBodyCount(), 1 ) << "no link is stretched";
	ASSERT_TRUE( ball->pinNode( 3 ).ok() );
	ASSERT_TRUE( ball->setScale( btScalar( 1.9 ) ).ok() );
	EXPECT_TRUE( ball->isPinned( 3 ) );
}

TEST( Scaling, WhatCannotBeScaledIsRefused )
{
	const float bad = std::numeric_limits<float>::quiet_NaN();
	const auto shape = block( 4, 4, 4, 0.1f );
	EXPECT_EQ( shape->scaled( bad ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( shape->scaled( 0.0f ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( shape->scaled( -1.0f ).status.code, ResultCode::BadArgument );
	TestWorld t;
	SoftBody* cube = t.addSoft( shape, at( 0, 0, 0 ) );
	for ( const btScalar scale : { btScalar( bad ), btScalar( 0 ), btScalar( -1 ), btScalar( 1e4 ) } )
	{
		EXPECT_EQ( cube->setScale( scale ).code, ResultCode::BadArgument );
	}
	EXPECT_EQ( cube->scale(), 1 );
	Adaptivity adaptivity;
	adaptivity.coarseLevels = 1;
	EXPECT_EQ( t.addSoft( shape, at( 5, 0, 0 ), stiff( 1e5f ), adaptivity )->setScale( 2 ).code, ResultCode::BadArgument );
	EXPECT_GT( cube->cutPlane( btVector3( 0, 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	EXPECT_EQ( cube->setScale( 2 ).code, ResultCode::BadArgument );
	t.run( 2 );
	EXPECT_EQ( cube->setScale( 2 ).code, ResultCode::BadArgument );
}

} // namespace pliant::test
