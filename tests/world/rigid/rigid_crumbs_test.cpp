// Small bodies in their rigid state.

#include "body/rigid_state.h"
#include "support/mesh_of_boxes.h"
#include "support/momentum.h"
#include "world/bodies/soft_body_impl.h"
#include "world/test_world.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

// Crumbs of a vase spun at 13 000 rad/s on the floor: their nodes, which are mass points, were nearly collinear, and contacts at the
// material around them had a hundred times their lever arm.
TEST( RigidCrumbs, HaveTheInertiaOfTheirMaterial )
{
	TestWorld test;
	test.addFloor();
	test::MeshOfBoxes mesh;
	mesh.add( btVector3( 0, 0, 0 ), btVector3( 0.25f, 0.05f, 0.05f ) );
	mesh.add( btVector3( 0.3f, 0.01f, 0.01f ), btVector3( 0.05f, 0.04f, 0.04f ) ); // its cell's centre is off the line
	const std::shared_ptr<const BodyTemplate> shape = mesh.build( 0.1f );
	ASSERT_TRUE( shape );
	Material material = test::stiff( 1e7f );
	material.rigidStrain = 0.01f;
	SoftBody* const body = test.addSoft( shape, at( 0, 0.3f, 0 ), material );
	EXPECT_TRUE( body->setVelocities( btVector3( 2, 0, 1 ), btVector3( 5, 3, 0 ) ).ok() );
	double fastest = 0.0;
	for ( int frame = 0; frame < 240; ++frame )
	{
		test.run( 1 );
		fastest = body->isRigid() ? std::max( fastest, double( body->angularVelocity().length() ) ) : fastest;
	}
	ASSERT_TRUE( body->isRigid() );
	const Vec3d moments = body->impl().body->rigidState()->moments;
	EXPECT_TRUE( moments.minCoeff() == 0.0 || moments.minCoeff() > 0.09 * double( body->mass() ) * 0.01 ) << moments.transpose();
	EXPECT_GT( moments.minCoeff(), 0.0 );
	EXPECT_LT( fastest, 60.0 );
}

/// The largest difference of a distance from the first node between now and rest, m.
double largestError( const SoftBody& body )
{
	const NodeState& nodes = body.impl().body->nodes();
	double largest = 0.0;
	for ( int i = 1; i < nodes.count; ++i )
	{
		const float now = ( nodes.x.get( i ) - nodes.x.get( 0 ) ).norm(), rest = ( nodes.x0.get( i ) - nodes.x0.get( 0 ) ).norm();
		largest = std::max( largest, std::fabs( double( now - rest ) ) );
	}
	return largest;
}

/// A plate of one layer, two rows of which lie on the wrong side of the third.
struct FoldedPlate
{
	TestWorld test;
	Material material = test::stiff( 2e6f );
	SoftBody* body = nullptr;

	explicit FoldedPlate( const Fracture& fracture )
	{
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		material.elasticity = Elasticity::Implicit;
		material.damping = 50.0f;
		body = test.addSoft( test::block( 8, 1, 8, 0.03f ), at( 0, 1, 0 ), material );
		const float centres[6] = { -0.05f, 0, 0, 0.05f, 0, 0 };
		const int shards[2] = {};
		EXPECT_TRUE( body->setFracture( fracture, {}, ShardCentres{ centres, 2, shards } ).ok() ); // one shard
		NodeState& nodes = body->impl().body->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			Vec3 x = nodes.x.get( i );
			x.x() -= 2.0f * std::max( 0.0f, nodes.x0.get( i ).x() - 0.06f );
			nodes.x.set( i, x );
		}
		EXPECT_TRUE( body->setVelocities( btVector3( 1, 0, 0 ), btVector3( 0, 1, 0 ) ).ok() );
		test.run( 120 );
		EXPECT_GT( largestError( *body ), 0.05 ); // it rests folded
	}

	void allowRigidState()
	{
		material.rigidStrain = 0.1f;
		ASSERT_TRUE( body->setMaterial( material ).ok() );
		test.run( 60 );
	}
};

// A shard of a vase that the falling ball had crushed stayed folded, one of its links 2.7 times as long as at rest. It was too strained for
// its rigid state, hopped on the shard under it without end, and kept the heap awake.
TEST( RigidCrumbs, FoldedOnesTakeTheirShape )
{
	Fracture fracture;
	fracture.rule = BreakRule::Shards;
	fracture.breakStrain = 0.035f;
	FoldedPlate plate( fracture );
	const test::Momentum before = test::momentumOf( *plate.body );
	plate.allowRigidState();
	EXPECT_TRUE( plate.body->isRigid() );
	EXPECT_LT( largestError( *plate.body ), 1e-4 );
	const test::Momentum now = test::momentumOf( *plate.body );
	EXPECT_LT( ( now.linear - before.linear ).length(), 1e-5 * before.linear.length() );
	EXPECT_LT( ( now.angular - before.angular ).length(), 1e-4 * before.angular.length() );
}

// What breaks at a larger strain may be strained by so much at rest, and stays as it is.
TEST( RigidCrumbs, WhatMayStretchIsNotFolded )
{
	Fracture fracture;
	fracture.rule = BreakRule::Shards;
	fracture.breakStrain = 3.0f;
	FoldedPlate plate( fracture );
	plate.allowRigidState();
	EXPECT_FALSE( plate.body->isRigid() );
	EXPECT_GT( largestError( *plate.body ), 0.05 );
}

