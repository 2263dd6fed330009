// Soft bodies at rest on other bodies, and other bodies at rest on them.

#include "world/test_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::stiff;
using test::TestWorld;

TEST( Resting, CubeRestsOnABoxAndOnAPlaneAndSleepsAsAWhole )
{
	for ( const bool onPlane : { false, true } )
	{
		TestWorld t;
		onPlane ? t.addPlane() : t.addFloor();
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.5 ), 0 ) );
		t.run( 500 );
		EXPECT_EQ( cube->getActivationState(), ISLAND_SLEEPING );
		EXPECT_NEAR( test::lowestNode( *cube ), cube->nodeRadius( 0 ), 0.002 );
		EXPECT_GT( cube->massCentre().y(), btScalar( 0.26 ) );
		const btVector3 before = cube->nodePosition( 100 );
		t.run( 60 );
		EXPECT_EQ( ( cube->nodePosition( 100 ) - before ).length(), 0 ); // asleep: bit-identical
		EXPECT_EQ( t.world.stepReport().substeps, 1 );
	}
}

TEST( Resting, WakesWhenTheFloorIsTakenAway )
{
	TestWorld t;
	btRigidBody* floor = t.addFloor();
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.21 ), 0 ) );
	t.run( 400 );
	ASSERT_FALSE( cube->isActive() );
	t.world.removeRigidBody( floor );
	t.run( 60 );
	EXPECT_NEAR( cube->linearVelocity().y(), -9.81, 0.3 );
	t.world.addRigidBody( floor );
}

TEST( Resting, WakesWhenARigidBodyHitsIt )
{
	TestWorld t;
	t.addFloor();
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.21 ), 0 ) );
	t.run( 400 );
	ASSERT_FALSE( cube->isActive() );
	btRigidBody* box = t.addBox( 20, btVector3( 0.1f, 0.1f, 0.1f ), at( -1, btScalar( 0.2 ), 0 ) );
	box->setLinearVelocity( btVector3( 5, 1, 0 ) );
	t.run( 30 );
	EXPECT_TRUE( cube->isActive() );
	EXPECT_GT( cube->linearVelocity().x(), btScalar( 0.1 ) );
}

/// Returns the acceleration down a slope of 20 degrees over the third and fourth second, m/s^2.
double slideAtRest( btScalar friction, int substeps = 4 )
{
	TestWorld t;
	const double slope = 20.0 / 180.0 * SIMD_PI;
	t.world.setGravity( btVector3( btScalar( 9.81 * std::sin( slope ) ), btScalar( -9.81 * std::cos( slope ) ), 0 ) );
	t.addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) )->setFriction( 1 );
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ) );
	cube->setFriction( friction );
	cube->setActivationState( DISABLE_DEACTIVATION );
	t.world.setSoftSubsteps( substeps );
	t.run( 120 );
	const btScalar before = cube->linearVelocity().x();
	t.run( 120 );
	return double( cube->linearVelocity().x() - before ) / 2.0;
}

TEST( Resting, SlidesLikeARigidBoxAndHoldsAtTheFrictionAngle )
{
	// a = g ( sin 20 - mu cos 20 ); tan 18 = 0.325, tan 22 = 0.404: within two degrees of the angle it slides below and holds above.
	const double slope = 20.0 / 180.0 * SIMD_PI;
	EXPECT_NEAR( slideAtRest( btScalar( 0.25 ) ), 9.81 * ( std::sin( slope ) - 0.25 * std::cos( slope ) ), 0.02 );
	EXPECT_NEAR( slideAtRest( btScalar( 0.325 ) ), 9.81 * ( std::sin( slope ) - 0.325 * std::cos( slope ) ), 0.02 );
	EXPECT_NEAR( slideAtRest( btScalar( 0.404 ) ), 0.0, 0.003 );
}

TEST( Resting, TwoStackedCubesStandAndSleep )
{
	TestWorld t;
	t.addFloor();
	const auto shape = block( 6, 6, 6, 0.1f );
	SoftBody* low = t.addSoft( shape, at( 0, btScalar( 0.31 ), 0 ) );
	SoftBody* high = t.addSoft( shape, at( btScalar( 0.02 ), btScalar( 0.93 ), btScalar( 0.01 ) ) );
	t.run( 700 );
	EXPECT_EQ( low->getActivationState(), ISLAND_SLEEPING );
	EXPECT_EQ( high->getActivationState(), ISLAND_SLEEPING );
	EXPECT_GT( high->massCentre().y(), btScalar( 0.75 ) );
	EXPECT_NEAR( high->massCentre().x(), 0.02, 0.05 );
}

