// Implicit bodies that rotate.

#include "test_meshes.h"
#include "world/test_world.h"

#include "support/energy_of_motion.h"
#include "support/momentum.h"

#include <algorithm>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

Material stiffMaterial()
{
	Material material;
	material.density = 2000.0f;
	material.youngsModulus = 2e8f;
	material.elasticity = Elasticity::Implicit;
	return material;
}

/// The largest distance of two of a body's nodes over that at the start, less 1.
double stretchOf( const SoftBody& body, double length )
{
	double longest = 0.0;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		for ( int k = 0; k < i; ++k )
		{
			longest = std::max( longest, double( body.nodePosition( i ).distance( body.nodePosition( k ) ) ) );
		}
	}
	return longest / length - 1.0;
}

// Positions went along tangents: a bar of 2e8 Pa was stretched by .014 at 10 rad/s and 1/60 s, and by .054 at 1/30 s, where the centrifugal
// force stretches it by 3e-4, and it lost a tenth of its rotation in three seconds.
TEST( ImplicitTurning, ABarIsNotStretchedAndKeepsItsRotation )
{
	for ( const int rate : { 30, 60 } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* const bar = t.addSoft( test::block( 12, 3, 3, 1.0f / 6 ), at( 0, 0, 0 ), stiffMaterial() );
		const double length = stretchOf( *bar, 1.0 ) + 1.0;
		ASSERT_TRUE( bar->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, 0, 10 ) ).ok() );
		const test::Momentum before = test::momentumOf( *bar );
		double most = 0.0;
		for ( int frame = 0; frame < 3 * rate; ++frame )
		{
			t.world.stepSimulation( btScalar( 1 ) / btScalar( rate ), 0 );
			most = std::max( most, stretchOf( *bar, length ) );
		}
		const test::Momentum after = test::momentumOf( *bar );
		const double theory = 2000.0 * 100.0 / ( 2.0 * 2e8 ); // rho w^2 l^2 / ( 2 E ) in the middle, l half of its length
		const double spin = double( bar->angularVelocity().z() );
		std::printf(
			"1/%d s: stretched by %.5f at most, in theory by %.5f in the middle; turns at %.3f rad/s\n", rate, most, theory, spin );
		EXPECT_LT( most, 2.0 * theory );
		EXPECT_NEAR( spin, 10.0, 0.1 );
		EXPECT_LT( double( ( after.angular - before.angular ).length() / before.angular.length() ), 1e-4 );
	}
}

// Panes and sticks of one cell went along tangents at any stiffness, as if they had no thickness: a pane was stretched by .007 at 10 rad/s
// and by .15 at 48 rad/s, and lost .01 and .31 of its rotation in a second.
TEST( ImplicitTurning, PanesAndSticksOfOneCellAreNotStretched )
{
	for ( const int width : { 1, 20 } )
	{
		for ( const double perStep : { 0.1, 0.17, 0.8 } )
		{
			TestWorld t;
			t.world.setGravity( btVector3( 0, 0, 0 ) );
			Material material = stiffMaterial();
			material.youngsModulus = 2e9f;
			SoftBody* const pane = t.addSoft( test::block( 20, width, 1, 0.03f ), at( 0, 0, 0 ), material );
			const double length = stretchOf( *pane, 1.0 ) + 1.0;
			ASSERT_TRUE( pane->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, btScalar( 60.0 * perStep ), 0 ) ).ok() );
			double most = 0.0;
			for ( int frame = 0; frame < 60; ++frame )
			{
				t.world.stepSimulation( btScalar( 1 ) / 60, 0 );
				most = std::max( most, stretchOf( *pane, length ) );
			}
			EXPECT_LT( most, 1e-4 ) << width << " cells wide, " << perStep << " rad a step";
			EXPECT_NEAR( double( pane->angularVelocity().length() ), 60.0 * perStep, 0.06 * perStep );
		}
	}
}

