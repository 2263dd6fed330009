// Moving objects carry soft bodies as they carry rigid ones: platforms, turntables, lifts, conveyors and shaken plates, each compared with
// a rigid body. Games set the kinematic flag in addition to the static one that every new object of Bullet's has.

#include "twin_worlds.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::kFrame;
using test::RigidScene;

constexpr int kSettle = 90, kCarry = 120; // frames
constexpr btScalar kTop = btScalar( 0.2 ), kHalf = btScalar( 0.25 );

/// The transform of the plate after so many seconds of motion.
using Course = std::function<btTransform( btScalar )>;

struct Cargo
{
	const char* name;
	Elasticity elasticity;
	bool hasLevels, isBroken;
};

class Platforms : public testing::TestWithParam<Cargo>
{
protected:
	/// The carried body's centre of mass and its rotation about y, relative to the start of the plate's motion.
	struct Carried
	{
		btVector3 displacement;
		btScalar angle;
		btScalar farthest; ///< from its first position along x, at any time, m
	};

	/// `pose()`: the pose of the cargo.
	static Carried run( btDynamicsWorld& world, btRigidBody& plate, const Course& course, const std::function<btTransform()>& pose )
	{
		for ( int k = 0; k < kSettle; ++k )
		{
			world.stepSimulation( kFrame, 0 );
		}
		const btTransform from = pose();
		Carried carried{ btVector3( 0, 0, 0 ), 0, 0 };
		btVector3 before = from.getBasis().getColumn( 0 );
		for ( int k = 1; k <= kCarry; ++k )
		{
			plate.setWorldTransform( course( btScalar( k ) * kFrame ) );
			world.stepSimulation( kFrame, 0 );
			const btVector3 now = pose().getBasis().getColumn( 0 );
			carried.angle += btAtan2( before.z() * now.x() - before.x() * now.z(), before.x() * now.x() + before.z() * now.z() );
			carried.farthest = btMax( carried.farthest, btFabs( pose().getOrigin().x() - from.getOrigin().x() ) );
			before = now;
		}
		carried.displacement = pose().getOrigin() - from.getOrigin();
		return carried;
	}

	static Carried rigid( const Course& course )
	{
		test::BulletWorld bullet;
		RigidScene scene( bullet.world );
		btRigidBody* const plate = scene.addKinematic( btVector3( 4, kTop, 2 ), course( 0 ) );
		plate->setFriction( btScalar( 0.8 ) );
		btRigidBody* const box = scene.addBox( 125, btVector3( kHalf, kHalf, kHalf ), at( 0, kTop + kHalf, 0 ) );
		box->setFriction( btScalar( 0.8 ) );
		return run( bullet.world, *plate, course, [box] { return box->getWorldTransform(); } );
	}

	static Carried soft( const Course& course, float youngsModulus )
	{
		const Cargo& cargo = GetParam();
		test::TestWorld own;
		RigidScene scene( own.world );
		btRigidBody* const plate = scene.addKinematic( btVector3( 4, kTop, 2 ), course( 0 ) );
		plate->setFriction( btScalar( 0.8 ) );
		Adaptivity adaptivity;
		adaptivity.coarseLevels = cargo.hasLevels ? 1 : 0;
		SoftBody* const body = own.addSoft( test::cubeTemplate( 2 * float( kHalf ), 6 ), at( 0, kTop + kHalf, 0 ),
			test::stepping( cargo.elasticity, youngsModulus ), adaptivity );
		body->setFriction( btScalar( 0.8 ) );
		if ( cargo.isBroken )
		{
			EXPECT_GT( body->cutPlane( body->massCentre(), btVector3( 0, 1, 0 ) ), 0 ); // one half rests on the other
		}
		return run( own.world, *plate, course, [body] { return btTransform( body->bestFitTransform().getBasis(), body->massCentre() ); } );
	}

	static void expectCarried( const Course& course, bool isRotated = false )
	{
		const Carried twin = rigid( course );
		for ( const float youngsModulus : { 5e4f, 1e6f } )
		{
			const Carried found = soft( course, youngsModulus );
			SCOPED_TRACE( youngsModulus );
			if ( isRotated )
			{
				EXPECT_NEAR( found.angle, twin.angle, btScalar( 0.03 ) * btFabs( twin.angle ) );
				continue;
			}
			EXPECT_NEAR( ( found.displacement - twin.displacement ).length(), 0, btScalar( 0.03 ) * twin.displacement.length() )
				<< found.displacement.x() << " " << found.displacement.y() << " for " << twin.displacement.x() << " "
				<< twin.displacement.y();
		}
	}
};

