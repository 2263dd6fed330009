// Contact events of whole bodies.

#include "world/test_world.h"

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

namespace pliant::test {

namespace {

struct EventsOf : ::testing::TestWithParam<Elasticity>
{
	Material material() const
	{
		Material material = stiff( 3e5f );
		material.elasticity = GetParam();
		return material;
	}
};

const ContactEvent* eventWith( const SoftBodyWorld& world, const btCollisionObject* other )
{
	for ( const ContactEvent& event : world.contactEvents() )
	{
		if ( event.other == other )
		{
			return &event;
		}
	}
	return nullptr;
}

} // namespace

INSTANTIATE_TEST_SUITE_P( Steps, EventsOf, ::testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& given ) { return given.param == Elasticity::Explicit ? "Explicit" : "Implicit"; } );

TEST_P( EventsOf, AFallingCubeBeginsOncePushesItsWeightSleepsAndEnds )
{
	TestWorld t;
	btRigidBody* floor = t.addFloor();
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.5f, 0 ), material() );
	cube->setContactEvents( true );
	int begins = 0, ends = 0;
	btScalar impulse = 0;
	int resting = 0;
	for ( int frame = 0; frame < 600 && cube->isActive(); ++frame )
	{
		t.run( 1 );
		const ContactEvent* event = eventWith( t.world, floor );
		ASSERT_LE( t.world.contactEvents().size(), 1u );
		if ( event )
		{
			EXPECT_EQ( event->body, cube );
			EXPECT_EQ( event->otherSoft, nullptr );
			begins += event->began ? 1 : 0;
			ends += event->ended ? 1 : 0;
			EXPECT_NEAR( event->push.y(), event->impulse, 0.02 * event->impulse + 1e-4 );
			EXPECT_LT( btFabs( event->position.y() ), 0.1 );
			if ( frame >= 60 && frame < 120 )
			{
				impulse += event->impulse;
				++resting;
			}
		}
	}
	ASSERT_FALSE( cube->isActive() );
	EXPECT_EQ( begins, ends + 1 ) << "bounces end and begin";
	EXPECT_LE( begins, 6 );
	if ( resting == 60 )
	{
		EXPECT_NEAR( impulse, cube->mass() * kGravity, 0.03 * cube->mass() * kGravity ) << "over a second";
	}
	t.run( 5 );
	EXPECT_TRUE( t.world.contactEvents().empty() ) << "a pair that sleeps has no events";
	ASSERT_TRUE( cube->teleport( at( 0, 3, 0 ) ).ok() );
	t.run( 1 );
	const ContactEvent* event = eventWith( t.world, floor );
	ASSERT_NE( event, nullptr );
	EXPECT_TRUE( event->ended );
	EXPECT_FALSE( event->began );
	t.run( 1 );
	EXPECT_TRUE( t.world.contactEvents().empty() );
}

TEST_P( EventsOf, TheImpulseOfAHitIsTheChangeOfMomentumInAllStepsOfACall )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ), material() );
	cube->setContactEvents( true );
	btRigidBody* ball = t.add( 20, new btSphereShape( 0.2f ), at( 0, 0.6f, 0 ) );
	ball->setFriction( 0 ); // not copied into the event
	ball->setLinearVelocity( btVector3( 0, -3, 0 ) );
	btScalar impulse = 0;
	for ( int call = 0; call < 20; ++call )
	{
		t.world.stepSimulation( 3 * kFrame, 3, kFrame );
		const ContactEvent* event = eventWith( t.world, ball );
		ASSERT_LE( t.world.contactEvents().size(), 1u ) << "one for each pair in a call";
		impulse += event ? -event->push.y() : 0;
	}
	const btScalar change = cube->mass() * -cube->linearVelocity().y();
	EXPECT_GT( change, 10 );
	EXPECT_NEAR( impulse, change, 0.03 * change );
}

TEST( ContactEvents, TwoSoftBodiesTellOneAnother )
{
	TestWorld t;
	t.addFloor();
	SoftBody* low = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.15f, 0 ) );
	SoftBody* high = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.46f, 0 ) );
	high->setContactEvents( true );
	t.run( 20 );
	ASSERT_EQ( t.world.contactEvents().size(), 1u ) << "the other body does not want any";
	EXPECT_EQ( t.world.contactEvents()[0].otherSoft, low );
	low->setContactEvents( true );
	t.run( 1 );
	ASSERT_EQ( t.world.contactEvents().size(), 3u ) << "both of the pair, and the floor's";
	const ContactEvent* of = eventWith( t.world, low );
	const ContactEvent* back = eventWith( t.world, high );
	ASSERT_TRUE( of && back );
	EXPECT_NEAR( of->push.y(), -back->push.y(), 1e-4 * btFabs( of->push.y() ) );
	EXPECT_TRUE( back->began );
}

