// Adding and removing bodies in all ways that Bullet's users know: they work for soft bodies as for rigid ones.

#include "support/memory_in_use.h"
#include "world/test_world.h"

#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::BulletParts;
using test::TestWorld;

constexpr btScalar kHalf = btScalar( 0.2 ); // of the cubes, m

std::unique_ptr<SoftBody> cube( btScalar y )
{
	return std::move( SoftBody::create( block( 4, 4, 4, 0.1f ), at( 0, y, 0 ) ).value );
}

// Generic code adds every collision object by addCollisionObject().
TEST( Membership, AddCollisionObjectAddsASoftBody )
{
	for ( const int method : { 0, 1, 2 } )
	{
		TestWorld t;
		t.addFloor();
		const std::unique_ptr<SoftBody> body = cube( btScalar( 0.5 ) );
		btCollisionWorld& plain = t.world;
		btDiscreteDynamicsWorld& dynamic = t.world;
		method == 0       ? plain.addCollisionObject( body.get() )
			: method == 1 ? dynamic.addCollisionObject( body.get() )
						  : t.world.addCollisionObject( body.get() );
		EXPECT_EQ( t.world.softBodyCount(), 1 );
		t.run( 120 );
		EXPECT_NEAR( body->massCentre().y(), kHalf, 0.03 ) << "method " << method;
		plain.removeCollisionObject( body.get() );
		EXPECT_EQ( t.world.softBodyCount(), 0 );
	}
}

// The usual way to change an object's collision filter: remove it, and add it again with another mask.
TEST( Membership, ABodyRemovedAndAddedAgainHasTheNewFilter )
{
	TestWorld t;
	t.addFloor();
	std::unique_ptr<SoftBody> body = cube( btScalar( 0.2 ) );
	t.world.addSoftBody( body.get() );
	t.run( 60 );
	btCollisionWorld& plain = t.world;
	plain.removeCollisionObject( body.get() );
	plain.addCollisionObject(
		body.get(), btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter );
	t.run( 60 );
	EXPECT_LT( body->massCentre().y(), -2 ) << "static objects are filtered out";
	body.reset();
	EXPECT_EQ( t.world.softBodyCount(), 0 );
	t.run( 2 );
}

// Compared with a rigid body: Bullet has no call of its own for this either.
TEST( Membership, AMaskChangedWhileAsleepActsWhenTheBodyWakes )
{
	TestWorld t;
	t.addFloor();
	const std::unique_ptr<SoftBody> body = cube( btScalar( 0.2 ) );
	t.world.addSoftBody( body.get() );
	t.run( 400 );
	ASSERT_FALSE( body->isActive() );
	t.world.removeSoftBody( body.get() );
	t.world.addSoftBody( body.get(), btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::DefaultFilter );
	body->activate( true );
	t.run( 30 );
	EXPECT_LT( body->massCentre().y(), 0 );
}

struct Ignoring
{
	btScalar y; ///< after half a second
};
template <class Top>
Ignoring ignoring( TestWorld& t, btRigidBody* floor, Top& top )
{
	t.run( 60 );
	floor->setIgnoreCollisionCheck( &top, true );
	top.activate( true );
	t.run( 30 );
	return { top.getWorldTransform().getOrigin().y() };
}

// A trapdoor opened by telling Bullet to ignore the pair: the body on it must fall.
TEST( Membership, APairThatIsIgnoredWhileItTouchesFallsApart )
{
	TestWorld rigid;
	btRigidBody* rigidFloor = rigid.addFloor();
	btRigidBody* box = rigid.addBox( 64, btVector3( kHalf, kHalf, kHalf ), at( 0, kHalf, 0 ) );
	std::printf( "a rigid box whose floor ignores it is at %.3f m after half a second\n", double( ignoring( rigid, rigidFloor, *box ).y ) );
	for ( const Elasticity step : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		btRigidBody* floor = t.addFloor();
		Material material = test::stiff( 1e5f );
		material.elasticity = step;
		SoftBody* body = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, kHalf, 0 ), material );
		EXPECT_NEAR( ignoring( t, floor, *body ).y, kHalf - 10 * 0.25 / 2, 0.15 ) << "it falls freely";
		floor->setIgnoreCollisionCheck( body, false );
		EXPECT_TRUE( body->reset( at( 0, kHalf, 0 ) ).ok() );
		t.run( 60 );
		EXPECT_NEAR( body->massCentre().y(), kHalf, 0.02 );
	}
}

