// Contacts of implicit bodies are not solved in Bullet's rows, but callbacks, contact tests and applied impulses work as for any other
// body.

#include "world/test_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::implicit;
using test::kGravity;
using test::TestWorld;

/// Bullet's callbacks are functions without a context.
struct Calls
{
	int added = 0, processed = 0, started = 0, ended = 0;
	btScalar friction = 1, restitution = 0;
	const SoftBody* soft = nullptr;
	bool namesTheBody = true;
};
Calls* calls = nullptr;

bool onAdded( btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int, const btCollisionObjectWrapper* b, int, int )
{
	++calls->added;
	calls->namesTheBody = calls->namesTheBody &&
		( SoftBody::upcast( a->getCollisionObject() ) == calls->soft || SoftBody::upcast( b->getCollisionObject() ) == calls->soft );
	point.m_combinedFriction = calls->friction;
	point.m_combinedRestitution = calls->restitution;
	return true;
}

bool onProcessed( btManifoldPoint&, void* a, void* b )
{
	++calls->processed;
	const auto of = []( void* object ) { return SoftBody::upcast( static_cast<const btCollisionObject*>( object ) ); };
	calls->namesTheBody = calls->namesTheBody && ( of( a ) == calls->soft || of( b ) == calls->soft );
	return true;
}

void onStarted( btPersistentManifold* const& )
{
	++calls->started;
}

void onEnded( btPersistentManifold* const& )
{
	++calls->ended;
}

/// Installs Bullet's callbacks during its lifetime.
struct Listening
{
	explicit Listening( Calls& own )
	{
		calls = &own;
		gContactAddedCallback = onAdded;
		gContactProcessedCallback = onProcessed;
		gContactStartedCallback = onStarted;
		gContactEndedCallback = onEnded;
	}
	~Listening()
	{
		gContactAddedCallback = nullptr;
		gContactProcessedCallback = nullptr;
		gContactStartedCallback = nullptr;
		gContactEndedCallback = nullptr;
		calls = nullptr;
	}
};

TEST( ImplicitCallbacks, MayChangeFrictionAndSeeEachContact )
{
	double slid[2];
	for ( const int isSlippery : { 0, 1 } )
	{
		Calls own;
		own.friction = isSlippery == 1 ? btScalar( 0 ) : btScalar( 1 );
		TestWorld t;
		const double slope = 0.3;
		t.world.setGravity( btVector3( btScalar( kGravity * std::sin( slope ) ), btScalar( -kGravity * std::cos( slope ) ), 0 ) );
		t.addFloor();
		SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.21 ), 0 ), implicit( 1e6f ) );
		own.soft = cube;
		cube->setCollisionFlags( cube->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK );
		cube->setActivationState( DISABLE_DEACTIVATION );
		const Listening listening( own );
		t.run( 90 );
		slid[isSlippery] = double( cube->linearVelocity().x() );
		EXPECT_EQ( own.started, 16 );
		EXPECT_GE( own.added, 16 * 80 );
		EXPECT_GE( own.processed, 16 * 80 );
		EXPECT_TRUE( own.namesTheBody );
		EXPECT_TRUE( cube->setVelocities( btVector3( 0, 5, 0 ), btVector3( 0, 0, 0 ) ).ok() );
		t.run( 10 );
		EXPECT_EQ( own.ended, own.started );
	}
	EXPECT_NEAR( slid[0], 0.0, 1e-3 );
	// Without friction from the first contact on.
	EXPECT_NEAR( slid[1], kGravity * std::sin( 0.3 ) * 1.5, 0.01 );
}

TEST( ImplicitCallbacks, MayMakeABodyBounce )
{
	double high[2];
	for ( const int bounces : { 0, 1 } )
	{
		Calls own;
		own.restitution = bounces == 1 ? btScalar( 0.9 ) : btScalar( 0 );
		TestWorld t;
		t.addFloor();
		SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 1, 0 ), implicit( 1e8f ) );
		own.soft = cube;
		cube->setCollisionFlags( cube->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK );
		const Listening listening( own );
		t.run( 40 );
		high[bounces] = double( cube->massCentre().y() );
	}
	EXPECT_LT( high[0], 0.25 );
	EXPECT_GT( high[1], 0.45 );
}

