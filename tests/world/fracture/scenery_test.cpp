// Pieces that have settled become scenery: static, for nothing.

#include "world/test_world.h"

#include "pliant/io/snapshot.h"

#include <algorithm>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::stiff;
using test::TestWorld;

/// A block that has broken on the floor, and whose pieces sleep.
struct Heap
{
	TestWorld test;
	SoftBody* body = nullptr;
	int settled = 0;

	explicit Heap( float settleTime, float rigidStrain = 0.005f, btScalar turn = btScalar( 0.3 ) )
	{
		test.add( 0, new btStaticPlaneShape( btVector3( 0, 1, 0 ), 0 ), at( 0, 0, 0 ) );
		DebrisBudget budget;
		budget.settleTime = settleTime;
		EXPECT_TRUE( test.world.setDebrisBudget( budget ).ok() );
		Material material = stiff( 2e6f );
		material.rigidStrain = rigidStrain;
		body = test.addSoft( block( 6, 6, 6, 0.1f ),
			btTransform( btQuaternion( btVector3( 0, 0, 1 ), turn ), btVector3( 0, btScalar( 0.6 ), 0 ) ), material );
		Fracture fracture;
		fracture.rule = BreakRule::Shards;
		fracture.breakStrain = 0.01f;
		fracture.shardSize = 0.25f;
		EXPECT_TRUE( body->setFracture( fracture ).ok() );
		EXPECT_TRUE( body->setLinearVelocity( btVector3( 0, -12, 0 ) ).ok() );
	}

	void run( int frames )
	{
		for ( int k = 0; k < frames; ++k )
		{
			test.run( 1 );
			settled += test.world.stepReport().debrisSettled;
		}
	}

	std::vector<SoftBody*> pieces()
	{
		std::vector<SoftBody*> all;
		for ( int k = 0; k < test.world.softBodyCount(); ++k )
		{
			test.world.softBody( k ) != body ? all.push_back( test.world.softBody( k ) ) : void();
		}
		return all;
	}

	int awake()
	{
		const std::vector<SoftBody*> all = pieces();
		return int( std::count_if( all.begin(), all.end(), []( const SoftBody* piece ) { return piece->isActive(); } ) );
	}
};

TEST( Scenery, PiecesThatHaveSleptAreStaticAndCountInNoBudget )
{
	for ( const float rigidStrain : { 0.0f, 0.005f } ) // deformable pieces, and pieces in their rigid state
	{
		Heap heap( 0.5f, rigidStrain );
		heap.run( 720 );
		const std::vector<SoftBody*> pieces = heap.pieces();
		ASSERT_GT( pieces.size(), 5u );
		EXPECT_EQ( heap.settled, int( pieces.size() ) );
		EXPECT_EQ( heap.test.world.stepReport().debrisPieces, 0 );
		EXPECT_EQ( heap.test.world.fragmentCount(), int( pieces.size() ) ) << "they are still there";
		std::vector<btVector3> before;
		for ( SoftBody* piece : pieces )
		{
			EXPECT_TRUE( piece->isStaticObject() );
			before.push_back( piece->massCentre() );
		}
		// A heavy ball falls on them, and a light one: neither moves nor wakes a piece, and both rest on them or on the floor.
		btRigidBody* const heavy = heap.test.add(
			500, new btSphereShape( btScalar( 0.3 ) ), btTransform( btQuaternion::getIdentity(), before[0] + btVector3( 0, 2, 0 ) ) );
		btRigidBody* const light = heap.test.add(
			1, new btSphereShape( btScalar( 0.1 ) ), btTransform( btQuaternion::getIdentity(), before[1] + btVector3( 0, 1, 0 ) ) );
		for ( int k = 0; k < 120; ++k )
		{
			heap.run( 1 );
			ASSERT_EQ( heap.awake(), 0 ) << k;
		}
		for ( std::size_t k = 0; k < pieces.size(); ++k )
		{
			EXPECT_EQ( pieces[k]->massCentre(), before[k] );
		}
		EXPECT_GT( heavy->getCenterOfMassPosition().y(), 0.28 );
		EXPECT_GT( light->getCenterOfMassPosition().y(), 0.09 );
	}
}

