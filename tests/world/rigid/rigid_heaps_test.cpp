// Bodies in their rigid state as in heaps: bent by loads, and overlapping one another.

#include "body/rigid_state.h"
#include "world/bodies/soft_body_impl.h"
#include "world/test_world.h"

#include <algorithm>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

Material stiffRigid( float youngsModulus, float rigidStrain )
{
	Material material = test::stiff( youngsModulus );
	material.rigidStrain = rigidStrain;
	return material;
}

btScalar heightOf( const SoftBody& body )
{
	btScalar high = -SIMD_INFINITY;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		high = btMax( high, body.nodePosition( i ).y() );
	}
	return high - test::lowestNode( body );
}

// It used to stay deformable, and took all its substeps as long as the weight lay on it.
TEST( RigidHeaps, ABodyRestsBentAndIsStraightWithoutItsLoad )
{
	TestWorld test;
	test.addFloor();
	Material material = stiffRigid( 1e6f, 0.0f );
	material.damping = 100.0f;
	SoftBody* const slab = test.addSoft( block( 10, 3, 10, 0.1f ), at( 0, 0.15f, 0 ), material );
	test.run( 60 );
	const btScalar straight = heightOf( *slab );
	btRigidBody* const weight = test.addBox( 200, btVector3( 0.15f, 0.05f, 0.15f ), at( 0.05f, 0.355f, 0.05f ) );
	test.run( 120 );
	material.rigidStrain = 0.01f;
	ASSERT_TRUE( slab->setMaterial( material ).ok() );
	btScalar fastest = 0;
	for ( int frame = 0; frame < 160; ++frame )
	{
		test.run( 1 );
		fastest = std::max( { fastest, slab->linearVelocity().length(), weight->getLinearVelocity().length() } );
	}
	EXPECT_LT( fastest, 0.06f ) << "on the one contact that Bullet finds in the first step the weight fell at 0.14 m/s";
	ASSERT_TRUE( slab->isRigid() );
	EXPECT_TRUE( slab->impl().body->rigidState()->isBent );
	EXPECT_LT( slab->nodePosition( slab->nearestNode( btVector3( 0.05f, 0.3f, 0.05f ) ) ).y(), 0.25f - 0.001f );
	test.world.removeRigidBody( weight );
	slab->activate();
	test.run( 2 );
	EXPECT_FALSE( slab->isRigid() );
	test.run( 120 );
	EXPECT_TRUE( slab->isRigid() );
	EXPECT_FALSE( slab->impl().body->rigidState()->isBent );
	EXPECT_NEAR( heightOf( *slab ), straight, 0.001f );
}

// They separated by a fifth of the depth in each step, which threw them apart, or stayed deformable and overlapping.
TEST( RigidHeaps, WhatOverlapsPartsSlowly )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const left = test.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ), stiffRigid( 1e7f, 0.01f ) );
	SoftBody* const right = test.addSoft( block( 3, 3, 3, 0.1f ), at( 1, 0, 0 ), stiffRigid( 1e7f, 0.01f ) );
	test.run( 10 );
	ASSERT_TRUE( left->isRigid() && right->isRigid() );
	ASSERT_TRUE( right->teleport( at( -0.8f, 0, 0 ) ).ok() ); // they overlap by 0.1
	btScalar fastest = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		test.run( 1 );
		fastest = std::max( fastest, ( right->linearVelocity() - left->linearVelocity() ).length() );
	}
	EXPECT_TRUE( left->isRigid() && right->isRigid() );
	EXPECT_LT( fastest, 0.4f );
	EXPECT_GT( ( right->massCentre() - left->massCentre() ).length(), 0.29f );
}

} // namespace
} // namespace pliant
