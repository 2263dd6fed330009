// Rays, sweeps, contact tests, ghosts and callbacks treat a soft body like any other object, and report its nodes.

#include "support/surface_queries.h"
#include "world/test_world.h"

#include "world/bodies/soft_body_impl.h"

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

#include <set>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::NodeRay;
using test::TestWorld;

TEST( Queries, ARayFindsTheNodeItHits )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), at( 1, 2, 3 ) );
	EXPECT_TRUE( cube->setLinearVelocity( btVector3( 0, 10, 0 ) ).ok() );
	t.run( 12 );
	int tried = 0;
	for ( int node = 0; node < cube->nodeCount(); node += 7 )
	{
		const btVector3 target = cube->nodePosition( node );
		const btVector3 from = target + btVector3( -5, 0, 0 );
		NodeRay ray( from, target, *cube );
		t.world.rayTest( from, target, ray );
		ASSERT_TRUE( ray.hasHit() );
		EXPECT_EQ( ray.m_collisionObject, cube );
		const int hit = cube->nodeOfShapeIndex( ray.child );
		ASSERT_GE( hit, 0 );
		// The ray runs along x, so the node that it hits is in the same row at its current position.
		EXPECT_NEAR( cube->nodePosition( hit ).y(), target.y(), 1e-4 );
		EXPECT_NEAR( ray.m_hitPointWorld.x(), cube->nodePosition( hit ).x() - cube->nodeRadius( hit ), 1e-3 );
		++tried;
	}
	EXPECT_GT( tried, 10 );
	EXPECT_EQ( cube->nodeOfShapeIndex( -1 ), -1 );
	EXPECT_EQ( cube->nodeOfShapeIndex( 100000 ), -1 );
}

/// Casts a ray in each step, as a vehicle's wheels do.
struct Asking : btActionInterface
{
	explicit Asking( SoftBody& body ) : cube( body ) {}
	void updateAction( btCollisionWorld* world, btScalar ) override
	{
		const int node = cube.nearestNode( cube.getWorldTransform().getOrigin() + btVector3( 0, -1, 0 ) );
		to = cube.nodePosition( node );
		from = to - btVector3( 0, 3, 0 );
		NodeRay ray( from, to, cube );
		world->rayTest( from, to, ray );
		ASSERT_GE( cube.nodeOfShapeIndex( ray.child ), 0 );
		fraction = ray.m_closestHitFraction;
		++hits;
	}
	void debugDraw( btIDebugDraw* ) override {}
	SoftBody& cube;
	btVector3 from = btVector3( 0, 0, 0 ), to = from;
	btScalar fraction = 0;
	int hits = 0;
};

TEST( Queries, AnActionSeesTheBodyWhereItIs )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), at( 1, 2, 3 ) );
	for ( int node = 0; node < cube->nodeCount(); ++node )
	{
		const btVector3 speed = btVector3( 0, 0, 12 ).cross( cube->nodePosition( node ) - btVector3( 1, 2, 3 ) );
		cube->impl().body->nodes().v.set( node, toVec3( speed ) );
	}
	Asking action( *cube );
	t.world.addAction( &action );
	for ( int frame = 0; frame < 5; ++frame )
	{
		t.run( 1 );
		const double drawn = test::DrawnTriangles( *cube ).ray( action.from, action.to );
		EXPECT_NEAR( double( action.fraction ), drawn, 1e-4 );
	}
	t.world.removeAction( &action );
	EXPECT_EQ( action.hits, 5 ); // once per step, after the last substep
}

TEST( Queries, ASweepStopsAtTheSurface )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), at( 0, 0, 0 ) );
	btSphereShape ball( btScalar( 0.2 ) );
	btCollisionWorld::ClosestConvexResultCallback hit( btVector3( -3, 0, 0 ), btVector3( 3, 0, 0 ) );
	t.world.convexSweepTest( &ball, at( -3, 0, 0 ), at( 3, 0, 0 ), hit );
	ASSERT_TRUE( hit.hasHit() );
	EXPECT_EQ( hit.m_hitCollisionObject, cube );
	EXPECT_NEAR( -3 + 6 * hit.m_closestHitFraction, -0.45, 0.01 );
}

struct CountContacts : btCollisionWorld::ContactResultCallback
{
	explicit CountContacts( SoftBody* body ) : soft( body ) {}
	btScalar addSingleResult( btManifoldPoint&, const btCollisionObjectWrapper* wrap0, int, int index0,
		const btCollisionObjectWrapper* wrap1, int, int index1 ) override
	{
		const bool isFirst = SoftBody::upcast( wrap0->getCollisionObject() ) == soft;
		EXPECT_TRUE( isFirst || SoftBody::upcast( wrap1->getCollisionObject() ) == soft );
		nodes.insert( soft->nodeOfShapeIndex( isFirst ? index0 : index1 ) );
		return 0;
	}
	SoftBody* soft;
	std::set<int> nodes;
};

TEST( Queries, AContactTestNamesTheTouchingNodes )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), at( 0, 0, 0 ) );
	btBoxShape box( btVector3( 1, 0.1f, 1 ) );
	btCollisionObject probe;
	probe.setCollisionShape( &box );
	probe.setWorldTransform( at( 0, btScalar( 0.34 ), 0 ) );
	CountContacts found( cube );
	t.world.contactTest( &probe, found );
	EXPECT_EQ( found.nodes.size(), 25u );
	for ( const int node : found.nodes )
	{
		ASSERT_GE( node, 0 );
		EXPECT_NEAR( cube->nodePosition( node ).y(), 0.2, 1e-4 );
	}
}