// A ball that nothing touched broke into 8 pieces at 8 rad/s.
TEST( ImplicitTurning, ABrittleBallDoesNotBreakInFlight )
{
	LatticeSettings settings;
	settings.cellSize = 0.1f;
	const auto shape = BodyTemplate::build( test::makeSphere( 0.4, 24, 48 ).view(), settings ).value;
	ASSERT_NE( shape, nullptr );
	for ( const int rate : { 30, 60 } )
	{
		TestWorld t;
		Material material = stiffMaterial();
		material.youngsModulus = 1e9f;
		SoftBody* const ball = t.addSoft( shape, at( 0, 0, 0 ), material );
		Fracture fracture;
		fracture.rule = BreakRule::Shards;
		fracture.breakStrain = 0.005f;
		fracture.shardSize = 0.25f;
		ASSERT_TRUE( ball->setFracture( fracture ).ok() );
		ASSERT_TRUE( ball->setVelocities( btVector3( 3, 5, 0 ), btVector3( 3, 8, 5 ) ).ok() );
		for ( int frame = 0; frame < 2 * rate; ++frame )
		{
			t.world.stepSimulation( btScalar( 1 ) / btScalar( rate ), 0 );
			ASSERT_TRUE( t.world.fractureEvents().empty() ) << "frame " << frame << " of 1/" << rate << " s";
		}
	}
}

// A body without symmetry tumbles freely: its angular momentum stays, and its energy.
TEST( ImplicitTurning, ATumblingBoxKeepsItsAngularMomentumAndEnergy )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	Material material = stiffMaterial();
	material.damping = 0.0f;
	SoftBody* const box = t.addSoft( test::block( 6, 4, 2, 0.1f ), at( 0, 0, 0 ), material );
	ASSERT_TRUE( box->setVelocities( btVector3( 1, 0, 0 ), btVector3( btScalar( 0.3 ), 6, btScalar( 0.3 ) ) ).ok() );
	const test::Momentum before = test::momentumOf( *box );
	const double energy = test::energyOfMotion( *box );
	t.run( 300 );
	const test::Momentum after = test::momentumOf( *box );
	std::printf( "angular momentum differs by %.1e, energy by %.4f\n",
		double( ( after.angular - before.angular ).length() / before.angular.length() ), test::energyOfMotion( *box ) / energy - 1.0 );
	EXPECT_LT( double( ( after.angular - before.angular ).length() / before.angular.length() ), 1e-3 );
	EXPECT_LT( double( ( after.linear - before.linear ).length() / before.linear.length() ), 1e-4 );
	EXPECT_LT( test::energyOfMotion( *box ), 1.02 * energy );
	EXPECT_GT( test::energyOfMotion( *box ), 0.9 * energy );
}

// The midpoint rule for the axis diverged for slender bodies: sticks gained up to 97 times their energy within five steps, as deformable
// ones and in their rigid state.
TEST( ImplicitTurning, TumblingSticksKeepTheirEnergy )
{
	for ( const float rigidStrain : { 0.0f, 0.01f } )
	{
		for ( const int rate : { 30, 60 } )
		{
			for ( const int length : { 10, 20, 30 } )
			{
				for ( const btVector3& axis : { btVector3( 1, 2, 3 ), btVector3( btScalar( 0.2 ), 1, 0 ), btVector3( 3, -1, 1 ) } )
				{
					TestWorld t;
					t.world.setGravity( btVector3( 0, 0, 0 ) );
					Material material = stiffMaterial();
					material.youngsModulus = 1e9f;
					material.rigidStrain = rigidStrain;
					SoftBody* const stick = t.addSoft( test::block( length, 2, 2, 0.1f ), at( 0, 0, 0 ), material );
					ASSERT_TRUE( stick->setVelocities( btVector3( 0, 0, 0 ), axis.normalized() * 15 ).ok() );
					const double energy = test::energyOfMotion( *stick );
					const btVector3 spin = stick->angularMomentum();
					double most = energy, least = energy;
					for ( int frame = 0; frame < 2 * rate; ++frame )
					{
						t.world.stepSimulation( btScalar( 1 ) / btScalar( rate ), 0 );
						most = std::max( most, test::energyOfMotion( *stick ) );
						least = std::min( least, test::energyOfMotion( *stick ) );
					}
					EXPECT_LT( most, 1.03 * energy ) << rigidStrain << " " << rate << " " << length << " " << axis.x();
					EXPECT_GT( least, 0.9 * energy ) << rigidStrain << " " << rate << " " << length << " " << axis.x();
					EXPECT_LT( ( stick->angularMomentum() - spin ).length(), btScalar( 1e-3 ) * spin.length() );
				}
			}
		}
	}
}

