// A soft body changes nothing for objects that it does not touch: actions run once per step, characters walk as far, motors and breakable
// joints have the same impulses, and callbacks see the impulses of the whole step. Each scene is run in Bullet's world, and in ours with an
// awake soft body 20 m away.

#include "twin_worlds.h"

#include <BulletDynamics/Character/btKinematicCharacterController.h>

#include <cmath>
#include <functional>

namespace pliant {
namespace {

using test::at;
using test::kFrame;
using test::RigidScene;

/// Returns what a scene measures in a world; `run( frames )` steps the world.
using Measure = std::function<std::vector<btScalar>( btDiscreteDynamicsWorld&, const std::function<void( int )>& )>;

class Bystanders : public testing::TestWithParam<Elasticity>
{
protected:
	static std::vector<btScalar> inBulletsWorld( const Measure& measure )
	{
		test::BulletWorld bullet;
		return measure( bullet.world, [&]( int frames ) {
			for ( int k = 0; k < frames; ++k )
			{
				bullet.world.stepSimulation( kFrame, 0 );
			}
		} );
	}
	/// The soft body falls and is thrown up again, so that it never sleeps.
	static std::vector<btScalar> besideASoftBody( const Measure& measure )
	{
		test::TestWorld scene;
		SoftBody* const body = scene.addSoft( test::block( 4, 4, 4, 0.1f ), at( 20, 3, 20 ), test::stepping( GetParam(), 1e5f ) );
		return measure( scene.world, [&]( int frames ) {
			for ( int k = 0; k < frames; ++k )
			{
				if ( body->massCentre().y() < 2 )
				{
					EXPECT_TRUE( body->setLinearVelocity( btVector3( 0, 5, 0 ) ).ok() );
				}
				scene.world.stepSimulation( kFrame, 0 );
				EXPECT_TRUE( body->isActive() );
			}
		} );
	}
	/// Compares bit for bit.
	static void compare( const Measure& measure )
	{
		const std::vector<btScalar> expected = inBulletsWorld( measure ), found = besideASoftBody( measure );
		ASSERT_EQ( found.size(), expected.size() );
		for ( std::size_t k = 0; k < found.size(); ++k )
		{
			EXPECT_EQ( found[k], expected[k] ) << "value " << k;
		}
	}
};

INSTANTIATE_TEST_SUITE_P( Steps, Bystanders, testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& with ) { return with.param == Elasticity::Explicit ? "Explicit" : "Implicit"; } );

void note( std::vector<btScalar>& values, const btTransform& transform )
{
	for ( int k = 0; k < 3; ++k )
	{
		values.push_back( transform.getOrigin()[k] );
		values.push_back( transform.getRotation()[k] );
	}
}

struct Counter : btActionInterface
{
	void updateAction( btCollisionWorld*, btScalar step ) override
	{
		++calls;
		time += step;
	}
	void debugDraw( btIDebugDraw* ) override {}
	int calls = 0;
	btScalar time = 0;
};

TEST_P( Bystanders, ActionsRunOnceAStep )
{
	compare( []( btDiscreteDynamicsWorld& world, const auto& run ) {
		Counter counter;
		world.addAction( &counter );
		run( 60 );
		world.removeAction( &counter );
		return std::vector<btScalar>{ btScalar( counter.calls ), counter.time };
	} );
}

TEST_P( Bystanders, CharactersWalkAsFar )
{
	compare( []( btDiscreteDynamicsWorld& world, const auto& run ) {
		RigidScene scene( world );
		scene.addFloor();
		btGhostPairCallback pairs;
		world.getPairCache()->setInternalGhostPairCallback( &pairs );
		btCapsuleShape capsule( btScalar( 0.3 ), btScalar( 1 ) );
		btPairCachingGhostObject ghost;
		ghost.setCollisionShape( &capsule );
		ghost.setCollisionFlags( btCollisionObject::CF_CHARACTER_OBJECT );
		ghost.setWorldTransform( at( 0, btScalar( 0.8 ), 0 ) );
		world.addCollisionObject(
			&ghost, btBroadphaseProxy::CharacterFilter, btBroadphaseProxy::StaticFilter | btBroadphaseProxy::DefaultFilter );
		btKinematicCharacterController character( &ghost, &capsule, btScalar( 0.35 ), btVector3( 0, 1, 0 ) );
		world.addAction( &character );
		character.setWalkDirection( btVector3( btScalar( 0.05 ), 0, 0 ) );
		run( 60 );
		std::vector<btScalar> values;
		note( values, ghost.getWorldTransform() );
		EXPECT_NEAR( values[0], 3, 1e-3 );
		world.removeAction( &character );
		world.removeCollisionObject( &ghost );
		world.getPairCache()->setInternalGhostPairCallback( nullptr );
		return values;
	} );
}

TEST_P( Bystanders, MotorsTurnAsFar )
{
	compare( []( btDiscreteDynamicsWorld& world, const auto& run ) {
		RigidScene scene( world );
		btRigidBody* const wheel = scene.addBox( 1, btVector3( btScalar( 0.5 ), btScalar( 0.5 ), btScalar( 0.1 ) ), at( 0, 2, 0 ) );
		auto* const hinge = scene.join( new btHingeConstraint( *wheel, btVector3( 0, 0, 0 ), btVector3( 0, 0, 1 ) ) );
		hinge->enableAngularMotor( true, 10, btScalar( 0.005 ) );
		run( 40 );
		std::vector<btScalar> values;
		note( values, wheel->getWorldTransform() );
		return values;
	} );
}

TEST_P( Bystanders, JointsBreakAtTheSameImpulse )
{
	compare( []( btDiscreteDynamicsWorld& world, const auto& run ) {
		std::vector<btScalar> values;
		for ( const btScalar threshold : { btScalar( 0.1 ), btScalar( 0.3 ) } )
		{
			RigidScene scene( world );
			btRigidBody* const hung = scene.addBox(
				1, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ), at( 0, 5, 0 ) ); // held by .17 N s per step
			auto* const joint = scene.join( new btPoint2PointConstraint( *hung, btVector3( 0, 0, 0 ) ) );
			joint->setBreakingImpulseThreshold( threshold );
			run( 20 );
			values.push_back( joint->isEnabled() ? 1 : 0 );
			values.push_back( joint->getAppliedImpulse() );
			note( values, hung->getWorldTransform() );
		}
		EXPECT_EQ( values[0], 0 );
		return values;
	} );
}