TEST( Queries, AGhostSeesOneObject )
{
	TestWorld t;
	btGhostPairCallback pairs;
	t.parts.broadphase.getOverlappingPairCache()->setInternalGhostPairCallback( &pairs );
	btBoxShape box( btVector3( 1, 1, 1 ) );
	btPairCachingGhostObject ghost;
	ghost.setCollisionShape( &box );
	ghost.setCollisionFlags( btCollisionObject::CF_NO_CONTACT_RESPONSE );
	t.world.addCollisionObject( &ghost, btBroadphaseProxy::SensorTrigger, btBroadphaseProxy::AllFilter );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ) );
	t.run( 1 );
	ASSERT_EQ( ghost.getNumOverlappingObjects(), 1 );
	EXPECT_EQ( ghost.getOverlappingObject( 0 ), cube );
	EXPECT_NEAR( cube->linearVelocity().y(), t.world.getGravity().y() / 60, 1e-3 ) << "a ghost does not stop the body";
	// Trigger code reads the pair's manifolds: one per touching node.
	btBroadphasePair* pair = t.world.getPairCache()->findPair( cube->getBroadphaseHandle(), ghost.getBroadphaseHandle() );
	ASSERT_TRUE( pair && pair->m_algorithm );
	btManifoldArray manifolds;
	pair->m_algorithm->getAllContactManifolds( manifolds );
	EXPECT_EQ( manifolds.size(), 64 );
	EXPECT_EQ(
		SoftBody::upcast( manifolds[0]->getBody0() ) ? cube : nullptr, SoftBody::upcast( manifolds[0]->getBody1() ) ? nullptr : cube );
	t.world.removeCollisionObject( &ghost );
	t.world.removeSoftBody( cube );
	t.parts.broadphase.getOverlappingPairCache()->setInternalGhostPairCallback( nullptr );
}

// Bullet's callbacks carry no context.
std::set<int> g_added;
int g_started = 0, g_ended = 0, g_processed = 0;
const void* g_user = nullptr;

bool added(
	btManifoldPoint& point, const btCollisionObjectWrapper* wrap0, int, int index0, const btCollisionObjectWrapper* wrap1, int, int index1 )
{
	const bool isFirst = SoftBody::upcast( wrap0->getCollisionObject() ) != nullptr;
	EXPECT_TRUE( isFirst || SoftBody::upcast( wrap1->getCollisionObject() ) );
	g_added.insert( isFirst ? index0 : index1 );
	g_user = ( isFirst ? wrap0 : wrap1 )->getCollisionObject()->getUserPointer();
	point.m_combinedFriction = 0;
	return true;
}
bool processed( btManifoldPoint&, void*, void* )
{
	++g_processed;
	return false;
}
void started( btPersistentManifold* const& manifold )
{
	EXPECT_GT( manifold->getNumContacts(), 0 );
	++g_started;
}
void ended( btPersistentManifold* const& )
{
	++g_ended;
}

/// Bullet orders a pair by the order of insertion into the world: tests both orders.
class Callbacks : public testing::TestWithParam<bool>
{
protected:
	void TearDown() override
	{
		gContactAddedCallback = nullptr;
		gContactProcessedCallback = nullptr;
		gContactStartedCallback = nullptr;
		gContactEndedCallback = nullptr;
	}
};

TEST_P( Callbacks, CarryTheNodeAndTheUsersPointer )
{
	g_added.clear();
	g_started = g_ended = g_processed = 0;
	int own = 0;
	{
		TestWorld t;
		if ( GetParam() )
		{
			t.addFloor();
		}
		SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.2 ), 0 ) );
		if ( !GetParam() )
		{
			t.addFloor();
		}
		cube->setCollisionFlags( cube->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK );
		cube->setUserPointer( &own );
		gContactAddedCallback = added;
		gContactProcessedCallback = processed;
		gContactStartedCallback = started;
		gContactEndedCallback = ended;
		t.run( 120 );
		for ( const int node : g_added )
		{
			ASSERT_GE( node, 0 );
			EXPECT_LT( cube->nodePosition( node ).y(), btScalar( 0.1 ) );
		}
		EXPECT_EQ( g_added.size(), 16u );
		EXPECT_EQ( g_user, &own );
		EXPECT_EQ( g_started - g_ended, 16 );
		EXPECT_GT( g_processed, 16 * 100 );
		EXPECT_TRUE( cube->setLinearVelocity( btVector3( 2, 0, 0 ) ).ok() ); // the callback has removed friction
		t.run( 30 );
		EXPECT_NEAR( cube->linearVelocity().x(), 2, 0.02 );
	}
	EXPECT_EQ( g_started, g_ended );
}

INSTANTIATE_TEST_SUITE_P( BothOrders, Callbacks, testing::Bool() );

struct Ticks
{
	int before = 0, after = 0;
	btScalar length = 0;
};

TEST( Queries, TheGamesTickCallbacksComeOncePerGameStep )
{
	TestWorld t;
	t.addFloor();
	t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 1, 0 ) );
	Ticks ticks;
	t.world.setInternalTickCallback(
		[]( btDynamicsWorld* world, btScalar step ) {
			auto& seen = *static_cast<Ticks*>( world->getWorldUserInfo() );
			++seen.after;
			seen.length = step;
		},
		&ticks );
	t.world.setInternalTickCallback(
		[]( btDynamicsWorld* world, btScalar ) { ++static_cast<Ticks*>( world->getWorldUserInfo() )->before; }, &ticks, true );
	t.run( 10 );
	EXPECT_EQ( t.world.stepReport().substeps, 4 );
	EXPECT_EQ( ticks.before, 10 );
	EXPECT_EQ( ticks.after, 10 );
	EXPECT_FLOAT_EQ( float( ticks.length ), float( test::kFrame ) );
}

} // namespace
} // namespace pliant