// Sound does not turn the velocities of thin panes within a step, so that they go along tangents: they broke by turning, at 10 rad/s for a
// strain of .01, for any modulus.
TEST( ImplicitTurning, AThrownPaneDoesNotBreak )
{
	for ( const BreakRule rule : { BreakRule::Plane, BreakRule::Shards } )
	{
		for ( const int levels : { 0, 1 } )
		{
			TestWorld t;
			t.world.setGravity( btVector3( 0, 0, 0 ) );
			Material material = stiffMaterial();
			material.youngsModulus = 1e10f;
			Adaptivity adaptivity;
			adaptivity.coarseLevels = levels;
			SoftBody* const pane = t.addSoft( test::block( 16, 16, 1, 0.0625f ), at( 0, 0, 0 ), material, adaptivity );
			Fracture fracture;
			fracture.rule = rule;
			fracture.breakStrain = 0.01f;
			fracture.shardSize = 0.2f;
			ASSERT_TRUE( pane->setFracture( fracture ).ok() );
			ASSERT_TRUE( pane->setVelocities( btVector3( 3, 0, 0 ), btVector3( 6, 7, 4 ) ).ok() );
			int links = 0;
			for ( int frame = 0; frame < 60; ++frame )
			{
				t.run( 1 );
				links += t.world.stepReport().brokenLinks;
			}
			EXPECT_EQ( links, 0 ) << int( rule ) << " " << levels;
		}
	}
}

// Pinned nodes went along the arcs of their holder and all others along tangents: 180 to 820 links broke within a step or two.
TEST( ImplicitTurning, ABrittleBarOnATurningHolderDoesNotBreak )
{
	for ( const int rate : { 30, 60 } )
	{
		for ( const int levels : { 0, 1 } )
		{
			TestWorld t;
			t.world.setGravity( btVector3( 0, 0, 0 ) );
			Adaptivity adaptivity;
			adaptivity.coarseLevels = levels;
			Material material = stiffMaterial();
			material.youngsModulus = 7e10f;
			SoftBody* const bar = t.addSoft( test::block( 20, 4, 4, 0.05f ), at( 1, 0, 0 ), material, adaptivity );
			Fracture fracture;
			fracture.rule = BreakRule::Plane;
			fracture.breakStrain = 0.001f;
			ASSERT_TRUE( bar->setFracture( fracture ).ok() );
			btRigidBody* const holder = t.addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 0, 0 ) );
			holder->setCollisionFlags( btCollisionObject::CF_KINEMATIC_OBJECT | btCollisionObject::CF_NO_CONTACT_RESPONSE );
			holder->setActivationState( DISABLE_DEACTIVATION );
			for ( int i = 0; i < bar->nodeCount(); ++i )
			{
				if ( bar->nodePosition( i ).x() < btScalar( 0.65 ) )
				{
					ASSERT_TRUE( bar->pinNodeToBody( i, holder ).ok() );
				}
			}
			int links = 0;
			double angle = 0.0, most = 0.0;
			for ( int frame = 0; frame < 3 * rate; ++frame )
			{
				const double turn = 5.0 * std::min( 1.0, frame / double( rate ) ); // rad/s
				angle += turn / rate;
				holder->setWorldTransform( btTransform( btQuaternion( btVector3( 0, 1, 0 ), btScalar( angle ) ), btVector3( 0, 0, 0 ) ) );
				t.world.stepSimulation( btScalar( 1 ) / btScalar( rate ), 0 );
				links += t.world.stepReport().brokenLinks;
				const btVector3 middle( btScalar( std::cos( angle ) ), 0, btScalar( -std::sin( angle ) ) );
				most = std::max( most, double( bar->massCentre().distance( middle ) ) );
			}
			std::printf( "1/%d s, %d levels: %d links, mass centre off by %.1e m\n", rate, levels, links, most );
			EXPECT_EQ( links, 0 ) << rate << " " << levels;
			EXPECT_LT( most, 1e-3 ) << rate << " " << levels;
		}
	}
}