btScalar seenImpulse = 0, largestSeenImpulse = 0;

void lookAtImpulses( btDynamicsWorld* world, btScalar )
{
	btScalar sum = 0;
	for ( int m = 0; m < world->getDispatcher()->getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *world->getDispatcher()->getManifoldByIndexInternal( m );
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			sum += manifold.getContactPoint( k ).m_appliedImpulse;
		}
	}
	seenImpulse = sum;
	largestSeenImpulse = btMax( largestSeenImpulse, sum );
}

TEST_P( Bystanders, CallbacksSeeTheImpulseOfTheStep )
{
	compare( []( btDiscreteDynamicsWorld& world, const auto& run ) {
		seenImpulse = largestSeenImpulse = 0;
		RigidScene scene( world );
		scene.addFloor();
		scene.addBox( 10, btVector3( 1, 1, 1 ), at( 0, 2, 0 ) );
		world.setInternalTickCallback( lookAtImpulses );
		run( 90 );
		world.setInternalTickCallback( nullptr );
		EXPECT_NEAR( seenImpulse, 10 * 10 * kFrame, 0.02 ); // at rest
		return std::vector<btScalar>{ seenImpulse, largestSeenImpulse };
	} );
}

TEST_P( Bystanders, HeapsFallAsTheyDo )
{
	compare( []( btDiscreteDynamicsWorld& world, const auto& run ) {
		RigidScene scene( world );
		scene.addFloor();
		for ( int k = 0; k < 8; ++k )
		{
			scene.addBox( 1, btVector3( btScalar( 0.4 ), btScalar( 0.2 ), btScalar( 0.3 ) ),
				at( btScalar( 0.1 ) * btScalar( k % 3 ), btScalar( 0.5 + 0.5 * k ), 0 ) );
		}
		run( 60 );
		std::vector<btScalar> values;
		for ( const auto& body : scene.bodies() )
		{
			note( values, body->getWorldTransform() );
		}
		return values;
	} );
}

/// A soft cube that hovers 3 cm from an object at x = 0: it touches nothing, but objects so near take part in its substeps.
void hoverBeside( test::TestWorld& scene, btScalar halfWidth, btScalar height )
{
	SoftBody* const cube = scene.addSoft(
		test::block( 4, 4, 4, 0.1f ), at( halfWidth + btScalar( 0.23 ), height, 0 ), test::stepping( Elasticity::Explicit, 1e5f ) );
	EXPECT_TRUE( cube->setGravity( btVector3( 0, 0, 0 ) ).ok() );
	cube->setActivationState( DISABLE_DEACTIVATION );
}