INSTANTIATE_TEST_SUITE_P( Cargo, Platforms,
	testing::Values( Cargo{ "Explicit", Elasticity::Explicit, false, false }, Cargo{ "Implicit", Elasticity::Implicit, false, false },
		Cargo{ "Automatic", Elasticity::Automatic, false, false }, Cargo{ "ExplicitOnLevels", Elasticity::Explicit, true, false },
		Cargo{ "ImplicitOnLevels", Elasticity::Implicit, true, false }, Cargo{ "ExplicitBroken", Elasticity::Explicit, false, true },
		Cargo{ "ImplicitBroken", Elasticity::Implicit, false, true } ),
	[]( const auto& with ) { return std::string( with.param.name ); } );

TEST_P( Platforms, CarryBodiesAlongTheirPath )
{
	expectCarried( []( btScalar t ) { return at( t, 0, 0 ); } );
}

TEST_P( Platforms, LiftBodiesOnThem )
{
	expectCarried( []( btScalar t ) { return at( 0, t, 0 ); } );
}

TEST_P( Platforms, RotateBodiesAtTheirCentre )
{
	expectCarried( []( btScalar t ) { return btTransform( btQuaternion( btVector3( 0, 1, 0 ), t ), btVector3( 0, 0, 0 ) ); }, true );
}

// Oscillation by 5 cm from rest, at an acceleration that friction can transmit: 0.05 (2 pi 1.5)^2 = 4.4 m/s^2.
TEST_P( Platforms, ShakeBodiesOnThem )
{
	const Course course = []( btScalar t ) { return at( btScalar( 0.05 ) * ( 1 - btCos( SIMD_2_PI * btScalar( 1.5 ) * t ) ), 0, 0 ); };
	const Carried twin = rigid( course );
	const Carried found = soft( course, 1e6f );
	EXPECT_NEAR( found.farthest, twin.farthest, btScalar( 0.1 ) * twin.farthest );
}

/// How a light stiff cube and its rigid twin move with a lift or a shuttle of 1 m/s: at the end of each step.
struct Ride
{
	btScalar highest = 0;                                       ///< above its rest on the plate in the second half, m
	btVector3 velocity = btVector3( 0, 0, 0 ), twin = velocity; ///< in the last step, m/s
};