// The deformation of coarse nodes is measured before a step, and the tangents of the last one stretch it: 888 links broke at the third
// step.
TEST( ImplicitTurning, ABrittleBarOnLevelsDoesNotBreakOnItsAttachment )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	Material material = stiffMaterial();
	material.youngsModulus = 1e9f;
	material.density = 1000.0f;
	Adaptivity adaptivity;
	adaptivity.coarseLevels = 1;
	SoftBody* const bar = t.addSoft( test::block( 20, 4, 4, 0.05f ), at( btScalar( 0.5 ), 0, 0 ), material, adaptivity );
	Fracture fracture;
	fracture.rule = BreakRule::Shards;
	fracture.breakStrain = 0.001f;
	ASSERT_TRUE( bar->setFracture( fracture ).ok() );
	btRigidBody* const anchor = t.addBox( 0, btVector3( 0.01f, 0.01f, 0.01f ), at( 0, 0, 0 ) );
	anchor->setCollisionFlags( anchor->getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE );
	ASSERT_TRUE( t.world.attach( *bar, btVector3( 0, 0, 0 ), *anchor ).status.ok() );
	ASSERT_TRUE( bar->setVelocities( btVector3( 0, 0, btScalar( -2.5 ) ), btVector3( 0, 5, 0 ) ).ok() );
	int links = 0;
	for ( int frame = 0; frame < 120; ++frame )
	{
		t.run( 1 );
		links += t.world.stepReport().brokenLinks;
	}
	EXPECT_EQ( links, 0 );
	EXPECT_GT( bar->angularVelocity().length(), btScalar( 4.5 ) );
}

// Cells under coarse nodes of one layer lay across it as the layer had been before the step: a turn within it was taken for a shear of the
// same angle, and new nodes were put there when a coarse one was split.
TEST( ImplicitTurning, ASlabOnLevelsDoesNotBreak )
{
	for ( const int levels : { 1, 2 } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		Material material = stiffMaterial();
		material.youngsModulus = 1e8f;
		material.density = 1000.0f;
		Adaptivity adaptivity;
		adaptivity.coarseLevels = levels;
		SoftBody* const slab = t.addSoft( test::block( 16, 16, 4, 0.1f ), at( 0, 0, 0 ), material, adaptivity );
		Fracture fracture;
		fracture.rule = BreakRule::Shards;
		fracture.breakStrain = 0.01f;
		fracture.shardSize = 0.3f;
		ASSERT_TRUE( slab->setFracture( fracture ).ok() );
		ASSERT_TRUE( slab->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, 5, btScalar( 1.5 ) ) ).ok() );
		int links = 0;
		for ( int frame = 0; frame < 60; ++frame )
		{
			t.run( 1 );
			links += t.world.stepReport().brokenLinks;
		}
		EXPECT_EQ( links, 0 ) << levels;
	}
}

} // namespace
} // namespace pliant
