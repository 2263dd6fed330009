// Bodies at rest fall asleep, fragments and bodies on terrain too; moving ones do not, however slow. Compared with rigid ones, which sleep
// by Bullet's rules.

#include "support/awake_bodies.h"
#include "support/mesh_of_boxes.h"
#include "support/test_world.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace pliant;
using namespace pliant::test;

/// Returns the seconds until all bodies sleep, at most `most`.
double asleepAfter( SoftWorld& t, double most )
{
	int frames = 0;
	for ( ; frames < int( most * 60 ) && awakeBodies( t.world ) > 0; ++frames )
	{
		t.step( 1 );
	}
	return frames / 60.0;
}

// A block cut into single cells. The residual errors of a solver of ten iterations keep a heap of points in motion, so that of two hundred
// one is always faster than 3 cm/s, and bodies in contact sleep together or not at all.
TEST( FallsAsleep, ABlockCutIntoSingleCells )
{
	for ( const Elasticity elasticity : kSteps )
	{
		SoftWorld t;
		t.addFloor();
		SoftBody* const block = t.add( cubeTemplate( 0.4f, 4 ), btVector3( 0, btScalar( 0.2 ), 0 ), materialOf( elasticity, 2e5f ) );
		for ( int k = 1; k < 4; ++k )
		{
			for ( int axis = 0; axis < 3; ++axis )
			{
				btVector3 normal( 0, 0, 0 );
				normal[axis] = 1;
				block->cutPlane( btVector3( 0, btScalar( 0.2 ), 0 ) + normal * btScalar( 0.1 * k - 0.2 ), normal );
			}
		}
		t.step( 1 );
		ASSERT_EQ( t.world.softBodyCount(), 64 );
		EXPECT_LT( asleepAfter( t, 15 ), 15 );
	}
}

// Six cubes on a wavy heightfield.
TEST( FallsAsleep, CubesOnAWavyHeightfield )
{
	constexpr int kPosts = 41;
	std::vector<float> heights( kPosts * kPosts );
	for ( int k = 0; k < kPosts * kPosts; ++k )
	{
		heights[std::size_t( k )] = 0.25f * std::sin( 0.6f * float( k % kPosts ) ) + 0.2f * std::cos( 0.7f * float( k / kPosts ) );
	}
	for ( const Elasticity elasticity : kSteps )
	{
		for ( const float youngsModulus : { 2e4f, 2e5f } )
		{
			SoftWorld t;
			auto* const field = new btHeightfieldTerrainShape( kPosts, kPosts, heights.data(), btScalar( -1 ), btScalar( 1 ), 1, false );
			field->setLocalScaling( btVector3( btScalar( 0.5 ), 1, btScalar( 0.5 ) ) );
			t.WorldOf<SoftBodyWorld>::add( 0, field, btVector3( 0, 0, 0 ) );
			const auto made = cubeTemplate( 0.5f, 5 );
			for ( int k = 0; k < 6; ++k )
			{
				t.add( made,
					btVector3(
						btScalar( k % 3 - 1 ) * btScalar( 1.3 ), btScalar( 1.5 ), btScalar( k / 3 ) * btScalar( 1.3 ) - btScalar( 0.6 ) ),
					materialOf( elasticity, youngsModulus ), btQuaternion( btVector3( 0, 1, 0 ), btScalar( 0.4 * k ) ) );
			}
			EXPECT_LT( asleepAfter( t, 15 ), 15 ) << youngsModulus;
		}
	}
}

/// A soft cube of half a metre and a rigid one 3 m beside it, with the same motion.
struct Twins : SoftWorld
{
	SoftBody* softOne = nullptr;
	btRigidBody* rigidOne = nullptr;
	btVector3 softFrom, rigidFrom;

	Twins( Elasticity elasticity, btScalar height, const btVector3& velocity, const btVector3& gravity )
	{
		world.setGravity( gravity );
		btRigidBody* const floor = addFloor();
		floor->setFriction( 0 );
		softOne = add( cubeTemplate( 0.5f, 5 ), btVector3( 0, height, 0 ), materialOf( elasticity, 1e5f ) );
		rigidOne = WorldOf<SoftBodyWorld>::add( 125, new btBoxShape( btVector3( 1, 1, 1 ) * btScalar( 0.25 ) ), btVector3( 0, height, 3 ) );
		EXPECT_TRUE( softOne->setLinearVelocity( velocity ).ok() );
		rigidOne->setLinearVelocity( velocity );
		softFrom = softOne->massCentre();
		rigidFrom = rigidOne->getCenterOfMassPosition();
	}
	btScalar softDistance() const { return ( softOne->massCentre() - softFrom ).length(); }
	btScalar rigidDistance() const { return ( rigidOne->getCenterOfMassPosition() - rigidFrom ).length(); }
};

// On ice at 6 cm/s, for ten seconds. Bullet puts the rigid one to sleep after two.
TEST( FallsAsleep, NothingThatSlidesSlowly )
{
	for ( const Elasticity elasticity : kSteps )
	{
		Twins t( elasticity, btScalar( 0.25 ), btVector3( btScalar( 0.06 ), 0, 0 ), btVector3( 0, btScalar( -9.81 ), 0 ) );
		t.softOne->setFriction( 0 );
		t.rigidOne->setFriction( 0 );
		t.step( 600 );
		EXPECT_NEAR( t.softDistance(), 0.6, 0.03 );
		EXPECT_GE( t.softDistance(), 0.95 * t.rigidDistance() );
	}
}

// Thrown up on a small moon, at the top it is slower than 3 cm/s for three seconds. It must come down again as thrown.
TEST( FallsAsleep, NothingAtItsTurningPoint )
{
	for ( const Elasticity elasticity : kSteps )
	{
		Twins t( elasticity, 1, btVector3( 0, btScalar( 0.05 ), 0 ), btVector3( 0, btScalar( -0.02 ), 0 ) );
		t.step( 300 ); // 0.05 * 5 - 0.02 * 5^2 / 2 = 0
		EXPECT_NEAR( t.softOne->massCentre().y(), t.softFrom.y(), 0.005 );
		EXPECT_NEAR( t.softOne->linearVelocity().y(), -0.05, 0.002 );
		EXPECT_TRUE( t.softOne->isActive() );
	}
}

/// Measures the height of its centre of mass relative to that at rest, m, lowest first, and the longest time it slept, s.
TEST( FallsAsleep, NothingThatSwings )
{
	for ( const Elasticity elasticity : kSteps )
	{
		// A bar of 2 m, hung by the cells of one end, released at a tenth of a radian: the period is two and a half seconds.
		SoftWorld t;
		SoftBody* const bar = t.add( boxTemplate( { 2.0f, 0.2f, 0.2f }, 0.2f ), btVector3( 0, 0, 0 ), materialOf( elasticity, 2e6f ),
			btQuaternion( btVector3( 0, 0, 1 ), btScalar( -SIMD_HALF_PI + 0.1 ) ) );
		int end = 0;
		for ( int i = 0; i < bar->nodeCount(); ++i )
		{
			end = bar->nodePosition( i ).y() > bar->nodePosition( end ).y() ? i : end;
		}
		ASSERT_TRUE( bar->pinNode( end ).ok() );
		for ( int frame = 0; frame < 900; ++frame )
		{
			t.step( 1 );
			ASSERT_TRUE( bar->isActive() || frame > 600 ) << frame;
		}
	}
}

} // namespace