struct Loaded
{
	double strain, tilt, penetration;
	int substeps;
	bool reachable;
};

/// A box `ratio` times as heavy as a cube, on the cube, with a modulus that gives a strain of `strain` under it.
Loaded load( double ratio, double strain )
{
	TestWorld t;
	t.addFloor();
	const auto shape = block( 6, 6, 6, 0.1f );
	const double mass = 216.0, area = 0.36, length = 0.6;
	Material material = stiff( float( ratio * mass * 9.81 / area / strain ) );
	SoftBody* cube = t.addSoft( shape, at( 0, btScalar( 0.3 ), 0 ), material );
	t.run( 300 );
	// Nodes are ordered by z, then y, then x: the top layer is y = 5 in every z.
	const auto topOf = [&] {
		double top = 0.0;
		for ( int k = 0; k < 36; ++k )
		{
			top += double( cube->nodePosition( k / 6 * 36 + 30 + k % 6 ).y() ) / 36.0;
		}
		return top;
	};
	const double unloaded = topOf();
	btRigidBody* box = t.addBox(
		btScalar( ratio * mass ), btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( unloaded + 0.05 + 0.3 + 0.001 ), 0 ) );
	box->setActivationState( DISABLE_DEACTIVATION );
	t.run( 1500 );
	Loaded loaded;
	loaded.strain = ( unloaded - topOf() ) / length;
	loaded.tilt = double( btAcos( box->getWorldTransform().getBasis()[1].y() ) ) * 180.0 / SIMD_PI;
	loaded.penetration = 0.0;
	for ( int i = 0; i < cube->nodeCount(); ++i )
	{
		const btVector3 inBox = box->getWorldTransform().invXform( cube->nodePosition( i ) );
		if ( btFabs( inBox.x() ) < btScalar( 0.3 ) && btFabs( inBox.z() ) < btScalar( 0.3 ) )
		{
			loaded.penetration = std::max( loaded.penetration, double( inBox.y() + btScalar( 0.3 ) + cube->nodeRadius( i ) ) );
		}
	}
	loaded.substeps = t.world.stepReport().substeps;
	loaded.reachable = cube->stiffnessPlan().reachable;
	std::printf( "load %gx: strain %.4f of %.4f, tilt %.2f degrees, penetration %.4f m, %d substeps, %.3f ms a step\n", ratio,
		loaded.strain, strain, loaded.tilt, loaded.penetration, loaded.substeps, t.world.stepReport().total * 1e3 );
	return loaded;
}

TEST( Resting, CarriesABoxOfItsOwnMassAndOfTenTimesAsMuch )
{
	for ( const double ratio : { 1.0, 10.0 } )
	{
		const Loaded loaded = load( ratio, 0.05 );
		EXPECT_NEAR( loaded.strain, 0.05, 0.3 * 0.05 );
		EXPECT_LT( loaded.tilt, 2.0 );
		EXPECT_LT( loaded.penetration, 0.01 );
		EXPECT_TRUE( loaded.reachable );
	}
}

TEST( Resting, NoNodeEverGoesThroughAPlane )
{
	for ( const btScalar speed : { btScalar( 20 ), btScalar( 100 ) } )
	{
		TestWorld t;
		t.addPlane();
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ),
			btTransform( btQuaternion( btScalar( 0.3 ), btScalar( 0.2 ), btScalar( 0.1 ) ), btVector3( 0, 3, 0 ) ) );
		EXPECT_TRUE( cube->setLinearVelocity( btVector3( 0, -speed, 0 ) ).ok() );
		btScalar lowest = 1;
		for ( int k = 0; k < 240; ++k )
		{
			t.run( 1 );
			lowest = btMin( lowest, test::lowestNode( *cube ) );
		}
		// 0.05 is a sphere's radius; nodes that such an impact presses into one another are held at a quarter of it.
		EXPECT_GT( lowest, speed < 50 ? btScalar( 0.04 ) : btScalar( 0.012 ) ) << "at " << speed << " m/s";
		EXPECT_TRUE( cube->isHealthy() );
		EXPECT_LT( cube->massCentre().y(), btScalar( 3 ) );
	}
}