TEST( Scenery, ADynamicPieceMovesAgainAndKeptOnesNeverSettle )
{
	Heap heap( 0.5f );
	heap.run( 60 );
	ASSERT_GT( heap.pieces().size(), 5u );
	SoftBody* const kept = heap.pieces().back();
	kept->setKept( true );
	heap.run( 660 );
	const std::vector<SoftBody*> pieces = heap.pieces();
	EXPECT_EQ( heap.settled, int( pieces.size() ) - 1 );
	EXPECT_FALSE( kept->isStaticObject() );
	SoftBody* const piece = pieces.front();
	const btScalar height = piece->massCentre().y();
	piece->setCollisionFlags( piece->getCollisionFlags() & ~btCollisionObject::CF_STATIC_OBJECT );
	heap.run( 2 );
	EXPECT_EQ( heap.test.world.stepReport().debrisPieces, 2 );
	ASSERT_TRUE( piece->applyCentralImpulse( piece->mass() * btVector3( 0, 4, 0 ) ).ok() );
	heap.run( 10 );
	EXPECT_GT( piece->massCentre().y(), height + btScalar( 0.3 ) );
	heap.run( 600 );
	EXPECT_TRUE( piece->isStaticObject() ) << "it has settled again";
}

// Two pieces lean on each other, and the load on one of them moves by more than its rigid state bears: it changed its state every few
// steps, each change woke both, and they never slept. In other heaps a piece rose on the one below while it was rigid, since hulls do not
// reach into the hollows between spheres, deformed for want of load, sank back and became rigid again.
TEST( Scenery, PiecesSleepThoughLoadsMoveBetweenThem )
{
	for ( const btScalar turn : { btScalar( 0.3 ), btScalar( 0.35 ), btScalar( 0.47 ) } )
	{
		Heap heap( 0, 0.005f, turn );
		heap.run( 720 );
		EXPECT_EQ( heap.awake(), 0 ) << turn;
		EXPECT_FALSE( heap.body->isActive() ) << turn;
		EXPECT_EQ( heap.settled, 0 ) << "without a settle time nothing settles";
		EXPECT_EQ( heap.test.world.stepReport().debrisPieces, int( heap.pieces().size() ) );
	}
}

TEST( Scenery, IsPartOfASnapshot )
{
	Heap heap( 0.5f );
	heap.run( 720 );
	std::vector<std::byte> saved;
	ASSERT_TRUE( saveWorld( heap.test.world, saved ).ok() );
	const auto positions = [&heap] {
		std::vector<btVector3> all;
		for ( SoftBody* piece : heap.pieces() )
		{
			all.push_back( piece->massCentre() );
		}
		return all;
	};
	const std::vector<btVector3> before = positions();
	SoftBody* const piece = heap.pieces().front();
	piece->setCollisionFlags( piece->getCollisionFlags() & ~btCollisionObject::CF_STATIC_OBJECT );
	ASSERT_TRUE( piece->applyCentralImpulse( piece->mass() * btVector3( 0, 4, 0 ) ).ok() );
	heap.run( 10 );
	EXPECT_NE( positions(), before );
	ASSERT_TRUE( restoreWorld( heap.test.world, saved ).ok() );
	heap.run( 10 );
	EXPECT_EQ( positions(), before );
	EXPECT_EQ( heap.awake(), 0 );
}

/// A bridge between two abutments, to which both ends are pinned, with a rigid crate and a soft one on it; all of them sleep.
struct Bridge
{
	TestWorld test;
	SoftBody* bridge = nullptr;
	btRigidBody* crate = nullptr;
	SoftBody* soft = nullptr;