// The same with a rigid body that moves independently, so that the step makes several passes. Each pass has its own list of contacts, which
// must not contain contacts that have just ended. Bullet keeps the memory of the first 4 096; others are freed, which a sanitizer detects.
TEST( Membership, IgnoredContactsAreDroppedInEveryPass )
{
	for ( const Elasticity step : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		btDefaultCollisionConstructionInfo small;
		small.m_defaultMaxPersistentManifoldPoolSize = 1;
		btDefaultCollisionConfiguration configuration( small );
		btCollisionDispatcher dispatcher( &configuration );
		btDbvtBroadphase broadphase;
		btSequentialImpulseConstraintSolver solver;
		SoftBodyWorld world( &dispatcher, &broadphase, &solver, &configuration );
		btBoxShape ground( btVector3( 5, 1, 5 ) ), box( btVector3( kHalf, kHalf, kHalf ) );
		btRigidBody floor( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &ground ) );
		btRigidBody bystander( btRigidBody::btRigidBodyConstructionInfo( 1, nullptr, &box, btVector3( 1, 1, 1 ) ) );
		floor.setWorldTransform( at( 0, -1, 0 ) );
		bystander.setWorldTransform( at( 30, 5, 30 ) );
		world.addRigidBody( &floor );
		world.addRigidBody( &bystander );
		const std::unique_ptr<SoftBody> body = cube( kHalf ), other = cube( 3 * kHalf );
		Material material = test::stiff( 1e5f );
		material.elasticity = step;
		ASSERT_TRUE( body->setMaterial( material ).ok() );
		world.addSoftBody( body.get() );
		world.addSoftBody( other.get() );
		for ( int k = 0; k < 60; ++k )
		{
			if ( k == 20 )
			{
				ASSERT_GT( dispatcher.getNumManifolds(), 10 );
				floor.setIgnoreCollisionCheck( body.get(), true );
				other->setIgnoreCollisionCheck( body.get(), true );
			}
			world.stepSimulation( test::kFrame, 0 );
			for ( int m = 0; k >= 20 && m < dispatcher.getNumManifolds(); ++m )
			{
				EXPECT_NE( SoftBody::upcast( dispatcher.getManifoldByIndexInternal( m )->getBody0() ), body.get() );
				EXPECT_NE( SoftBody::upcast( dispatcher.getManifoldByIndexInternal( m )->getBody1() ), body.get() );
			}
		}
		EXPECT_LT( body->massCentre().y(), kHalf - 1 ) << "it falls";
		world.removeSoftBody( body.get() );
		world.removeSoftBody( other.get() );
		world.removeRigidBody( &bystander );
		world.removeRigidBody( &floor );
	}
}

// Asleep and ignored, both stay until one is woken. The box on the soft body is woken and falls through.
TEST( Membership, ARigidBodyThatIgnoresTheSleepingSoftBodyBelowFallsThroughIt )
{
	TestWorld t;
	t.addFloor();
	SoftBody* body = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, kHalf, 0 ) );
	btRigidBody* box = t.addBox( 5, btVector3( btScalar( 0.15 ), btScalar( 0.1 ), btScalar( 0.15 ) ), at( 0, btScalar( 0.51 ), 0 ) );
	t.run( 500 );
	ASSERT_FALSE( box->isActive() );
	body->setIgnoreCollisionCheck( box, true );
	box->setIgnoreCollisionCheck( body, true );
	box->activate( true );
	t.run( 60 );
	EXPECT_LT( box->getWorldTransform().getOrigin().y(), btScalar( 0.15 ) );
}

// "Remove what the bullet hit": the manifold's body is cast to a rigid body and removed. It is a contact proxy, and shares the soft body's
// broadphase proxy.
TEST( Membership, TheRigidBodyThatAManifoldNamesIsRemovedAsItsSoftBody )
{
	for ( const bool deletesIt : { false, true } )
	{
		TestWorld t;
		t.addFloor();
		std::unique_ptr<SoftBody> body = cube( kHalf );
		t.world.addSoftBody( body.get() );
		t.run( 10 );
		ASSERT_GT( t.parts.dispatcher.getNumManifolds(), 0 );
		const btPersistentManifold* manifold = t.parts.dispatcher.getManifoldByIndexInternal( 0 );
		const bool isFirst = SoftBody::upcast( manifold->getBody0() ) != nullptr;
		btRigidBody* named = const_cast<btRigidBody*>( btRigidBody::upcast( isFirst ? manifold->getBody0() : manifold->getBody1() ) );
		ASSERT_NE( named, nullptr );
		t.world.addRigidBody( named );
		t.world.addRigidBody( named, 1, -1 );
		t.world.addCollisionObject( named );
		EXPECT_EQ( t.world.getNumCollisionObjects(), 2 ) << "a contact proxy is not added to the world";
		t.world.removeRigidBody( named );
		EXPECT_EQ( t.world.softBodyCount(), 0 );
		EXPECT_EQ( body->getBroadphaseHandle(), nullptr );
		EXPECT_EQ( t.parts.dispatcher.getNumManifolds(), 0 );
		t.world.removeRigidBody( named );
		t.world.removeCollisionObject( named );
		if ( deletesIt )
		{
			delete named; // the game takes it for its own
		}
		t.run( 5 );
		t.world.addSoftBody( body.get() );
		t.run( 30 );
		EXPECT_NEAR( body->massCentre().y(), kHalf, 0.02 );
		t.world.removeSoftBody( body.get() );
	}
}

