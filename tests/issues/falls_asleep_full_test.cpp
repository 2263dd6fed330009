// Heaps and fragments fall asleep within fifteen seconds, explicit and implicit.

#include "support/awake_bodies.h"
#include "support/mesh_of_boxes.h"
#include "support/test_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace {

using namespace pliant;
using namespace pliant::test;

void expectSleep( SoftWorld& t )
{
	for ( int frame = 0; frame < 900 && awakeBodies( t.world ) > 0; ++frame )
	{
		t.step( 1 );
	}
	EXPECT_EQ( awakeBodies( t.world ), 0 ) << "of " << t.world.softBodyCount();
}

// Twenty cubes, bars and plates of four stiffnesses, dropped one after the other at the same position.
TEST( FallsAsleep, AHeapOfTwenty )
{
	const std::shared_ptr<const BodyTemplate> made[] = { cubeTemplate( 0.5f, 5 ), boxTemplate( { 1.0f, 0.24f, 0.24f }, 0.12f ),
		boxTemplate( { 0.8f, 0.1f, 0.8f }, 0.1f ), boxTemplate( { 0.3f, 0.6f, 0.4f }, 0.1f ) };
	const float moduli[] = { 5e4f, 2e5f, 1e6f, 1e5f };
	for ( const Elasticity elasticity : kSteps )
	{
		SoftWorld t;
		t.addFloor();
		std::mt19937 random( 1 );
		const auto fraction = [&random] { return btScalar( random() / 4294967296.0 ); };
		for ( std::size_t k = 0; k < 20; ++k )
		{
			const btScalar x = fraction(), z = fraction(), a = fraction(), b = fraction(), c = fraction();
			const btQuaternion turn = btQuaternion( a - btScalar( 0.5 ), b - btScalar( 0.5 ), c - btScalar( 0.5 ), btScalar( 0.5 ) )
										  .normalized();
			t.add( made[k % 4], btVector3( x - btScalar( 0.5 ), btScalar( 0.6 + 0.35 * double( k ) ), z - btScalar( 0.5 ) ),
				materialOf( elasticity, moduli[k / 4 % 4] ), turn );
		}
		expectSleep( t );
	}
}

struct Shooting
{
	BreakRule rule;
	int shots;
	int coarseLevels;
};

// A block of half a metre, broken by a ball of 20 kg at 30 m/s: fragments of one cell in particular must fall asleep, because they keep the
// bodies they touch awake.
TEST( FallsAsleep, TheFragmentsOfAShotBlock )
{
	for ( const Shooting& shooting :
		{ Shooting{ BreakRule::Distance, 40, 0 }, Shooting{ BreakRule::Plane, 50, 0 }, Shooting{ BreakRule::Plane, 50, 1 } } )
	{
		for ( const Elasticity elasticity : kSteps )
		{
			SoftWorld t;
			t.addFloor(); // nothing falls over an edge of it
			Adaptivity adaptivity;
			adaptivity.coarseLevels = shooting.coarseLevels;
			SoftBody* const block = t.add( boxTemplate( { 0.5f, 0.5f, 0.5f }, 0.06f ), btVector3( 0, btScalar( 0.26 ), 0 ),
				materialOf( elasticity, 2e5f ), btQuaternion::getIdentity(), adaptivity );
			Fracture fracture;
			fracture.rule = shooting.rule;
			fracture.breakStrain = 0.2f;
			ASSERT_TRUE( block->setFracture( fracture ).ok() );
			std::mt19937 random( 1 );
			btRigidBody* const ball = t.WorldOf<SoftBodyWorld>::add( 20, new btSphereShape( btScalar( 0.1 ) ), btVector3( 0, 50, 0 ) );
			for ( int shot = 0; shot < shooting.shots; ++shot )
			{
				SoftBody* heaviest = t.world.softBody( 0 );
				for ( int k = 1; k < t.world.softBodyCount(); ++k )
				{
					heaviest = t.world.softBody( k )->mass() > heaviest->mass() ? t.world.softBody( k ) : heaviest;
				}
				const btScalar angle = btScalar( random() / 4294967296.0 ) * SIMD_2_PI;
				btVector3 from = heaviest->massCentre() - btVector3( btCos( angle ), 0, btSin( angle ) ) * btScalar( 1.5 );
				from.setY( btMax( from.y(), btScalar( 0.13 ) ) );
				ball->setWorldTransform( btTransform( btQuaternion::getIdentity(), from ) );
				ball->setLinearVelocity( ( heaviest->massCentre() - from ).normalized() * 30 );
				ball->setAngularVelocity( btVector3( 0, 0, 0 ) );
				ball->activate( true );
				t.step( 30 );
			}
			t.world.removeRigidBody( ball );
			expectSleep( t );
			t.world.addRigidBody( ball ); // removed by the world
		}
	}
}

} // namespace