// Objects that take part in substeps have the limits and impulses of the whole step: a joint held by .167 N s per step, a quarter in each
// substep, must break at .1.
TEST( Neighbours, HaveJointsThatBreakAtTheImpulseOfTheStep )
{
	for ( const btScalar threshold : { btScalar( 0.1 ), btScalar( 0.3 ) } )
	{
		test::TestWorld own;
		own.world.setGravity( btVector3( 0, 0, -10 ) ); // along the last of the joint's rows, whose impulse Bullet reports
		RigidScene scene( own.world );
		btRigidBody* const hung = scene.addBox( 1, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ), at( 0, 5, 0 ) );
		hung->setActivationState( DISABLE_DEACTIVATION );
		auto* const joint = scene.join( new btPoint2PointConstraint( *hung, btVector3( 0, 0, 0 ) ) );
		joint->setBreakingImpulseThreshold( threshold );
		hoverBeside( own, btScalar( 0.1 ), 5 );
		own.run( 3 );
		EXPECT_EQ( joint->isEnabled(), threshold > btScalar( 0.2 ) );
		EXPECT_EQ( joint->getBreakingImpulseThreshold(), threshold );
		if ( joint->isEnabled() )
		{
			EXPECT_NEAR( joint->getAppliedImpulse(), 10 * kFrame, 0.01 );
		}
	}
}

TEST( Neighbours, ShowTheContactImpulseOfTheStep )
{
	test::TestWorld own;
	RigidScene scene( own.world );
	scene.addFloor();
	btRigidBody* const box = scene.addBox(
		10, btVector3( btScalar( 0.5 ), btScalar( 0.5 ), btScalar( 0.5 ) ), at( 0, btScalar( 0.5 ), 0 ) );
	box->setActivationState( DISABLE_DEACTIVATION );
	hoverBeside( own, btScalar( 0.5 ), btScalar( 0.7 ) );
	own.world.setInternalTickCallback( lookAtImpulses );
	own.run( 60 );
	EXPECT_GT( own.world.stepReport().substeps, 1 );
	EXPECT_NEAR( seenImpulse, 10 * 10 * kFrame, 0.05 );
}

int ticksBefore = 0, ticksAfter = 0;

// A callback that is set within the other callback is kept while a soft body is awake.
TEST_P( Bystanders, CallbacksMayBeSetAtAnyTime )
{
	compare( []( btDiscreteDynamicsWorld& world, const auto& run ) {
		ticksBefore = ticksAfter = 0;
		world.setInternalTickCallback(
			[]( btDynamicsWorld* own, btScalar ) {
				++ticksBefore;
				own->setInternalTickCallback( []( btDynamicsWorld*, btScalar ) { ++ticksAfter; } );
			},
			nullptr, true );
		run( 10 );
		world.setInternalTickCallback( nullptr, nullptr, true );
		world.setInternalTickCallback( nullptr );
		EXPECT_EQ( ticksAfter, 10 );
		return std::vector<btScalar>{ btScalar( ticksBefore ), btScalar( ticksAfter ) };
	} );
}

/// An engine's own loop over single steps, without our stepSimulation.
class EnginesWorld : public SoftBodyWorld
{
public:
	using SoftBodyWorld::SoftBodyWorld;
	int stepSimulation( btScalar timeStep, int, btScalar ) override
	{
		saveKinematicState( timeStep );
		applyGravity();
		internalSingleStepSimulation( timeStep );
		synchronizeMotionStates();
		clearForces();
		return 1;
	}
};

// In a world that overrides stepSimulation events must not accumulate, and faded pieces must be removed.
TEST( DerivedWorlds, ForgetEventsAndFadedPieces )
{
	test::BulletParts parts;
	EnginesWorld world( &parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration );
	SoftBodyResult made = SoftBody::create( test::block( 6, 2, 2, 0.1f ), at( 0, 5, 0 ), test::stiff( 1e5f ) );
	ASSERT_TRUE( made.ok() );
	Fracture fracture;
	fracture.rule = BreakRule::Never;
	fracture.smallCells = 4;
	fracture.smallPieces = SmallPieces::Fade;
	fracture.fadeTime = 0.2f;
	ASSERT_TRUE( made.value->setFracture( fracture ).ok() );
	world.addSoftBody( made.value.get() );
	EXPECT_GT( made.value->cutPlane( btVector3( btScalar( 0.21 ), 5, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	int withEvents = 0;
	for ( int k = 0; k < 30; ++k )
	{
		world.stepSimulation( kFrame, 1, kFrame );
		withEvents += world.fractureEvents().empty() ? 0 : 1;
	}
	EXPECT_EQ( withEvents, 1 );
	EXPECT_EQ( world.softBodyCount(), 1 );
}

} // namespace
} // namespace pliant