// A game's reset may empty Bullet's object list directly; the soft body has then left the world.
TEST( Membership, ABodyThatVanishesFromBulletsListHasLeft )
{
	TestWorld t;
	const std::unique_ptr<SoftBody> lost = cube( 1 ), kept = cube( 3 );
	t.world.addSoftBody( lost.get() );
	t.world.addSoftBody( kept.get() );
	t.run( 2 );
	t.world.getCollisionObjectArray().resize( 0 );
	t.world.getCollisionObjectArray().push_back( kept.get() ); // at the index of the other
	kept->setWorldArrayIndex( 0 );
	t.run( 1 );
	EXPECT_EQ( t.world.softBodyCount(), 1 );
	const btVector3 stays = lost->massCentre();
	t.run( 5 );
	EXPECT_EQ( ( lost->massCentre() - stays ).length(), 0 );
	EXPECT_EQ( lost->getBroadphaseHandle(), nullptr );
	EXPECT_EQ( t.world.getNumCollisionObjects(), 1 );
	t.world.addSoftBody( lost.get() );
	t.run( 5 );
	EXPECT_LT( lost->massCentre().y(), stays.y() );
}

// A split screen: two worlds with one dispatcher. When the second is destroyed, the first one's soft bodies still need their algorithm.
TEST( Membership, TwoWorldsShareADispatcher )
{
	test::BulletParts parts;
	btDbvtBroadphase secondBroadphase;
	btSequentialImpulseConstraintSolver secondSolver;
	btBoxShape shape( btVector3( 5, 1, 5 ) );
	btRigidBody floor( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &shape ) ),
		secondFloor( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &shape ) );
	floor.setWorldTransform( at( 0, -1, 0 ) );
	secondFloor.setWorldTransform( at( 0, -1, 0 ) );
	SoftBodyWorld first( &parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration );
	auto second = std::make_unique<SoftBodyWorld>( &parts.dispatcher, &secondBroadphase, &secondSolver, &parts.configuration );
	first.addRigidBody( &floor );
	second->addRigidBody( &secondFloor );
	const std::unique_ptr<SoftBody> a = cube( btScalar( 0.3 ) ), b = cube( btScalar( 0.3 ) ), late = cube( btScalar( 0.3 ) );
	ASSERT_TRUE( late->teleport( at( 2, 0, 0 ) ).ok() );
	first.addSoftBody( a.get() );
	second->addSoftBody( b.get() );
	for ( int k = 0; k < 60; ++k )
	{
		first.stepSimulation( test::kFrame, 0 );
		second->stepSimulation( test::kFrame, 0 );
	}
	EXPECT_NEAR( b->massCentre().y(), kHalf, 0.02 );
	second->removeRigidBody( &secondFloor );
	second.reset();
	first.addSoftBody( late.get() );
	for ( int k = 0; k < 60; ++k )
	{
		first.stepSimulation( test::kFrame, 0 );
	}
	EXPECT_NEAR( a->massCentre().y(), kHalf, 0.03 );
	EXPECT_NEAR( late->massCentre().y(), kHalf, 0.03 );
	first.removeSoftBody( a.get() );
	first.removeSoftBody( late.get() );
	first.removeRigidBody( &floor );
}

// The members of a game's class may be destroyed in any order: the dispatcher may go before an empty world.
TEST( Membership, ADispatcherMayGoBeforeAnEmptyWorld )
{
	btDefaultCollisionConfiguration configuration;
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	auto dispatcher = std::make_unique<btCollisionDispatcher>( &configuration );
	SoftBodyWorld world( dispatcher.get(), &broadphase, &solver, &configuration );
	const std::unique_ptr<SoftBody> body = cube( 1 );
	world.addSoftBody( body.get() );
	world.stepSimulation( test::kFrame, 0 );
	world.removeSoftBody( body.get() );
	dispatcher.reset();
}

