// Wind, water and gravity fields: the law of each, and its misuse.

#include "world/game/hollow_box.h"
#include "world/game/space.h"

#include <pliant/game/forces.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

#include <cmath>
#include <limits>

namespace pliant::test {

namespace {

const btScalar kNaN = std::numeric_limits<btScalar>::quiet_NaN();

btVector3 momentumOf( const SoftBody& body )
{
	return body.mass() * body.linearVelocity();
}

class ForcesOn : public ::testing::TestWithParam<Elasticity>
{};

} // namespace

INSTANTIATE_TEST_SUITE_P( Steps, ForcesOn, ::testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& given ) { return given.param == Elasticity::Explicit ? "Explicit" : "Implicit"; } );

// --- water ------------------------------------------------------------------------------------------------------------------

TEST_P( ForcesOn, ACubeOfHalfTheDensityOfWaterSinksHalfIn )
{
	TestWorld t;
	Water water;
	ASSERT_TRUE( t.world.addForceField( water ).ok() );
	SoftBody* half = t.addSoft( block( 5, 5, 5, 0.2f ), at( 0, 0.3f, 0 ), of( GetParam(), 500 ) );
	SoftBody* quarter = t.addSoft( block( 5, 2, 5, 0.2f ), at( 5, 0, 0 ), of( GetParam(), 250 ) ); // flat: it does not tip over
	SoftBody* heavy = t.addSoft( block( 2, 2, 2, 0.2f ), at( 10, 0, 0 ), of( GetParam(), 2000 ) );
	t.run( 600 );
	btScalar mean = 0; // it still bobs
	for ( int frame = 0; frame < 300; ++frame )
	{
		t.run( 1 );
		mean += half->massCentre().y() / 300;
	}
	EXPECT_NEAR( mean, 0, 0.02 );
	EXPECT_NEAR( quarter->massCentre().y(), 0.1, 0.01 );
	EXPECT_LT( heavy->massCentre().y(), -20 );
	EXPECT_NEAR( quarter->massCentre().x(), 5, 0.02 );
}

TEST( Water, WithoutDragACubeBobsOnWithTheEnergyItHad )
{
	TestWorld t;
	WaterSettings settings;
	settings.drag = 0;
	Water water( settings );
	ASSERT_TRUE( t.world.addForceField( water ).ok() );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.25f ), at( 0, 0.2f, 0 ), of( Elasticity::Explicit, 500, 1e6f ) );
	btScalar high = 0;
	for ( int frame = 0; frame < 600; ++frame )
	{
		t.run( 1 );
		high = frame > 480 ? btMax( high, cube->massCentre().y() ) : high;
	}
	EXPECT_NEAR( high, 0.2, 0.012 );
}

TEST( Water, FullyInItACubeIsPushedUpByTheWaterItDisplacesHoweverItIsTurned )
{
	Space t;
	t.world.setGravity( btVector3( 0, -10, 0 ) );
	WaterSettings settings;
	settings.drag = 0;
	Water water( settings );
	ASSERT_TRUE( t.world.addForceField( water ).ok() );
	SoftBody* cube = t.addSoft(
		block( 4, 4, 4, 0.25f ), btTransform( btQuaternion( 0.3f, 0.5f, 0.7f ), btVector3( 0, -5, 0 ) ), of( Elasticity::Explicit, 800 ) );
	t.run( 1 );
	EXPECT_NEAR( momentumOf( *cube ).y(), 2000 * kFrame, 2000 * kFrame * 0.01 );
	EXPECT_LT( cube->angularVelocity().length(), 1e-3 );
}

TEST( Water, AHollowBodyDisplacesItsCavityUntilItIsCut )
{
	TestWorld t;
	Water water;
	ASSERT_TRUE( t.world.addForceField( water ).ok() );
	SoftBody* ball = t.addSoft( hollowBox( 1, 0.125f ), at( 0, -1, 0 ), of( Elasticity::Explicit, 1000 ) );
	ASSERT_LT( ball->mass(), 850 );
	t.run( 300 );
	EXPECT_GT( ball->massCentre().y(), -0.5 ) << "floats, though its material is as heavy as water";
}

