// Bodies in their rigid state as in heaps: bent by loads, and overlapping one another.

#include "body/rigid_state.h"
#include "support/mesh_of_boxes.h"
#include "world/bodies/obstacle_parts.h"
#include "world/bodies/soft_body_impl.h"
#include "world/test_world.h"

#include <algorithm>
#include <cstdio>

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

/// Of a slab that does not become rigid yet.
Material slabMaterial()
{
	Material material = stiffRigid( 1e6f, 0.0f );
	material.damping = 100.0f;
	return material;
}

/// Adds a floor and a slab of 1 x .3 x 1 m that has come to rest on it.
SoftBody* addSlab( TestWorld& test, const Material& material )
{
	test.addFloor();
	SoftBody* const slab = test.addSoft( block( 10, 3, 10, 0.1f ), at( 0, 0.15f, 0 ), material );
	test.run( 60 );
	return slab;
}

// It stayed deformable, and took all its substeps as long as the weight lay on it.
TEST( RigidHeaps, ABodyRestsBentAndIsStraightWithoutItsLoad )
{
	TestWorld test;
	Material material = slabMaterial();
	SoftBody* const slab = addSlab( test, material );
	const btScalar straight = test::heightOf( *slab );
	btRigidBody* const weight = test.addBox( 200, btVector3( 0.15f, 0.05f, 0.15f ), at( 0.062f, 0.355f, 0.05f ) );
	test.run( 120 );
	material.rigidStrain = 0.01f;
	ASSERT_TRUE( slab->setMaterial( material ).ok() );
	btScalar fastest = 0;
	for ( int frame = 0; frame < 160; ++frame )
	{
		test.run( 1 );
		fastest = std::max( { fastest, slab->linearVelocity().length(), weight->getLinearVelocity().length() } );
	}
	EXPECT_LT( fastest, 0.12f ) << "on the one contact that Bullet finds in the first step the weight fell at 0.14 m/s";
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
	EXPECT_NEAR( test::heightOf( *slab ), straight, 0.001f );
}

