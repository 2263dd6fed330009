// Pins and the rigid bodies they refer to may be destroyed in any order, and no freed memory is read (these tests run under sanitizers).

#include "world/test_world.h"

namespace pliant {
namespace {

using test::at;
using test::block;
using test::BulletParts;
using test::TestWorld;

struct Handle
{
	btBoxShape shape{ btVector3( btScalar( 0.2 ), btScalar( 0.2 ), btScalar( 0.2 ) ) };
	std::unique_ptr<btRigidBody> body = std::make_unique<btRigidBody>( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &shape ) );
};

// A lamp on a rope is removed from the scene, its hook is deleted meanwhile, and the lamp is added again: the pin must be gone.
TEST( PinsLifetime, ARemovedBodyIsNotPinnedToADeletedOne )
{
	TestWorld t;
	SoftBody* lamp = t.addSoft( block( 2, 4, 2, 0.1f ), at( 0, 1, 0 ) );
	for ( const bool madeAnew : { false, true } )
	{
		Handle hook;
		t.world.addRigidBody( hook.body.get() );
		ASSERT_TRUE( lamp->pinNodeToBody( 0, hook.body.get() ).ok() );
		t.world.removeSoftBody( lamp );
		t.world.removeRigidBody( hook.body.get() );
		hook.body.reset();
		if ( madeAnew ) // most likely at the same address
		{
			hook.body = std::make_unique<btRigidBody>( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &hook.shape ) );
			t.world.addRigidBody( hook.body.get() );
		}
		EXPECT_TRUE( lamp->isPinned( 0 ) ) << "the pin has not been checked yet";
		t.world.addSoftBody( lamp );
		EXPECT_FALSE( lamp->isPinned( 0 ) );
		t.run( 10 );
		EXPECT_LT( lamp->linearVelocity().y(), btScalar( -0.5 ) );
		EXPECT_TRUE( lamp->reset( at( 0, 1, 0 ) ).ok() );
		if ( madeAnew )
		{
			t.world.removeRigidBody( hook.body.get() );
		}
	}
}

// If the hook still exists, the lamp is pinned to it as before.
TEST( PinsLifetime, ABodyAddedAgainKeepsPinsToExistingBodies )
{
	TestWorld t;
	Handle hook;
	t.world.addRigidBody( hook.body.get() );
	SoftBody* lamp = t.addSoft( block( 2, 4, 2, 0.1f ), at( 0, 1, 0 ) );
	ASSERT_TRUE( lamp->pinNodeToBody( 0, hook.body.get() ).ok() );
	t.run( 30 );
	std::vector<btVector3> before;
	for ( int i = 0; i < lamp->nodeCount(); ++i )
	{
		before.push_back( lamp->nodePosition( i ) );
	}
	t.world.removeCollisionObject( lamp );
	t.run( 60 );
	for ( int i = 0; i < lamp->nodeCount(); ++i )
	{
		EXPECT_EQ( ( lamp->nodePosition( i ) - before[std::size_t( i )] ).length(), 0 );
	}
	t.world.addCollisionObject( lamp );
	EXPECT_TRUE( lamp->isPinned( 0 ) );
	t.run( 30 );
	EXPECT_LT( ( lamp->nodePosition( 0 ) - before[0] ).length(), btScalar( 1e-6 ) );
	t.world.removeRigidBody( hook.body.get() );
	EXPECT_FALSE( lamp->isPinned( 0 ) );
}

TEST( PinsLifetime, ARigidBodyInNoWorldOrAnotherIsRefusedWithAMessage )
{
	TestWorld t, other;
	Handle hook;
	SoftBody* lamp = t.addSoft( block( 2, 4, 2, 0.1f ), at( 0, 1, 0 ) );
	const Status nowhere = lamp->pinNodeToBody( 0, hook.body.get() );
	EXPECT_EQ( nowhere.code, ResultCode::BadArgument );
	EXPECT_NE( nowhere.sentence.find( "no world" ), std::string::npos );
	other.world.addRigidBody( hook.body.get() );
	const Status elsewhere = lamp->pinNodeToBody( 0, hook.body.get() );
	EXPECT_EQ( elsewhere.code, ResultCode::BadArgument );
	EXPECT_NE( elsewhere.sentence.find( "another world" ), std::string::npos );
	EXPECT_FALSE( lamp->isPinned( 0 ) );
	// A body in no world yet may be pinned to a rigid body of any world; the pin is removed if they do not meet in one.
	auto made = std::move( SoftBody::create( block( 2, 4, 2, 0.1f ), at( 0, 1, 0 ) ).value );
	ASSERT_TRUE( made->pinNodeToBody( 0, hook.body.get() ).ok() );
	other.world.addSoftBody( made.get() );
	EXPECT_TRUE( made->isPinned( 0 ) );
	other.world.removeSoftBody( made.get() );
	t.world.addSoftBody( made.get() );
	EXPECT_FALSE( made->isPinned( 0 ) );
	other.world.removeRigidBody( hook.body.get() );
	t.run( 5 );
}

// A game's reset may drop its rigid bodies without a call, by emptying Bullet's list and deleting them.
TEST( PinsLifetime, AHookThatVanishesFromBulletsListLetsGo )
{
	TestWorld t;
	Handle hook;
	t.world.addCollisionObject( hook.body.get() ); // sufficient for a static body
	SoftBody* lamp = t.addSoft( block( 2, 4, 2, 0.1f ), at( 0, 1, 0 ) );
	ASSERT_TRUE( lamp->pinNodeToBody( 0, hook.body.get() ).ok() );
	t.run( 3 );
	t.parts.broadphase.getOverlappingPairCache()->cleanProxyFromPairs( hook.body->getBroadphaseHandle(), &t.parts.dispatcher );
	t.parts.broadphase.destroyProxy( hook.body->getBroadphaseHandle(), &t.parts.dispatcher );
	t.world.getCollisionObjectArray().remove( hook.body.get() );
	hook.body.reset();
	t.run( 3 );
	EXPECT_FALSE( lamp->isPinned( 0 ) );
	EXPECT_LT( lamp->linearVelocity().y(), btScalar( -0.1 ) );
}

} // namespace
} // namespace pliant