TEST( Water, PiecesFloatAsTheWholeDid )
{
	TestWorld t;
	Water water;
	ASSERT_TRUE( t.world.addForceField( water ).ok() );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.25f ), at( 0, 0, 0 ), of( Elasticity::Explicit, 500 ) );
	EXPECT_GT( cube->cutPlane( btVector3( 0.01f, 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	t.run( 600 );
	ASSERT_EQ( t.world.softBodyCount(), 2 );
	for ( int k = 0; k < 2; ++k )
	{
		EXPECT_NEAR( t.world.softBody( k )->massCentre().y(), 0, 0.06 );
	}
}

TEST( Water, ABodyWithLevelsFloats )
{
	TestWorld t;
	Water water;
	ASSERT_TRUE( t.world.addForceField( water ).ok() );
	Adaptivity adaptivity;
	adaptivity.coarseLevels = 1;
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 1.0f / 6 ), at( 0, 0.2f, 0 ), of( Elasticity::Explicit, 500 ), adaptivity );
	t.run( 600 );
	EXPECT_NEAR( cube->massCentre().y(), 0, 0.04 );
}

TEST( Water, WhatSleepsFeelsANewLevelWhenItIsWoken )
{
	TestWorld t;
	t.addFloor( -2 );
	WaterSettings settings;
	settings.surface = btVector3( 0, -10, 0 );
	Water water( settings );
	ASSERT_TRUE( t.world.addForceField( water ).ok() );
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.2f ), at( 0, -1.7f, 0 ), of( Elasticity::Explicit, 500 ) );
	t.run( 300 );
	ASSERT_FALSE( cube->isActive() );
	settings.surface = btVector3( 0, 0, 0 );
	ASSERT_TRUE( water.set( settings ).ok() );
	t.run( 60 );
	EXPECT_FALSE( cube->isActive() ) << "a change wakes nothing by itself";
	water.wake();
	t.run( 600 );
	btScalar mean = 0; // it still bobs
	for ( int frame = 0; frame < 300; ++frame )
	{
		t.run( 1 );
		mean += cube->massCentre().y() / 300;
	}
	EXPECT_NEAR( mean, 0, 0.03 );
}

// --- wind -------------------------------------------------------------------------------------------------------------------

TEST_P( ForcesOn, WindPushesByTheAreaThatFacesIt )
{
	const std::shared_ptr<const BodyTemplate> shape = block( 6, 3, 3, 0.25f );
	for ( const btScalar turn : { btScalar( 0 ), SIMD_PI / 4, SIMD_HALF_PI } )
	{
		Space t;
		Wind wind( WindSettings{ btVector3( 10, 0, 0 ), btScalar( 1.2 ), btScalar( 0.8 ), 0 } );
		ASSERT_TRUE( t.world.addForceField( wind ).ok() );
		SoftBody* box = t.addSoft(
			shape, btTransform( btQuaternion( btVector3( 0, 1, 0 ), turn ), btVector3( 3, 4, 5 ) ), of( GetParam(), 1000 ) );
		t.run( 1 );
		const double area = 0.75 * ( 0.75 * std::cos( turn ) + 1.5 * std::sin( turn ) );
		const double expected = 0.5 * 1.2 * 0.8 * 100 * area * kFrame;
		// At an edge between a face in the wind and one behind it half a cell is lost.
		EXPECT_NEAR( momentumOf( *box ).x(), expected, ( turn > 0 && turn < 1 ? 0.12 : 0.02 ) * expected ) << turn;
		EXPECT_NEAR( momentumOf( *box ).y(), 0, 0.01 * expected );
	}
}