/// Sums the impulses on the object of all contacts that name it, N s.
btVector3 impulseOn( TestWorld& t, const btCollisionObject* object, bool isOfNodes )
{
	btVector3 sum( 0, 0, 0 );
	for ( int m = 0; m < t.parts.dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *t.parts.dispatcher.getManifoldByIndexInternal( m );
		const auto is = [&]( const btCollisionObject* body ) {
			return isOfNodes ? static_cast<const btCollisionObject*>( SoftBody::upcast( body ) ) == object : body == object;
		};
		const btScalar sign = is( manifold.getBody0() ) ? btScalar( 1 ) : is( manifold.getBody1() ) ? btScalar( -1 ) : btScalar( 0 );
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			const btManifoldPoint& point = manifold.getContactPoint( k );
			sum += sign *
				( point.m_normalWorldOnB * point.getAppliedImpulse() + point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
					point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2 );
		}
	}
	return sum;
}

// At rest on a slope: the cube carries the box, and the floor carries both, by normal and friction impulses.
TEST( ImplicitCallbacks, AppliedImpulsesCarryTheLoad )
{
	TestWorld t;
	const btVector3 gravity( 2, btScalar( -kGravity ), 1 );
	t.world.setGravity( gravity );
	btRigidBody* floor = t.addFloor();
	floor->setFriction( 1 );
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), implicit( 1e8f ) );
	cube->setFriction( 1 );
	btRigidBody* box = t.addBox( 400, btVector3( btScalar( 0.2 ), btScalar( 0.1 ), btScalar( 0.2 ) ), at( 0, btScalar( 0.7 ), 0 ) );
	box->setFriction( 1 );
	cube->setActivationState( DISABLE_DEACTIVATION );
	box->setActivationState( DISABLE_DEACTIVATION );
	t.run( 300 );
	const btVector3 onBox = impulseOn( t, box, false ), onFloor = impulseOn( t, floor, false ), onCube = impulseOn( t, cube, true );
	const btScalar h = test::kFrame;
	EXPECT_LT( ( onBox + gravity * 400 * h ).length(), btScalar( 0.01 ) * gravity.length() * 400 * h );
	EXPECT_LT( ( onFloor - gravity * 616 * h ).length(), btScalar( 0.01 ) * gravity.length() * 616 * h );
	EXPECT_LT( ( onCube + gravity * 216 * h ).length(), btScalar( 0.01 ) * gravity.length() * 616 * h ); // the difference of both
}

struct CountTouches : btCollisionWorld::ContactResultCallback
{
	int count = 0;
	const SoftBody* soft = nullptr;

	btScalar addSingleResult(
		btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int, const btCollisionObjectWrapper* b, int, int ) override
	{
		count += point.getDistance() <= btScalar( 0.01 ) ? 1 : 0;
		EXPECT_TRUE( SoftBody::upcast( a->getCollisionObject() ) == soft || SoftBody::upcast( b->getCollisionObject() ) == soft );
		return 0;
	}
};

TEST( ImplicitCallbacks, ContactTestsSeeThem )
{
	TestWorld t;
	btRigidBody* floor = t.addFloor();
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), implicit( 1e6f ) );
	btRigidBody* box = t.addBox( 50, btVector3( btScalar( 0.2 ), btScalar( 0.1 ), btScalar( 0.2 ) ), at( 0, btScalar( 0.7 ), 0 ) );
	btRigidBody* far = t.addBox( 50, btVector3( btScalar( 0.2 ), btScalar( 0.1 ), btScalar( 0.2 ) ), at( 5, btScalar( 0.1 ), 0 ) );
	t.run( 60 );
	for ( btRigidBody* other : { floor, box, far } )
	{
		CountTouches touches;
		touches.soft = cube;
		t.world.contactPairTest( cube, other, touches );
		EXPECT_EQ( touches.count > 0, other != far );
	}
	CountTouches all;
	all.soft = cube;
	t.world.contactTest( cube, all );
	EXPECT_GE( all.count, 2 );
}

} // namespace
} // namespace pliant