// The hull of the bent slab fills the dent in which the crate stands. On the one contact with its deepest corner half of such crates fell
// at .12 m/s and more, and one was thrown up at .39 m/s after a third of a second.
TEST( RigidHeaps, ACrateInADentOfABodyThatBecomesRigidStandsStill )
{
	constexpr int kPlaces = 8;
	for ( int place = 0; place < kPlaces; ++place )
	{
		TestWorld test;
		Material material = slabMaterial();
		SoftBody* const slab = addSlab( test, material );
		btRigidBody* const crate = test.addBox(
			200, btVector3( 0.15f, 0.05f, 0.15f ), at( 0.062f + 0.012f * btScalar( place ), 0.355f, 0.05f - 0.009f * btScalar( place ) ) );
		test.run( 120 );
		material.rigidStrain = 0.01f;
		ASSERT_TRUE( slab->setMaterial( material ).ok() );
		btScalar fastest = 0;
		for ( int frame = 0; frame < 120; ++frame )
		{
			test.run( 1 );
			fastest = std::max( fastest, crate->getLinearVelocity().length() );
		}
		std::printf( "place %d: at most %.3f m/s\n", place, double( fastest ) );
		EXPECT_LT( fastest, 0.12f ) << place;
		EXPECT_TRUE( slab->isRigid() ) << place;
	}
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

/// A vessel without a lid of thin brittle walls that are rigid while stiff.
SoftBody* addVessel( TestWorld& test, const btTransform& where )
{
	test::MeshOfBoxes vessel;
	vessel.add( btVector3( 0.3f, 0.02f, 0.3f ), btVector3( 0.3f, 0.02f, 0.3f ) );
	for ( const btScalar side : { btScalar( 0.02 ), btScalar( 0.58 ) } )
	{
		vessel.add( btVector3( side, 0.32f, 0.3f ), btVector3( 0.02f, 0.28f, 0.3f ) );
		vessel.add( btVector3( 0.3f, 0.32f, side ), btVector3( 0.26f, 0.28f, 0.02f ) );
	}
	Material material;
	material.density = 2000.0f;
	material.youngsModulus = 5e9f;
	material.rigidStrain = 0.02f;
	SoftBody* const body = test.addSoft( vessel.build( 0.04f ), where, material );
	Fracture fracture;
	fracture.rule = BreakRule::Shards;
	fracture.breakStrain = 6e-4f;
	fracture.shardSize = 0.12f;
	fracture.crumbFraction = 0.04f;
	EXPECT_TRUE( body->setFracture( fracture ).ok() );
	body->setFriction( btScalar( 0.6 ) );
	return body;
}

// In a heap of shards some one slips or tips at any time, which restarted its time at rest, and the whole heap stayed awake for more than
// 20 s.
TEST( RigidHeaps, DebrisSleeps )
{
	for ( int k = 0; k < 3; ++k )
	{
		TestWorld test;
		test.addFloor();
		const btQuaternion turn( btVector3( 1, 0, btScalar( 0.3 * k ) ).normalized(), btScalar( 0.4 + 0.3 * k ) );
		SoftBody* const vessel = addVessel( test, btTransform( turn, btVector3( 0, btScalar( 1.2 ), 0 ) ) );
		ASSERT_TRUE( vessel->setLinearVelocity( btVector3( 0, -8, 0 ) ).ok() );
		int frame = 0;
		while ( frame < 600 && ( frame < 60 || test.world.stepReport().awakeSoftBodies > 0 ) )
		{
			test.run( 1 );
			++frame;
		}
		std::printf( "%d bodies asleep after %.1f s\n", test.world.softBodyCount(), frame / 60.0 );
		EXPECT_GT( test.world.softBodyCount(), 15 );
		EXPECT_LT( frame, 480 ) << k;
	}
}

// It rolled on at .2 m/s without end: its hull is round, and sinks into the floor a little at each corner.
TEST( RigidHeaps, ACrumbStopsRolling )
{
	TestWorld test;
	test.addFloor();
	test::MeshOfBoxes corner;
	corner.add( btVector3( 0.036f, 0.006f, 0.006f ), btVector3( 0.036f, 0.006f, 0.006f ) );
	corner.add( btVector3( 0.012f, 0.018f, 0.006f ), btVector3( 0.012f, 0.006f, 0.006f ) );
	SoftBody* const crumb = test.addSoft( corner.build( 0.024f ), at( 0, 0.02f, 0 ), stiffRigid( 1e9f, 0.02f ) );
	crumb->setFriction( btScalar( 0.6 ) );
	ASSERT_TRUE( crumb->setVelocities( btVector3( 0, 0, btScalar( 0.25 ) ), btVector3( 30, 0, 0 ) ).ok() );
	test.run( 180 );
	ASSERT_TRUE( crumb->isRigid() );
	EXPECT_LT( crumb->linearVelocity().length(), 0.02f );
}

// It fell asleep where it was slowest: motion used its time at rest up, but not all of it.
TEST( RigidHeaps, WhatIsThrownOffComesDown )
{
	TestWorld test;
	test.addFloor();
	btRigidBody* const lift = test.addBox( 500, btVector3( 0.3f, 0.1f, 0.3f ), at( 0, 0.1f, 0 ) );
	lift->setActivationState( DISABLE_DEACTIVATION );
	SoftBody* const body = test.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.36f, 0 ), stiffRigid( 1e9f, 0.02f ) );
	test.run( 300 );
	ASSERT_TRUE( body->isRigid() && body->isActive() );
	ASSERT_GT( body->getDeactivationTime(), 2.0f );
	lift->setLinearVelocity( btVector3( 0, btScalar( 2.2 ), 0 ) );
	btScalar highest = 0;
	for ( int frame = 0; frame < 120; ++frame )
	{
		test.run( 1 );
		highest = std::max( highest, body->massCentre().y() );
		lift->setLinearVelocity( frame == 3 ? btVector3( 0, -2, 0 ) : lift->getLinearVelocity() );
	}
	EXPECT_GT( highest, 0.45f );
	EXPECT_LT( body->massCentre().y(), 0.4f );
}