TEST( Wind, ASheetOfOneLayerCatchesIt )
{
	Space t;
	Wind wind( WindSettings{ btVector3( 0, 0, 10 ), btScalar( 1.2 ), 1, 0 } );
	ASSERT_TRUE( t.world.addForceField( wind ).ok() );
	SoftBody* sheet = t.addSoft( block( 8, 8, 1, 0.1f ), at( 0, 0, 0 ), of( Elasticity::Explicit, 1000 ) );
	t.run( 1 );
	const double expected = 0.5 * 1.2 * 100 * 0.64 * kFrame;
	EXPECT_NEAR( momentumOf( *sheet ).z(), expected, 0.02 * expected );
}

TEST( Wind, LiftPushesASlantedSheetAcrossIt )
{
	Space t;
	Wind wind( WindSettings{ btVector3( 10, 0, 0 ), btScalar( 1.2 ), 0, 1 } );
	ASSERT_TRUE( t.world.addForceField( wind ).ok() );
	SoftBody* sheet = t.addSoft( block( 8, 1, 8, 0.1f ),
		btTransform( btQuaternion( btVector3( 0, 0, 1 ), SIMD_PI / 6 ), btVector3( 0, 0, 0 ) ), of( Elasticity::Explicit, 1000 ) );
	t.run( 1 );
	EXPECT_LT( momentumOf( *sheet ).y(), -0.1 ) << "its upper side is in the wind";
	EXPECT_NEAR( momentumOf( *sheet ).x(), 0, 1e-3 );
}

TEST( Wind, AFallingCubeReachesTheSpeedAtWhichDragIsItsWeight )
{
	TestWorld t;
	Wind air( WindSettings{ btVector3( 0, 0, 0 ), btScalar( 1.2 ), 1, 0 } );
	ASSERT_TRUE( t.world.addForceField( air ).ok() );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.25f ), at( 0, 0, 0 ), of( Elasticity::Explicit, 20 ) );
	t.run( 600 );
	const double expected = std::sqrt( 2 * 20 * kGravity / 1.2 );
	EXPECT_NEAR( -cube->linearVelocity().y(), expected, 0.03 * expected );
}

TEST( Wind, TakesNoPointFasterThanItself )
{
	Space t;
	Wind wind( WindSettings{ btVector3( 100, 0, 0 ), btScalar( 1e4 ), 100, 0 } );
	ASSERT_TRUE( t.world.addForceField( wind ).ok() );
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ), of( Elasticity::Implicit, 10, 1e6f ) );
	for ( int frame = 0; frame < 120; ++frame )
	{
		t.run( 1 );
		ASSERT_LT( cube->linearVelocity().x(), 101 );
	}
	EXPECT_TRUE( cube->isHealthy() );
	EXPECT_GT( cube->linearVelocity().x(), 90 );
}

TEST( Wind, ActsOnNeitherStaticNorPinnedBodiesAndNotAfterItIsGone )
{
	Space t;
	SoftBody* fixed = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	fixed->setCollisionFlags( fixed->getCollisionFlags() | btCollisionObject::CF_STATIC_OBJECT );
	SoftBody* pinned = t.addSoft( block( 3, 3, 3, 0.1f ), at( 5, 0, 0 ) );
	for ( int node = 0; node < pinned->nodeCount(); ++node )
	{
		ASSERT_TRUE( pinned->pinNode( node ).ok() );
	}
	SoftBody* loose = t.addSoft( block( 3, 3, 3, 0.1f ), at( 10, 0, 0 ) );
	{
		Wind wind( WindSettings{ btVector3( 10, 0, 0 ), btScalar( 1.2 ), 1, 0 } );
		ASSERT_TRUE( t.world.addForceField( wind ).ok() );
		t.run( 10 );
	}
	EXPECT_EQ( t.world.forceFieldCount(), 0 );
	EXPECT_EQ( fixed->massCentre().x(), 0 );
	EXPECT_NEAR( pinned->massCentre().x(), 5, 1e-6 );
	const btVector3 velocity = loose->linearVelocity();
	EXPECT_GT( velocity.x(), 0.001 );
	t.run( 10 );
	EXPECT_NEAR( loose->linearVelocity().x(), velocity.x(), 1e-5 );
}

