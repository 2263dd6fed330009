// Worlds that have stepped without soft bodies and force fields, and then receive some.

#include "world/game/space.h"

#include <pliant/game/forces.h>

namespace pliant::test {

TEST( PlainWorlds, ServeWhatComesIntoThemLater )
{
	TestWorld t;
	t.addFloor();
	btRigidBody* const box = t.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 3, 2, 0 ) );
	t.run( 5 );
	const btVector3 before = box->getLinearVelocity();
	Planet aside( btVector3( 1000, 2, 0 ), btScalar( 1000 ), btScalar( 6 ) );
	ASSERT_TRUE( t.world.addForceField( aside ).ok() );
	t.run( 6 );
	EXPECT_NEAR( box->getLinearVelocity().x() - before.x(), 0.6, 0.01 );
	EXPECT_TRUE( t.world.removeForceField( aside ) );
	t.run( 6 );
	EXPECT_NEAR( box->getLinearVelocity().x() - before.x(), 0.6, 0.01 );

	// A soft body that a callback adds in the middle of a step.
	SoftBody* body = nullptr;
	struct Adding
	{
		TestWorld& world;
		SoftBody*& body;
	} adding{ t, body };
	t.world.setInternalTickCallback(
		[]( btDynamicsWorld* world, btScalar ) {
			const auto& to = *static_cast<Adding*>( world->getWorldUserInfo() );
			to.body = to.body ? to.body : to.world.addSoft( block( 2, 2, 2, 0.1f ), at( 0, 0.3f, 0 ) );
		},
		&adding, true );
	t.run( 1 );
	ASSERT_NE( body, nullptr );
	t.run( 90 );
	EXPECT_NEAR( body->massCentre().y(), 0.1, 0.02 ); // it lies on the floor
	EXPECT_EQ( t.world.stepReport().softBodies, 1 );
	t.world.removeSoftBody( body );
	t.run( 2 );
	EXPECT_EQ( t.world.stepReport().softBodies, 0 );
	t.world.addSoftBody( body );
	t.run( 1 );
	EXPECT_EQ( t.world.stepReport().softBodies, 1 );
}

} // namespace pliant::test