TEST( ContactEvents, NobodyAskedNobodyIsTold )
{
	TestWorld t;
	t.addFloor();
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.15f, 0 ) );
	EXPECT_FALSE( cube->contactEvents() );
	t.run( 20 );
	EXPECT_TRUE( t.world.contactEvents().empty() );
	cube->setContactEvents( true );
	t.run( 2 );
	EXPECT_FALSE( t.world.contactEvents().empty() );
	cube->setContactEvents( false );
	t.run( 2 );
	EXPECT_TRUE( t.world.contactEvents().empty() );
}

TEST( ContactEvents, ATriggerIsEnteredAndLeft )
{
	TestWorld t;
	btGhostObject trigger;
	btBoxShape shape( btVector3( 1, 0.5f, 1 ) );
	trigger.setCollisionShape( &shape );
	trigger.setWorldTransform( at( 0, -3, 0 ) );
	trigger.setCollisionFlags( trigger.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE );
	t.world.addCollisionObject( &trigger, btBroadphaseProxy::SensorTrigger, btBroadphaseProxy::AllFilter );
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	cube->setContactEvents( true );
	int begins = 0, ends = 0;
	for ( int frame = 0; frame < 120; ++frame )
	{
		t.run( 1 );
		if ( const ContactEvent* event = eventWith( t.world, &trigger ) )
		{
			begins += event->began ? 1 : 0;
			ends += event->ended ? 1 : 0;
			EXPECT_EQ( event->impulse, 0 );
		}
	}
	EXPECT_EQ( begins, 1 );
	EXPECT_EQ( ends, 1 );
	t.world.removeCollisionObject( &trigger );
}

TEST( ContactEvents, WhatIsRemovedIsNeverNamed )
{
	TestWorld t;
	btRigidBody* floor = t.addFloor();
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.15f, 0 ) );
	SoftBody* other = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.46f, 0 ) );
	cube->setContactEvents( true );
	t.run( 20 );
	ASSERT_EQ( t.world.contactEvents().size(), 2u );
	for ( const ContactEvent& event : t.world.contactEvents() ) // a game removes the bodies of an event
	{
		event.other == floor ? t.world.removeRigidBody( floor ) : t.world.removeSoftBody( event.otherSoft );
	}
	for ( const ContactEvent& event : t.world.contactEvents() )
	{
		EXPECT_EQ( event.other, nullptr );
		EXPECT_EQ( event.otherSoft, nullptr );
		EXPECT_EQ( event.body, cube );
	}
	t.run( 1 );
	EXPECT_TRUE( t.world.contactEvents().empty() );
	t.world.addRigidBody( floor );
	t.world.addSoftBody( other );
	ASSERT_TRUE( cube->reset( at( 0, 0.15f, 0 ) ).ok() );
	t.run( 10 );
	ASSERT_NE( eventWith( t.world, floor ), nullptr );
	t.world.removeSoftBody( cube );
	for ( const ContactEvent& event : t.world.contactEvents() )
	{
		EXPECT_EQ( event.body, nullptr );
	}
	t.run( 1 );
	EXPECT_TRUE( t.world.contactEvents().empty() );
}

TEST( ContactEvents, PiecesGoOnTelling )
{
	TestWorld t;
	btRigidBody* floor = t.addFloor();
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.2f, 0 ) );
	cube->setContactEvents( true );
	t.run( 20 );
	EXPECT_GT( cube->cutPlane( btVector3( 0.01f, 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	int begins = 0;
	for ( int frame = 0; frame < 10; ++frame )
	{
		t.run( 1 );
		for ( const ContactEvent& event : t.world.contactEvents() )
		{
			begins += event.other == floor && event.began ? 1 : 0;
		}
	}
	ASSERT_EQ( t.world.softBodyCount(), 2 );
	EXPECT_TRUE( t.world.softBody( 0 )->contactEvents() && t.world.softBody( 1 )->contactEvents() );
	EXPECT_EQ( begins, 1 ) << "the piece's; the rest lay there before";
}

} // namespace pliant::test