/// Ten thousand times its mass is more than a body can bear; its nodes must not be moved through the floor, a little in each step, by
/// Bullet's split impulse.
TEST( Resting, CrushedBodiesStayAboveTheFloor )
{
	TestWorld t;
	t.addPlane();
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.115f ), at( 0, btScalar( 0.2875 ), 0 ), stiff( 5.7e4f ) );
	btRigidBody* box = t.addBox( btScalar( 1e4 ) * cube->mass(), btVector3( 0.29f, 0.145f, 0.29f ), at( 0, btScalar( 0.575 + 0.146 ), 0 ) );
	box->setActivationState( DISABLE_DEACTIVATION );
	btScalar lowest = 1;
	for ( int k = 0; k < 120; ++k )
	{
		t.run( 1 );
		lowest = btMin( lowest, test::lowestNode( *cube ) );
	}
	EXPECT_GT( lowest, 0 );
	EXPECT_LT( box->getWorldTransform().getOrigin().y(), btScalar( 0.3 ) ) << "it was not crushed, so the test shows nothing";
	EXPECT_TRUE( cube->isHealthy() );
}

TEST( Resting, LongStepsWithOneSubstepAreReportedAndStayAboveThePlane )
{
	TestWorld t;
	t.addPlane();
	t.world.setSoftSubsteps( 1 );
	t.world.setMaxSoftSubsteps( 1 );
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.4 ), 0 ) );
	for ( int k = 0; k < 50; ++k )
	{
		t.world.stepSimulation( btScalar( 0.1 ), 0 );
		EXPECT_EQ( t.world.stepReport().substeps, 1 );
	}
	// Ten steps a second reach 0.7 kPa, where the cube weighs 6 kPa: it lies flat, and the report says why.
	EXPECT_GT( test::lowestNode( *cube ), btScalar( 0.04 ) );
	EXPECT_TRUE( cube->isHealthy() );
	EXPECT_FALSE( cube->stiffnessPlan().reachable );
	EXPECT_EQ( t.world.stepReport().unreachableStiffness, 1 );
	EXPECT_GT( cube->stiffnessPlan().substepsNeeded, 1 );
}

// Asleep a body takes one substep, and was reported as softer than its modulus.
TEST( Resting, SleepingBodiesAreNotOutOfReach )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Automatic } )
	{
		TestWorld t;
		t.addFloor();
		Material material = stiff( 2e5f );
		material.elasticity = elasticity;
		SoftBody* const cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.31 ), 0 ), material );
		t.run( 10 );
		EXPECT_EQ( t.world.stepReport().unreachableStiffness, 0 );
		t.run( 500 );
		ASSERT_EQ( cube->getActivationState(), ISLAND_SLEEPING );
		EXPECT_EQ( t.world.stepReport().unreachableStiffness, 0 );
	}
}

// All contacts of a cube of 1e8 Pa that fell flat by .21 m released in a pass that was taken for the last: the cube was crushed between the
// floor and itself, and rose by 9 m. It depended on how far above the floor the last step before the impact ended.
TEST( Resting, StiffCubesThatFallFlatAreNotThrownUp )
{
	struct Fall
	{
		int cells;
		float edge, youngsModulus;
		btScalar height;
	};
	std::vector<Fall> falls{
		{ 6, 0.05f, 1e6f, btScalar( 0.371 ) }, { 6, 0.05f, 1e7f, btScalar( 0.371 ) }, { 6, 0.1f, 1e8f, btScalar( 0.95 ) } };
	for ( int k = 0; k < 10; ++k )
	{
		falls.push_back( { 8, 0.2f, 1e8f, btScalar( 0.2 ) + btScalar( 0.003 ) * k } );
	}
	for ( const Fall& fall : falls )
	{
		TestWorld t;
		t.addFloor();
		Material material;
		material.youngsModulus = fall.youngsModulus;
		const btScalar rest = btScalar( fall.edge ) / 2;
		SoftBody* const cube = t.addSoft(
			block( fall.cells, fall.cells, fall.cells, fall.edge / float( fall.cells ) ), at( 0, rest + fall.height, 0 ), material );
		btScalar highest = 0;
		bool hasLanded = false;
		for ( int k = 0; k < 90; ++k )
		{
			t.run( 1 );
			hasLanded = hasLanded || cube->linearVelocity().y() > btScalar( -0.1 ) * std::sqrt( fall.height );
			highest = hasLanded && k > 5 ? std::max( highest, cube->massCentre().y() - rest ) : highest;
		}
		EXPECT_LT( highest, 0.1 * fall.height ) << fall.edge << " m, " << fall.youngsModulus << " Pa, from " << fall.height << " m";
	}
}

} // namespace
} // namespace pliant