	Bridge()
	{
		test.add( 0, new btStaticPlaneShape( btVector3( 0, 1, 0 ), 0 ), at( 0, 0, 0 ) );
		Material material = stiff( 2e7f );
		material.rigidStrain = 0.005f;
		bridge = test.addSoft( block( 16, 2, 4, 0.1f ), at( 0, 1, 0 ), material );
		const int west = bridge->pinNodesInside( btVector3( -1, 0, -1 ), btVector3( btScalar( -0.6 ), 2, 1 ) );
		const int east = bridge->pinNodesInside( btVector3( btScalar( 0.6 ), 0, -1 ), btVector3( 1, 2, 1 ) );
		EXPECT_EQ( west, 16 );
		EXPECT_EQ( east, 16 );
		crate = test.addBox(
			5, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ), at( btScalar( -0.15 ), btScalar( 1.2 ), 0 ) );
		soft = test.addSoft( block( 3, 3, 3, 0.08f ), at( btScalar( 0.2 ), btScalar( 1.22 ), 0 ), stiff( 1e5f ) );
		test.run( 400 );
	}
	/// Through the bridge, at a position along it; between two layers of nodes, so that the faces have no teeth.
	int cutAt( btScalar x ) { return bridge->cutPlane( btVector3( x, 1, 0 ), btVector3( 1, 0, 0 ) ); }
	bool sleeps() const { return !bridge->isActive() && !crate->isActive() && !soft->isActive(); }
	btScalar lowest() const { return btMin( crate->getCenterOfMassPosition().y(), soft->massCentre().y() ); }
};

// What stands on what: nothing falls while one support is left, and all of it when the last one goes, sleeping bodies too.
TEST( Supports, ABridgeFallsWithItsLoadWhenTheLastSupportGoes )
{
	Bridge b;
	ASSERT_TRUE( b.sleeps() );
	ASSERT_TRUE( b.bridge->isRigid() );
	EXPECT_GT( b.lowest(), 1.15 );
	ASSERT_GT( b.cutAt( btScalar( 0.4 ) ), 0 );
	b.test.run( 400 );
	EXPECT_EQ( b.test.world.softBodyCount(), 3 );
	EXPECT_GT( b.lowest(), 1.1 ) << "it is a cantilever now";
	EXPECT_TRUE( b.sleeps() );
	ASSERT_GT( b.cutAt( btScalar( -0.4 ) ), 0 );
	b.test.run( 90 );
	EXPECT_EQ( b.test.world.softBodyCount(), 4 );
	EXPECT_LT( b.crate->getCenterOfMassPosition().y(), 0.6 );
	EXPECT_LT( b.soft->massCentre().y(), 0.6 );
	b.test.run( 600 );
	EXPECT_TRUE( b.sleeps() );
}

// A game takes the bridge away under a sleeping load.
TEST( Supports, AHeldBodyThatIsRemovedWakesItsLoad )
{
	Bridge b;
	ASSERT_TRUE( b.sleeps() );
	b.test.world.removeSoftBody( b.bridge );
	b.test.run( 60 );
	EXPECT_LT( b.crate->getCenterOfMassPosition().y(), 0.3 );
	EXPECT_LT( b.soft->massCentre().y(), 0.3 );
}

// So does scenery that is made dynamic again and thrown away.
TEST( Supports, SceneryThatMovesAgainWakesItsLoad )
{
	Heap heap( 0.5f );
	heap.run( 720 );
	btVector3 middle( 0, 0, 0 );
	for ( SoftBody* piece : heap.pieces() )
	{
		middle += piece->massCentre() / btScalar( heap.pieces().size() );
	}
	// A plate over the middle of the heap.
	btRigidBody* const plate = heap.test.add( 20, new btBoxShape( btVector3( 2, btScalar( 0.1 ), 2 ) ),
		btTransform( btQuaternion::getIdentity(), btVector3( middle.x(), btScalar( 0.7 ), middle.z() ) ) );
	heap.run( 300 );
	ASSERT_FALSE( plate->isActive() );
	const btScalar height = plate->getCenterOfMassPosition().y();
	ASSERT_GT( height, 0.15 );
	for ( SoftBody* piece : heap.pieces() )
	{
		piece->setCollisionFlags( piece->getCollisionFlags() & ~btCollisionObject::CF_STATIC_OBJECT );
		EXPECT_TRUE( piece->applyCentralImpulse( piece->mass() * btVector3( 8, 1, 0 ) ).ok() );
	}
	heap.run( 10 );
	EXPECT_TRUE( plate->isActive() );
	EXPECT_NE( plate->getCenterOfMassPosition().y(), height );
}

} // namespace
} // namespace pliant