// --- gravity ----------------------------------------------------------------------------------------------------------------

TEST_P( ForcesOn, APlanetPullsSoftAndRigidBodiesAlike )
{
	Space t;
	Planet planet( btVector3( 0, 0, 0 ), 10, 10 );
	ASSERT_TRUE( t.world.addForceField( planet ).ok() );
	SoftBody* soft = t.addSoft( block( 3, 3, 3, 0.1f ), at( 20, 0, 0 ), of( GetParam(), 1000 ) );
	btRigidBody* rigid = t.addBox( 27, btVector3( 0.15f, 0.15f, 0.15f ), at( 0, 20, 0 ) );
	btRigidBody* exempt = t.addBox( 27, btVector3( 0.15f, 0.15f, 0.15f ), at( 0, 0, 20 ) );
	exempt->setFlags( exempt->getFlags() | BT_DISABLE_WORLD_GRAVITY );
	for ( int frame = 0; frame < 40; ++frame )
	{
		t.world.stepSimulation( 3 * kFrame, 3, kFrame ); // forces persist through the three steps of each call
	}
	EXPECT_LT( soft->massCentre().x(), 15 );
	EXPECT_NEAR( soft->massCentre().x(), rigid->getCenterOfMassPosition().y(), 0.05 ) << "explicit bodies take shorter steps";
	EXPECT_EQ( exempt->getCenterOfMassPosition().z(), 20 );
}

TEST( Planet, WhatLiesOnItFallsAsleep )
{
	Space t;
	t.add( 0, new btSphereShape( 10 ), at( 0, 0, 0 ) );
	Planet planet( btVector3( 0, 0, 0 ), 10, 10 );
	ASSERT_TRUE( t.world.addForceField( planet ).ok() );
	SoftBody* soft = t.addSoft(
		block( 3, 3, 3, 0.1f ), btTransform( btQuaternion( btVector3( 0, 0, 1 ), SIMD_HALF_PI ), btVector3( 10.2f, 0, 0 ) ) );
	t.run( 300 );
	EXPECT_FALSE( soft->isActive() );
	EXPECT_NEAR( soft->massCentre().length(), 10.15, 0.03 );
	EXPECT_TRUE( t.world.removeForceField( planet ) );
	EXPECT_TRUE( soft->isActive() ) << "without gravity it need not lie there";
}

TEST( Planet, RigidBodiesFeelItInAWorldWithoutASoftBody )
{
	Space t;
	Planet planet( btVector3( 0, 0, 0 ), 10, 10 );
	ASSERT_TRUE( t.world.addForceField( planet ).ok() );
	btRigidBody* rigid = t.addBox( 27, btVector3( 0.15f, 0.15f, 0.15f ), at( 0, 10, 0 ) );
	t.run( 6 );
	EXPECT_NEAR( rigid->getLinearVelocity().y(), -1, 0.01 );
	t.world.removeRigidBody( rigid );
	t.run( 1 );
	t.world.addRigidBody( rigid );
}

// --- fields in general ------------------------------------------------------------------------------------------------------

TEST( ForceFields, BadSettingsAreRefusedAndTheOldOnesStay )
{
	Wind wind( WindSettings{ btVector3( 1, 0, 0 ), 1, 1, 0 } );
	for ( const WindSettings& bad : { WindSettings{ btVector3( kNaN, 0, 0 ), 1, 1, 0 }, WindSettings{ btVector3( 2000, 0, 0 ), 1, 1, 0 },
			  WindSettings{ btVector3( 1, 0, 0 ), -1, 1, 0 }, WindSettings{ btVector3( 1, 0, 0 ), 1, kNaN, 0 },
			  WindSettings{ btVector3( 1, 0, 0 ), 1, 1, 101 } } )
	{
		EXPECT_EQ( wind.set( bad ).code, ResultCode::BadSettings );
	}
	EXPECT_EQ( wind.settings().velocity.x(), 1 );
	Water water;
	WaterSettings bad;
	bad.up = btVector3( 0, 0, 0 );
	EXPECT_EQ( water.set( bad ).code, ResultCode::BadSettings );
	bad = WaterSettings{};
	bad.density = btScalar( 1e6 );
	EXPECT_EQ( water.set( bad ).code, ResultCode::BadSettings );
	bad = WaterSettings{};
	bad.surface = btVector3( 0, kNaN, 0 );
	EXPECT_EQ( water.set( bad ).code, ResultCode::BadSettings );
	EXPECT_EQ( Planet( btVector3( 0, 0, 0 ), -1, 10 ).acceleration( btVector3( 1, 2, 3 ) ).length(), 0 );
	EXPECT_EQ( Planet( btVector3( 0, 0, 0 ), 1, 10 ).acceleration( btVector3( 0, 0, 0 ) ).length(), 0 );
}

