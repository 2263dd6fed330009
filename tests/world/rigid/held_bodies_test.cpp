// Pinned bodies with Material::rigidStrain: at rest they are as static as a static rigid body, until a load deforms them.

#include "body/rigid_state.h"
#include "support/snapshots.h"
#include "world/bodies/soft_body_impl.h"
#include "world/test_world.h"

#include <cmath>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::lowestNode;
using test::TestWorld;

constexpr float kCell = 0.1f;

Material shelfMaterial( float rigidStrain )
{
	Material material = test::stiff( 1e7f );
	material.density = 500.0f;
	material.rigidStrain = rigidStrain;
	return material;
}

/// A shelf of 12 x 2 x 4 cells, 24 kg, whose left end is in a wall: two columns of nodes.
SoftBody* addShelf( TestWorld& test, float rigidStrain = 0.01f, float youngsModulus = 1e7f )
{
	Material material = shelfMaterial( rigidStrain );
	material.youngsModulus = youngsModulus;
	SoftBody* const shelf = test.addSoft( block( 12, 2, 4, kCell ), at( 0, 1, 0 ), material );
	EXPECT_EQ( shelf->pinNodesInside( btVector3( -1, 0, -1 ), btVector3( btScalar( -0.4 ), 2, 1 ) ), 2 * 8 );
	return shelf;
}

/// A rod of 1 x 6 x 1 cells that hangs by its topmost node.
SoftBody* addHanging( TestWorld& test )
{
	SoftBody* const rod = test.addSoft( block( 1, 6, 1, kCell ), at( 0, 1, 0 ), shelfMaterial( 0.01f ) );
	EXPECT_EQ( rod->pinNodesInside( btVector3( -1, btScalar( 1.2 ), -1 ), btVector3( 1, 2, 1 ) ), 1 );
	return rod;
}

bool isHeld( const SoftBody& body )
{
	const RigidState* const state = body.impl().body->rigidState();
	return state && state->isHeld;
}

// A held body is static to others: a body that stays awake on it does not keep it awake.
TEST( HeldBodies, AShelfSleepsUnderABodyThatStaysAwake )
{
	TestWorld test;
	SoftBody* const shelf = addShelf( test );
	test.run( 60 );
	btRigidBody* const box = test.addBox( btScalar( 0.5 ), btVector3( 0.1f, 0.1f, 0.1f ), at( -0.2f, 1.197f, 0 ) );
	box->setActivationState( DISABLE_DEACTIVATION );
	test.run( 300 );
	EXPECT_FALSE( shelf->isActive() );
	EXPECT_TRUE( shelf->isRigid() );
	EXPECT_NEAR( box->getCenterOfMassPosition().y(), 1.2, 0.02 );
}

TEST( HeldBodies, AShelfAndItsLoadFallAsleepAsOnARigidShelf )
{
	btScalar height[2];
	for ( const bool isSoft : { false, true } )
	{
		TestWorld test;
		SoftBody* const shelf = isSoft ? addShelf( test ) : nullptr;
		if ( !isSoft )
		{
			test.addBox( 0, btVector3( btScalar( 0.6 ), btScalar( 0.1 ), btScalar( 0.2 ) ), at( 0, 1, 0 ) );
		}
		test.run( 60 );
		btRigidBody* const box = test.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( -0.2f, 1.197f, 0 ) );
		test.run( 300 );
		height[isSoft] = box->getWorldTransform().getOrigin().y();
		EXPECT_FALSE( box->isActive() );
		if ( shelf )
		{
			EXPECT_TRUE( shelf->isRigid() );
			EXPECT_TRUE( isHeld( *shelf ) );
			EXPECT_FALSE( shelf->isActive() );
		}
	}
	EXPECT_NEAR( height[1], height[0], 0.1 * kCell ); // the sag of the shelf
}