/// Distance from a point to the nearest hull of a body in its rigid state, m; below 0 inside.
double distanceToHulls( const SoftBody& body, const Vec3d& point )
{
	btSphereShape sphere( btScalar( 0.001 ) );
	MovingSphere at;
	at.shape = &sphere;
	at.radius = double( sphere.getRadius() );
	at.centre = point;
	Obstacle hulls;
	hulls.shape = body.getCollisionShape();
	hulls.basis = toMatrix3d( body.getWorldTransform().getBasis() );
	hulls.position = toVec3d( body.getWorldTransform().getOrigin() );
	double nearest = SIMD_INFINITY;
	visitParts( hulls, [&]( const Obstacle& hull ) {
		Touch touch;
		EXPECT_TRUE( findNearest( hull, at, touch ) );
		nearest = std::min( nearest, touch.distance );
	} );
	return nearest;
}

TEST( RigidHulls, FollowTheMaterialOfPlatesAnglesAndBowls )
{
	test::MeshOfBoxes angle, bowl;
	angle.add( btVector3( 0.6f, 0.1f, 0.3f ), btVector3( 0.6f, 0.1f, 0.3f ) );
	angle.add( btVector3( 0.1f, 0.7f, 0.3f ), btVector3( 0.1f, 0.5f, 0.3f ) );
	bowl.add( btVector3( 0.5f, 0.05f, 0.5f ), btVector3( 0.5f, 0.05f, 0.5f ) );
	for ( const btScalar side : { btScalar( 0.05 ), btScalar( 0.95 ) } )
	{
		bowl.add( btVector3( side, 0.4f, 0.5f ), btVector3( 0.05f, 0.3f, 0.5f ) );
		bowl.add( btVector3( 0.5f, 0.4f, side ), btVector3( 0.4f, 0.3f, 0.05f ) );
	}
	struct Case
	{
		std::shared_ptr<const BodyTemplate> shape;
		int leastHulls, mostHulls;
		Vec3d hollow; ///< a point far from all material, mesh coordinates
		double clear; ///< m, between it and the hulls at least
	};
	const Case cases[] = { { block( 12, 1, 8, 0.1f ), 1, 1, { 0, 0.4, 0 }, 0.3 }, { angle.build( 0.1f ), 2, 6, { 0.8, 0.8, 0.3 }, 0.35 },
		{ bowl.build( 0.1f ), 5, 24, { 0.5, 0.5, 0.5 }, 0.25 } };
	for ( const Case& each : cases )
	{
		TestWorld test;
		SoftBody* const body = test.addSoft( each.shape, at( 0, 0, 0 ), stiffRigid( 1e6f, 0.01f ) );
		SoftBody::Impl& impl = body->impl();
		impl.becomeRigid( *body );
		const btCollisionShape* const shape = body->getCollisionShape();
		const int hulls = shape->isCompound() ? static_cast<const btCompoundShape*>( shape )->getNumChildShapes() : 1;
		EXPECT_GE( hulls, each.leastHulls );
		EXPECT_LE( hulls, each.mostHulls );
		const Vec3d hollow = each.hollow - impl.body->lattice().massCentre + toVec3d( body->massCentre() );
		EXPECT_GT( distanceToHulls( *body, hollow ), each.clear ) << hulls;
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			const double radius = double( impl.shape->sphereOfNode( i )->getRadius() );
			EXPECT_LT( distanceToHulls( *body, toVec3d( body->nodePosition( i ) ) ), -0.9 * radius ) << i;
		}
	}
}

} // namespace
} // namespace pliant