/// A game's own algorithm for compounds and boxes: Bullet's, with a counter.
struct Counting : btCompoundCollisionAlgorithm::SwappedCreateFunc
{
	int made = 0;
	btCollisionAlgorithm* CreateCollisionAlgorithm(
		btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b ) override
	{
		++made;
		return btCompoundCollisionAlgorithm::SwappedCreateFunc::CreateCollisionAlgorithm( info, a, b );
	}
};

// A game may register its own algorithm before or after the world is created: it serves the game's compounds, and soft bodies keep theirs.
TEST( Membership, AlgorithmsThatTheGameRegistersServeItsCompoundsWheneverItDoesSo )
{
	for ( const int when : { 0, 1, 2 } ) // before the world, after it, after the first soft body
	{
		Counting counting;
		btBoxShape child( btVector3( 1, 1, 1 ) );
		btCompoundShape compound;
		compound.addChildShape( btTransform::getIdentity(), &child );
		test::BulletParts parts;
		const auto add = [&] { parts.dispatcher.registerCollisionCreateFunc( BOX_SHAPE_PROXYTYPE, COMPOUND_SHAPE_PROXYTYPE, &counting ); };
		when == 0 ? add() : void();
		SoftBodyWorld world( &parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration );
		when == 1 ? add() : void();
		btBoxShape floorShape( btVector3( 10, 1, 10 ) );
		btRigidBody floor( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &floorShape ) );
		btRigidBody top( btRigidBody::btRigidBodyConstructionInfo( 1, nullptr, &compound, btVector3( 1, 1, 1 ) ) );
		floor.setWorldTransform( at( 0, -1, 0 ) );
		top.setWorldTransform( at( 4, 1, 0 ) );
		world.addRigidBody( &floor );
		const std::unique_ptr<SoftBody> body = cube( btScalar( 0.3 ) );
		world.addSoftBody( body.get() );
		when == 2 ? add() : void();
		world.addRigidBody( &top );
		for ( int k = 0; k < 60; ++k )
		{
			world.stepSimulation( test::kFrame, 0 );
		}
		EXPECT_EQ( counting.made, 1 ) << when;
		EXPECT_NEAR( body->massCentre().y(), kHalf, 0.02 ) << when;
		EXPECT_NEAR( top.getWorldTransform().getOrigin().y(), 1, 0.02 ) << when;
		world.removeRigidBody( &top );
		world.removeSoftBody( body.get() );
		world.addRigidBody( &top ); // without soft bodies: the game's algorithm
		world.stepSimulation( test::kFrame, 0 );
		EXPECT_EQ( counting.made, 2 ) << when;
		world.removeRigidBody( &top );
		world.removeRigidBody( &floor );
	}
}

// Other libraries mark their subclasses by CO_USER_TYPE and test individual bits.
TEST( Membership, TheInternalTypeMatchesNoOtherLibrarysTest )
{
	const std::unique_ptr<SoftBody> body = cube( 1 );
	const int type = body->getInternalType();
	EXPECT_EQ( type, SoftBody::kInternalType );
	for ( int own = 0; own < 1024; ++own )
	{
		EXPECT_EQ( type & ( btCollisionObject::CO_USER_TYPE + own ), 0 );
	}
	EXPECT_EQ( btRigidBody::upcast( body.get() ), nullptr );
}

// A game that loads and frees the same model repeatedly, together with the bodies made of it.
TEST( Membership, RepeatedLoadingLeaksNothing )
{
	TestWorld t;
	t.addFloor();
	std::size_t base = 0;
	for ( int k = 0; k < 200; ++k )
	{
		t.addSoft( test::cubeTemplate( 0.4f, 6 ), at( 0, btScalar( 0.25 ), 0 ) );
		t.run( 3 );
		ASSERT_GT( t.parts.dispatcher.getNumManifolds() + 1, 0 );
		t.soft.clear();
		base = k == 20 ? test::memoryInUse() : base;
	}
	EXPECT_LE( double( test::memoryInUse() ), 1.01 * double( base ) );
}

TEST( Membership, ATemplateBuiltOverAndOverTakesTheMemoryOfOne )
{
	std::shared_ptr<const BodyTemplate> made;
	std::size_t base = 0;
	constexpr int kTimes = 30, kCells = 20;
	for ( int k = 0; k < kTimes; ++k )
	{
		made = test::cubeTemplate( 1.0f, kCells );
		ASSERT_EQ( made->cellCount(), kCells * kCells * kCells );
		base = k == 5 ? test::memoryInUse() : base;
	}
	EXPECT_LE( double( test::memoryInUse() ), 1.01 * double( base ) );
}

} // namespace
} // namespace pliant