TEST( HeldBodies, ALoadBendsThem )
{
	btScalar sag[2];
	for ( const bool canBeRigid : { false, true } )
	{
		TestWorld test;
		SoftBody* const shelf = addShelf( test, canBeRigid ? 0.01f : 0.0f );
		test.run( 120 );
		EXPECT_EQ( shelf->isRigid(), canBeRigid );
		test.addBox( 80, btVector3( 0.1f, 0.1f, 0.2f ), at( 0.48f, 1.201f, 0 ) );
		test.run( 60 );
		sag[canBeRigid] = 1 - lowestNode( *shelf ) - btScalar( 0.05 );
		EXPECT_GT( sag[canBeRigid], 0.3 * kCell );
	}
	EXPECT_NEAR( sag[1], sag[0], 0.2 * sag[0] );
}

TEST( HeldBodies, AnImpactBreaksThemAsIfTheyHadNeverBeenRigid )
{
	int pieces[2];
	for ( const bool canBeRigid : { false, true } )
	{
		TestWorld test;
		SoftBody* const shelf = addShelf( test, canBeRigid ? 0.01f : 0.0f );
		Fracture fracture;
		fracture.rule = BreakRule::Shards;
		fracture.breakStrain = 0.01f;
		fracture.shardSize = 0.3f;
		ASSERT_TRUE( shelf->setFracture( fracture ).ok() );
		test.run( 120 );
		EXPECT_EQ( shelf->isRigid(), canBeRigid );
		test.addBox( 20, btVector3( 0.1f, 0.1f, 0.1f ), at( 0.3f, 1.5f, 0 ) )->setLinearVelocity( btVector3( 0, -10, 0 ) );
		test.run( 15 );
		pieces[canBeRigid] = test.world.softBodyCount();
		EXPECT_GT( pieces[canBeRigid], 1 );
	}
	EXPECT_NEAR( pieces[1], pieces[0], 1 );
}

TEST( HeldBodies, FallWhenTheirPinsAreReleased )
{
	TestWorld test;
	SoftBody* const shelf = addShelf( test );
	test.run( 240 );
	ASSERT_TRUE( shelf->isRigid() && !shelf->isActive() );
	for ( int node = 0; node < shelf->nodeCount(); ++node )
	{
		shelf->releaseNode( node );
	}
	test.run( 30 );
	EXPECT_NEAR( shelf->massCentre().y(), 1 - 0.5 * test::kGravity * 0.25, 0.1 );
}

TEST( HeldBodies, FollowTheBodyThatTheyArePinnedTo )
{
	TestWorld test;
	btRigidBody* const wall = test.addBox( 0, btVector3( 0.1f, 0.5f, 0.5f ), at( -0.72f, 1, 0 ) );
	SoftBody* const shelf = test.addSoft( block( 12, 2, 4, kCell ), at( 0, 1, 0 ), shelfMaterial( 0.01f ) );
	for ( int node = 0; node < shelf->nodeCount(); ++node )
	{
		EXPECT_TRUE( shelf->nodePosition( node ).x() > btScalar( -0.4 ) || shelf->pinNodeToBody( node, wall ).ok() );
	}
	test.run( 240 );
	ASSERT_TRUE( shelf->isRigid() && !shelf->isActive() );
	shelf->activate();
	for ( int frame = 1; frame <= 50; ++frame )
	{
		wall->setWorldTransform( at( -0.72f, 1 + btScalar( 0.001 ) * btScalar( frame ), 0 ) );
		test.run( 1 );
	}
	EXPECT_NEAR( shelf->massCentre().y(), 1.05, 0.02 );
	test.run( 180 );
	EXPECT_NEAR( shelf->massCentre().y(), 1.05, 0.02 );
	EXPECT_TRUE( shelf->isRigid() );
}