TEST( ForceFields, AFieldIsInOneWorldOnce )
{
	Space t, other;
	Wind wind;
	EXPECT_TRUE( t.world.addForceField( wind ).ok() );
	EXPECT_EQ( t.world.addForceField( wind ).code, ResultCode::BadArgument );
	EXPECT_EQ( other.world.addForceField( wind ).code, ResultCode::BadArgument );
	EXPECT_FALSE( other.world.removeForceField( wind ) );
	EXPECT_TRUE( t.world.removeForceField( wind ) );
	EXPECT_FALSE( t.world.removeForceField( wind ) );
	EXPECT_TRUE( other.world.addForceField( wind ).ok() );
	{
		TestWorld gone;
		EXPECT_TRUE( other.world.removeForceField( wind ) );
		EXPECT_TRUE( gone.world.addForceField( wind ).ok() );
	}
	EXPECT_TRUE( t.world.addForceField( wind ).ok() ) << "it has left with the world";
	wind.wake();
}

/// A field of the game's own: a vortex about the y axis that does not act on some bodies.
struct Whirl : ForceField
{
	Whirl() : ForceField( kAcceleration ) {}
	bool actsOn( const btCollisionObject& object ) const override { return object.getUserIndex() != 7; }
	btVector3 acceleration( const btVector3& position ) const override { return btVector3( 0, 1, 0 ).cross( position ); }
};

TEST( ForceFields, AGameCanWriteItsOwn )
{
	Space t;
	Whirl whirl;
	ASSERT_TRUE( t.world.addForceField( whirl ).ok() );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ), of( Elasticity::Explicit, 1000, 1e6f ) );
	SoftBody* exempt = t.addSoft( block( 4, 4, 4, 0.1f ), at( 5, 0, 0 ) );
	exempt->setUserIndex( 7 );
	t.run( 12 );
	EXPECT_NEAR( cube->angularVelocity().y(), 0.2, 0.01 ) << "the field varies over the body";
	EXPECT_LT( cube->linearVelocity().length(), 1e-5 );
	EXPECT_EQ( exempt->linearVelocity().length(), 0 );
}

TEST( ForceFields, GiveTheSameBitsForAnyNumberOfThreads )
{
	std::vector<btVector3> ends[2];
	for ( int k = 0; k < 2; ++k )
	{
		TestWorld t;
		t.world.setThreadCount( k == 0 ? 1 : 3 );
		Water water;
		Wind wind( WindSettings{ btVector3( 3, 0, 1 ), btScalar( 1.2 ), 1, 1 } );
		ASSERT_TRUE( t.world.addForceField( water ).ok() && t.world.addForceField( wind ).ok() );
		for ( int body = 0; body < 6; ++body )
		{
			t.addSoft( block( 4, 4, 4, 0.1f ), at( btScalar( body ), 0.1f, 0 ), of( Elasticity::Explicit, 400 ) );
		}
		t.run( 60 );
		for ( const auto& body : t.soft )
		{
			for ( int node = 0; node < body->nodeCount(); ++node )
			{
				ends[k].push_back( body->nodePosition( node ) );
			}
		}
	}
	EXPECT_TRUE( ends[0] == ends[1] );
}

} // namespace pliant::test