/// Crumbs of three to six cells of 2 cm that fall spinning on a floor.
void addCrumbs( TestWorld& test, int count )
{
	Material material = test::stiff( 5e7f );
	material.rigidStrain = 0.1f;
	std::vector<std::shared_ptr<const BodyTemplate>> shapes;
	for ( const btVector3& half : { btVector3( 0.03f, 0.01f, 0.01f ), btVector3( 0.03f, 0.02f, 0.01f ), btVector3( 0.02f, 0.02f, 0.01f ) } )
	{
		test::MeshOfBoxes mesh;
		mesh.add( btVector3( 0, 0, 0 ), half );
		mesh.add( half, btVector3( 0.01f, 0.01f, 0.01f ) ); // a corner on which it can spin like a top
		shapes.push_back( mesh.build( 0.02f ) );
		ASSERT_TRUE( shapes.back() );
	}
	for ( int k = 0; k < count; ++k )
	{
		const btQuaternion turn( btVector3( 1, btScalar( k % 5 ), btScalar( k % 3 ) - 1 ).normalized(), btScalar( k ) );
		SoftBody* const body = test.addSoft( shapes[std::size_t( k ) % shapes.size()],
			btTransform( turn, btVector3( btScalar( k % 4 ) * 0.1f, 0.1f + 0.03f * btScalar( k ), btScalar( k / 4 ) * 0.1f ) ), material );
		EXPECT_TRUE( body->setVelocities( btVector3( 0.3f, 0, 0.1f ), btVector3( 5, btScalar( 20 * ( k % 3 ) ), 3 ) ).ok() );
		body->setFriction( btScalar( 0.6 ) );
	}
}

// Their contacts were lost within a step: they rolled from corner to corner at 10 rad/s, half sunk into the floor, or spun on a corner.
TEST( RigidCrumbs, FallAsleep )
{
	TestWorld test;
	test.addPlane();
	addCrumbs( test, 16 );
	test.run( 5 * 60 );
	for ( const std::unique_ptr<SoftBody>& body : test.soft )
	{
		EXPECT_TRUE( body->isRigid() );
		EXPECT_FALSE( body->isActive() ) << body->nodeCount() << " nodes, " << body->linearVelocity().length() << " m/s, "
										 << body->angularVelocity().length() << " rad/s, at height " << body->massCentre().y();
	}
}

/// Drops a heap of 20 flat shards, or of boxes of their size, and returns the time until the last of them is asleep, s.
double timeToSleep( bool isSoft, int seed )
{
	constexpr int kShards = 20, kMostFrames = 900;
	const btVector3 halves[3] = { btVector3( 0.08f, 0.01f, 0.05f ), btVector3( 0.04f, 0.01f, 0.03f ), btVector3( 0.11f, 0.01f, 0.04f ) };
	const std::shared_ptr<const BodyTemplate> shapes[3] = {
		test::block( 8, 1, 5, 0.02f ), test::block( 4, 1, 3, 0.02f ), test::block( 11, 1, 4, 0.02f ) };
	TestWorld test;
	test.addPlane();
	Material glass = test::stiff( 8e6f );
	glass.density = 2500.0f;
	glass.damping = 100.0f;
	glass.rigidStrain = 0.1f;
	std::vector<btCollisionObject*> shards;
	for ( int k = 0; k < kShards; ++k )
	{
		const btQuaternion turn( btVector3( 1, btScalar( k % 5 ), btScalar( k % 3 ) - 1 ).normalized(), btScalar( k + seed ) );
		const btTransform where( turn, btVector3( btScalar( k % 3 ) * 0.1f, 0.2f + 0.12f * btScalar( k ), btScalar( k % 2 ) * 0.1f ) );
		const btVector3& half = halves[k % 3];
		const btScalar mass = 8 * half.x() * half.y() * half.z() * btScalar( 2500 );
		shards.push_back(
			isSoft ? static_cast<btCollisionObject*>( test.addSoft( shapes[k % 3], where, glass ) ) : test.addBox( mass, half, where ) );
		shards.back()->setFriction( btScalar( 0.4 ) );
	}
	for ( int frame = 0; frame < kMostFrames; ++frame )
	{
		test.run( 1 );
		if ( std::none_of( shards.begin(), shards.end(), []( const btCollisionObject* shard ) { return shard->isActive(); } ) )
		{
			return double( frame ) / 60.0;
		}
	}
	return kMostFrames / 60.0;
}

// A shard that crept in a heap lost a contact every few millimetres, fell by a step's gravity over the others, and hit the floor at 2
// rad/s: these heaps took 8.2 s in the mean.
TEST( RigidCrumbs, HeapsOfShardsFallAsleepBeforeThoseOfRigidBoxes )
{
	double soft = 0.0, rigid = 0.0;
	for ( const int seed : { 1, 2, 4, 5 } )
	{
		soft += timeToSleep( true, seed ) / 4.0;
		rigid += timeToSleep( false, seed ) / 4.0;
	}
	EXPECT_LT( soft, 6.0 );
	EXPECT_LT( soft, rigid );
}

} // namespace
} // namespace pliant