TEST( HeldBodies, APushMakesThemSwing )
{
	for ( const int way : { 0, 1, 2 } )
	{
		TestWorld test;
		SoftBody* const shelf = addShelf( test );
		test.run( 240 );
		ASSERT_TRUE( isHeld( *shelf ) && !shelf->isActive() );
		const btScalar before = lowestNode( *shelf );
		if ( way == 0 )
		{
			EXPECT_TRUE( shelf->applyCentralImpulse( btVector3( 0, -shelf->mass(), 0 ) ).ok() );
		}
		else
		{
			EXPECT_TRUE( way == 1 ? shelf->setGravity( btVector3( 0, -50, 0 ) ).ok()
								  : shelf->setVelocities( btVector3( 0, -1, 0 ), btVector3( 0, 0, 0 ) ).ok() );
		}
		btScalar lowest = before;
		for ( int frame = 0; frame < 15; ++frame )
		{
			test.run( 1 );
			lowest = btMin( lowest, lowestNode( *shelf ) );
		}
		EXPECT_LT( lowest, before - 0.1 * kCell ) << way;
	}
}

// A body pinned at one node, or along a row, can rotate there: it is not held, and falls asleep while it is deformable.
TEST( HeldBodies, BodiesPinnedAtOneNodeSwingAndFallAsleep )
{
	TestWorld test;
	SoftBody* const rod = addHanging( test );
	test.run( 240 );
	EXPECT_FALSE( rod->isRigid() || rod->isActive() );
	test.addBox( 2, btVector3( 0.05f, 0.05f, 0.05f ), at( -0.12f, 0.8f, 0 ) )->setLinearVelocity( btVector3( 2, 0, 0 ) );
	test.run( 20 );
	EXPECT_GT( rod->nodePosition( 0 ).x(), 0.1 );
}

// A soft cube that steps explicitly had drawn the shelf below it into its substeps. A crate beside the cube was then in no pass with its
// contacts in every other step, fell for that step, and sank through the shelf.
TEST( HeldBodies, CarryCratesBesideBodiesThatTakeSubsteps )
{
	TestWorld test;
	SoftBody* const shelf = addShelf( test );
	btRigidBody* const crate = test.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( -0.3f, 1.2f, 0 ) );
	SoftBody* const cube = test.addSoft( block( 3, 3, 3, 0.08f ), at( 0.1f, 1.22f, 0 ), test::stiff( 1e5f ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	crate->setActivationState( DISABLE_DEACTIVATION );
	test.run( 300 );
	ASSERT_TRUE( isHeld( *shelf ) );
	const btScalar height = crate->getCenterOfMassPosition().y();
	for ( int frame = 0; frame < 120; ++frame )
	{
		test.run( 1 );
		ASSERT_TRUE( isHeld( *shelf ) );
		ASSERT_GT( test.world.stepReport().substeps, 1 );
		EXPECT_NEAR( crate->getLinearVelocity().y(), 0, 0.01 ) << frame;
		EXPECT_NEAR( crate->getCenterOfMassPosition().y(), height, 1e-3 ) << frame;
	}
}

TEST( HeldBodies, AreRestoredFromASnapshot )
{
	TestWorld test;
	SoftBody* const shelf = addShelf( test );
	for ( int frame = 0; frame < 240 && !( shelf->isRigid() ); ++frame )
	{
		test.run( 1 );
	}
	ASSERT_TRUE( isHeld( *shelf ) );
	const test::Bytes saved = test::savedWorld( test.world );
	test.addBox( 5, btVector3( 0.1f, 0.1f, 0.1f ), at( 0.3f, 1.3f, 0 ) );
	test.run( 20 );
	EXPECT_FALSE( shelf->isRigid() );
	test.world.removeRigidBody( test.rigid.back().get() );
	test.rigid.pop_back();
	const auto restored = restoreWorld( test.world, saved );
	ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
	ASSERT_TRUE( isHeld( *shelf ) );
	const btVector3 before = shelf->massCentre();
	test.run( 20 );
	EXPECT_TRUE( shelf->isRigid() );
	EXPECT_EQ( shelf->massCentre(), before );
}

} // namespace
} // namespace pliant