/// The plate is a rigid body or a soft one.
Ride rideOf( Elasticity elasticity, const btVector3& course, int gameSteps, bool isSoft )
{
	test::TestWorld own;
	RigidScene scene( own.world );
	btRigidBody* const plate = isSoft ? nullptr : scene.addKinematic( btVector3( 4, kTop, 2 ), at( 0, 0, 0 ) );
	SoftBody* const slab = isSoft ? own.addSoft( test::block( 20, 1, 10, 0.4f ), at( 0, 0, 0 ), Material{} ) : nullptr;
	if ( isSoft )
	{
		slab->setCollisionFlags( slab->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
	}
	btVector3 plateAt( 0, 0, 0 );
	const auto movePlate = [&]( const btVector3& to ) {
		if ( isSoft )
		{
			EXPECT_TRUE( slab->teleport( btTransform( btQuaternion::getIdentity(), to - plateAt ) ).ok() );
		}
		else
		{
			plate->setWorldTransform( btTransform( btQuaternion::getIdentity(), to ) );
		}
		plateAt = to;
	};
	Material material = test::stepping( elasticity, 1e6f );
	material.density = 8; // 1 kg
	SoftBody* const body = own.addSoft( test::cubeTemplate( 2 * float( kHalf ), 5 ), at( 0, kTop + kHalf, 0 ), material );
	btRigidBody* const box = scene.addBox( 1, btVector3( kHalf, kHalf, kHalf ), at( 2, kTop + kHalf, 0 ) );
	own.run( 30 );
	Ride ride;
	for ( int k = 1; k <= kCarry / gameSteps; ++k )
	{
		movePlate( course * ( btScalar( k * gameSteps ) * kFrame ) );
		own.world.stepSimulation( btScalar( gameSteps ) * kFrame, gameSteps );
		const btScalar above = body->massCentre().y() - plateAt.y() - kTop - kHalf;
		ride.highest = k > kCarry / gameSteps / 2 ? btMax( ride.highest, above ) : 0; // it rebounds when the plate starts
	}
	ride.velocity = body->linearVelocity();
	ride.twin = box->getLinearVelocity();
	return ride;
}

// With one game step in each stepSimulation, and with two, as in a game that falls behind.
TEST_P( Platforms, LiftsDoNotThrowLightBodies )
{
	for ( const bool isSoft : { false, true } )
	{
		for ( const btScalar speed : { btScalar( 1 ), btScalar( -1 ) } )
		{
			for ( const int gameSteps : { 1, 2 } )
			{
				const Ride ride = rideOf( GetParam().elasticity, btVector3( 0, speed, 0 ), gameSteps, isSoft );
				SCOPED_TRACE( std::to_string( gameSteps ) + " steps at " + std::to_string( speed ) + ( isSoft ? ", soft lift" : "" ) );
				EXPECT_LT( ride.highest, isSoft ? 0.06 : 0.04 ); // the plate is ahead by the displacement of one stepSimulation
				EXPECT_NEAR( ride.velocity.y(), speed, 0.1 );
				EXPECT_NEAR( ride.twin.y(), speed, isSoft && sizeof( btScalar ) > sizeof( float ) ? 0.2 : 0.15 ) << "Bullet's own";
			}
		}
	}
}

// A body on a shuttle, by pins or attachments, has the velocity of the shuttle.
TEST_P( Platforms, ShuttlesGiveTheirVelocity )
{
	for ( const bool isPinned : { false, true } )
	{
		test::TestWorld own;
		RigidScene scene( own.world );
		btRigidBody* const plate = scene.addKinematic( btVector3( kHalf, kTop, kHalf ), at( 0, 5, 0 ) );
		Material material = test::stepping( GetParam().elasticity, 1e6f );
		material.density = 8;
		SoftBody* const body = own.addSoft( test::cubeTemplate( 2 * float( kHalf ), 5 ), at( 0, 5 - kTop - kHalf, 0 ), material );
		body->setIgnoreCollisionCheck( plate, true );
		std::vector<int> held;
		for ( int node = 0; node < body->nodeCount(); ++node )
		{
			if ( body->nodePosition( node ).y() > 5 - kTop - btScalar( 0.1 ) )
			{
				held.push_back( node );
				EXPECT_TRUE( isPinned ? body->pinNodeToBody( node, plate ).ok() : own.world.attach( *body, node, *plate ).ok() );
			}
		}
		for ( int k = 1; k <= kCarry; ++k )
		{
			plate->setWorldTransform( at( btScalar( 0.5 ) * btScalar( k ) * kFrame, 5, 0 ) );
			own.run( 1 );
		}
		EXPECT_NEAR( body->linearVelocity().x(), 0.5, 0.05 ) << "pins " << isPinned;
		EXPECT_NEAR( body->massCentre().x(), 1, 0.02 );
	}
}

// A door that is teleported to the other side of a body does not sweep over it.
TEST_P( Platforms, TeleportedBodiesDoNotSweepOverOthers )
{
	test::TestWorld own;
	RigidScene scene( own.world );
	btRigidBody* const door = scene.addKinematic( btVector3( btScalar( 0.1 ), 1, 1 ), at( -3, 0, 0 ) );
	own.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = own.addSoft(
		test::cubeTemplate( 2 * float( kHalf ), 5 ), at( 0, 0, 0 ), test::stepping( GetParam().elasticity, 1e6f ) );
	own.run( 2 );
	door->setWorldTransform( at( 3, 0, 0 ) );
	own.run( 10 );
	EXPECT_LT( body->linearVelocity().length(), 1e-6 );
	EXPECT_EQ( door->getWorldTransform().getOrigin().x(), 3 );
}

btRigidBody* belt = nullptr;

// A conveyor: a plate that does not move, whose velocity is set before each step.
TEST_P( Platforms, ConveyWithTheVelocityTheyAreGiven )
{
	const auto run = []( btDynamicsWorld& world, const std::function<btScalar()>& x ) {
		world.setInternalTickCallback(
			[]( btDynamicsWorld*, btScalar ) { belt->setLinearVelocity( btVector3( 1, 0, 0 ) ); }, nullptr, true );
		for ( int k = 0; k < kSettle + kCarry; ++k )
		{
			world.stepSimulation( kFrame, 0 );
		}
		world.setInternalTickCallback( nullptr, nullptr, true );
		return x();
	};
	test::BulletWorld bullet;
	RigidScene rigidScene( bullet.world );
	belt = rigidScene.addKinematic( btVector3( 4, kTop, 2 ), at( 0, 0, 0 ) );
	belt->setFriction( btScalar( 0.8 ) );
	btRigidBody* const box = rigidScene.addBox( 125, btVector3( kHalf, kHalf, kHalf ), at( 0, kTop + kHalf, 0 ) );
	box->setFriction( btScalar( 0.8 ) );
	const btScalar twin = run( bullet.world, [box] { return box->getWorldTransform().getOrigin().x(); } );
	EXPECT_GT( twin, 2 );

	test::TestWorld own;
	RigidScene scene( own.world );
	belt = scene.addKinematic( btVector3( 4, kTop, 2 ), at( 0, 0, 0 ) );
	belt->setFriction( btScalar( 0.8 ) );
	SoftBody* const body = own.addSoft(
		test::cubeTemplate( 2 * float( kHalf ), 6 ), at( 0, kTop + kHalf, 0 ), test::stepping( GetParam().elasticity, 2e5f ) );
	body->setFriction( btScalar( 0.8 ) );
	const btScalar found = run( own.world, [body] { return body->massCentre().x(); } );
	EXPECT_NEAR( found, twin, btScalar( 0.03 ) * twin );
}

/// A stationary conveyor: the callback requests a velocity along x at each contact point on `belt`.
bool rubAlongTheBelt( btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int, const btCollisionObjectWrapper* b, int, int )
{
	if ( a->getCollisionObject() != belt && b->getCollisionObject() != belt )
	{
		return false;
	}
	point.m_contactPointFlags |= BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED;
	point.m_lateralFrictionDir1 = btVector3( 1, 0, 0 );
	point.m_lateralFrictionDir2 = btVector3( 0, 0, 1 );
	point.m_contactMotion1 = b->getCollisionObject() == belt ? btScalar( 1 ) : btScalar( -1 ); // of the first body relative to the second
	return true;
}

// A conveyor by callback carries soft bodies too.
TEST_P( Platforms, ConveyWithTheVelocityFromCallbacks )
{
	struct Callback
	{
		Callback() { gContactAddedCallback = rubAlongTheBelt; }
		~Callback() { gContactAddedCallback = nullptr; }
	} const callback;
	const auto run = []( btDynamicsWorld& world, RigidScene& scene, const std::function<btScalar()>& x ) {
		belt = scene.addBox( 0, btVector3( 4, kTop, 2 ), at( 0, 0, 0 ) );
		belt->setFriction( btScalar( 0.8 ) );
		belt->setCollisionFlags( belt->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK );
		world.getSolverInfo().m_solverMode |= SOLVER_ENABLE_FRICTION_DIRECTION_CACHING |
			SOLVER_USE_2_FRICTION_DIRECTIONS; // otherwise Bullet chooses its own directions
		for ( int k = 0; k < kSettle + kCarry; ++k )
		{
			world.stepSimulation( kFrame, 0 );
		}
		return x();
	};
	test::BulletWorld bullet;
	RigidScene rigidScene( bullet.world );
	btRigidBody* const box = rigidScene.addBox( 125, btVector3( kHalf, kHalf, kHalf ), at( 0, kTop + kHalf, 0 ) );
	box->setFriction( btScalar( 0.8 ) );
	const btScalar twin = run( bullet.world, rigidScene, [box] { return box->getWorldTransform().getOrigin().x(); } );
	EXPECT_GT( twin, 2 );

	test::TestWorld own;
	RigidScene scene( own.world );
	Adaptivity adaptivity;
	adaptivity.coarseLevels = GetParam().hasLevels ? 1 : 0;
	SoftBody* const body = own.addSoft(
		test::cubeTemplate( 2 * float( kHalf ), 6 ), at( 0, kTop + kHalf, 0 ), test::stepping( GetParam().elasticity, 2e5f ), adaptivity );
	body->setFriction( btScalar( 0.8 ) );
	if ( GetParam().isBroken )
	{
		EXPECT_GT( body->cutPlane( body->massCentre(), btVector3( 0, 1, 0 ) ), 0 );
	}
	const btScalar found = run( own.world, scene, [body] { return body->massCentre().x(); } );
	EXPECT_NEAR( found, twin, btScalar( 0.03 ) * twin );
}

// A body that sleeps on a lift wakes when the lift starts to move.
TEST_P( Platforms, WakeBodiesThatSleepOnThem )
{
	test::TestWorld own;
	RigidScene scene( own.world );
	btRigidBody* const plate = scene.addKinematic( btVector3( 4, kTop, 2 ), at( 0, 0, 0 ) );
	plate->forceActivationState( ACTIVE_TAG );
	plate->setFriction( btScalar( 0.8 ) );
	SoftBody* const body = own.addSoft(
		test::cubeTemplate( 2 * float( kHalf ), 6 ), at( 0, kTop + kHalf, 0 ), test::stepping( GetParam().elasticity, 2e5f ) );
	body->setFriction( btScalar( 0.8 ) );
	own.run( 30 );
	plate->forceActivationState( ISLAND_SLEEPING );
	own.run( 600 );
	EXPECT_FALSE( body->isActive() );
	plate->setActivationState( DISABLE_DEACTIVATION );
	plate->forceActivationState( DISABLE_DEACTIVATION );
	const btScalar from = body->massCentre().x();
	for ( int k = 1; k <= kCarry; ++k )
	{
		plate->setWorldTransform( at( btScalar( k ) * kFrame, 0, 0 ) );
		own.run( 1 );
	}
	EXPECT_NEAR( body->massCentre().x() - from, 2, 0.08 );
}

} // namespace
} // namespace pliant
