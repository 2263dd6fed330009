// Objects may be destroyed in any order, and a bad number in one body does not affect others.

#include "support/explicit_material.h"
#include "world/test_world.h"

#include "world/bodies/soft_body_impl.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::BulletParts;
using test::stiff;
using test::TestWorld;

void stepFor( SoftBodyWorld& world, int frames )
{
	for ( int k = 0; k < frames; ++k )
	{
		world.stepSimulation( test::kFrame, 0 );
	}
}

TEST( Lifetime, BodiesAndWorldsAreDestroyedInAnyOrder )
{
	const auto shape = block( 3, 3, 3, 0.1f );
	BulletParts parts;
	btBoxShape boxShape( btVector3( 5, 1, 5 ) );
	for ( int order = 0; order < 5; ++order )
	{
		btRigidBody floor( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &boxShape ) );
		floor.setWorldTransform( at( 0, -1, 0 ) );
		auto world = std::make_unique<SoftBodyWorld>( &parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration );
		world->addRigidBody( &floor );
		auto low = std::move( SoftBody::create( shape, at( 0, btScalar( 0.15 ), 0 ) ).value );
		auto high = std::move( SoftBody::create( shape, at( 0, btScalar( 0.46 ), 0 ) ).value );
		world->addSoftBody( low.get() );
		world->addSoftBody( high.get() );
		world->addSoftBody( high.get() ); // no effect
		EXPECT_EQ( world->softBodyCount(), 2 );
		stepFor( *world, 20 );
		EXPECT_GT( world->stepReport().softContacts, 9 );
		if ( order == 0 ) // the world first
		{
			world->removeRigidBody( &floor );
			world.reset();
			EXPECT_EQ( low->getWorldArrayIndex(), -1 );
			EXPECT_EQ( low->getBroadphaseHandle(), nullptr );
			continue;
		}
		if ( order == 1 ) // the lower body while it carries the upper one
		{
			low.reset();
		}
		if ( order == 2 ) // as in a game's clean-up loop
		{
			world->removeCollisionObject( low.get() );
			world->removeCollisionObject( low.get() );
			low.reset();
			world->removeCollisionObject( high.get() );
			EXPECT_EQ( world->softBodyCount(), 0 );
		}
		if ( order == 3 ) // removed and added again
		{
			world->removeSoftBody( low.get() );
			EXPECT_TRUE( low->applyCentralImpulse( btVector3( 0, 10, 0 ) ).ok() );
			EXPECT_TRUE( low->teleport( at( 3, 0, 0 ) ).ok() );
			EXPECT_TRUE( low->reset( at( 3, 1, 0 ) ).ok() );
			EXPECT_TRUE( low->pinNode( 0 ).ok() );
			world->addSoftBody( low.get() );
		}
		stepFor( *world, 20 );
		EXPECT_TRUE( !high || high->isHealthy() );
		if ( order == 4 )
		{
			high.reset();
		}
		world->removeRigidBody( &floor );
		world.reset();
	}
	EXPECT_EQ( parts.dispatcher.getNumManifolds(), 0 );
}

TEST( Lifetime, AHundredWorlds )
{
	const auto shape = block( 2, 2, 2, 0.1f );
	for ( int k = 0; k < 100; ++k )
	{
		TestWorld t;
		t.addFloor();
		t.addSoft( shape, at( 0, btScalar( 0.11 ), 0 ) );
		t.run( 3 );
		EXPECT_GE( t.world.stepReport().softContacts, 4 );
	}
}

TEST( Lifetime, ADispatcherServesTheNextWorldAsBefore )
{
	// A soft world registers its algorithm with the dispatcher; after its destruction Bullet's own compounds must still collide.
	BulletParts parts;
	{
		SoftBodyWorld gone( &parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration );
	}
	btDiscreteDynamicsWorld world( &parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration );
	btBoxShape box( btVector3( 1, 1, 1 ) );
	btCompoundShape compound;
	compound.addChildShape( btTransform::getIdentity(), &box );
	btRigidBody floor( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &box ) );
	btRigidBody top( btRigidBody::btRigidBodyConstructionInfo( 1, nullptr, &compound, btVector3( 1, 1, 1 ) ) );
	top.setWorldTransform( at( 0, btScalar( 2.01 ), 0 ) );
	world.addRigidBody( &floor );
	world.addRigidBody( &top );
	for ( int k = 0; k < 30; ++k )
	{
		world.stepSimulation( test::kFrame, 0 );
	}
	EXPECT_NEAR( top.getWorldTransform().getOrigin().y(), 2, 0.02 );
	world.removeRigidBody( &top );
	world.removeRigidBody( &floor );
}

/// Calls refuse bad numbers, so the number is set in the middle of a step.
void poisonNode( SoftBody& body, int node, const btVector3& velocity )
{
	body.activate();
	body.impl().body->nodes().v.set( node, toVec3( velocity ) );
}

/// Returns the positions of a body next to one that is poisoned (or not).
std::vector<btVector3> beside( int poison )
{
	TestWorld t;
	t.addFloor();
	const auto shape = block( 3, 3, 3, 0.1f );
	SoftBody* bad = t.addSoft( shape, at( 0, btScalar( 0.3 ), 0 ) );
	SoftBody* good = t.addSoft( shape, at( 2, btScalar( 0.3 ), 0 ) );
	btRigidBody* box = t.addBox( 1, btVector3( 0.2f, 0.2f, 0.2f ), at( -2, 1, 0 ) );
	t.run( 20 );
	const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN(), huge = std::numeric_limits<btScalar>::max();
	const btVector3 poisons[] = { btVector3( 0, 0, 0 ), btVector3( nan, 0, 0 ), btVector3( 0, huge, 0 ), btVector3( huge, -huge, nan ) };
	if ( poison > 0 )
	{
		poisonNode( *bad, 5, poisons[poison] );
	}
	t.run( 40 );
	EXPECT_EQ( bad->isHealthy(), poison == 0 ) << "poison " << poison;
	EXPECT_EQ( t.world.stepReport().quarantined, poison == 0 ? 0 : 1 );
	std::vector<btVector3> positions;
	for ( int i = 0; i < bad->nodeCount(); ++i )
	{
		EXPECT_TRUE( std::isfinite( bad->nodePosition( i ).length() ) );
		EXPECT_LT( bad->nodePosition( i ).length(), btScalar( 2 ) );
		positions.push_back( good->nodePosition( i ) );
	}
	positions.push_back( box->getWorldTransform().getOrigin() );
	if ( poison > 0 )
	{
		EXPECT_TRUE( bad->reset( at( 0, 1, 0 ) ).ok() );
		t.run( 10 );
		EXPECT_TRUE( bad->isHealthy() );
		EXPECT_LT( bad->massCentre().y(), 1 ) << "it falls again";
	}
	return positions;
}

TEST( Lifetime, ABodyWithABadNumberStopsAndItsNeighboursGoOnBitForBit )
{
	const std::vector<btVector3> clean = beside( 0 );
	for ( const int poison : { 1, 2, 3 } )
	{
		const std::vector<btVector3> seen = beside( poison );
		for ( std::size_t k = 0; k < clean.size(); ++k )
		{
			ASSERT_EQ( ( clean[k] - seen[k] ).length(), 0 ) << "poison " << poison;
		}
	}
}

// Activation states that the game has set permanently survive a reset.
TEST( Lifetime, ResetWakesABodyAndKeepsPermanentStates )
{
	TestWorld t;
	const auto shape = block( 2, 2, 2, 0.1f );
	SoftBody* awake = t.addSoft( shape, at( 0, 1, 0 ) );
	SoftBody* asleep = t.addSoft( shape, at( 2, 1, 0 ) );
	awake->setActivationState( DISABLE_DEACTIVATION );
	EXPECT_TRUE( awake->reset( at( 0, 2, 0 ) ).ok() );
	EXPECT_EQ( awake->getActivationState(), DISABLE_DEACTIVATION );
	asleep->forceActivationState( ISLAND_SLEEPING );
	EXPECT_TRUE( asleep->reset( at( 2, 2, 0 ) ).ok() );
	EXPECT_EQ( asleep->getActivationState(), ACTIVE_TAG );
	for ( SoftBody* body : { awake, asleep } )
	{
		poisonNode( *body, 1, btVector3( std::numeric_limits<btScalar>::quiet_NaN(), 0, 0 ) );
	}
	t.run( 2 );
	for ( SoftBody* body : { awake, asleep } )
	{
		EXPECT_EQ( body->getActivationState(), DISABLE_SIMULATION );
		EXPECT_TRUE( body->reset( at( body == awake ? 0 : 2, 2, 0 ) ).ok() );
	}
	EXPECT_EQ( awake->getActivationState(), DISABLE_DEACTIVATION );
	EXPECT_EQ( asleep->getActivationState(), ACTIVE_TAG );
}

TEST( Lifetime, ThreadsDoNotChangeABit )
{
	std::vector<btVector3> positions[3];
	const int threads[] = { 1, 2, 8 };
	for ( int run = 0; run < 3; ++run )
	{
		TestWorld t;
		t.world.setThreadCount( threads[run] );
		t.addFloor();
		const auto shape = block( 4, 4, 4, 0.1f );
		for ( int k = 0; k < 6; ++k )
		{
			t.addSoft( shape,
				at( btScalar( 0.1 ) * btScalar( k % 2 ), btScalar( 0.3 ) + btScalar( 0.5 ) * btScalar( k ),
					btScalar( 0.05 ) * btScalar( k % 3 ) ) );
		}
		t.addBox( 10, btVector3( 0.2f, 0.2f, 0.2f ), at( 0, 4, 0 ) );
		t.run( 150 );
		for ( const auto& body : t.soft )
		{
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				positions[run].push_back( body->nodePosition( i ) );
			}
		}
	}
	for ( std::size_t k = 0; k < positions[0].size(); ++k )
	{
		ASSERT_EQ( ( positions[0][k] - positions[1][k] ).length(), 0 );
		ASSERT_EQ( ( positions[0][k] - positions[2][k] ).length(), 0 );
	}
}

// Counts the bytes from Bullet's allocator. The hooks carry no context.
std::size_t g_bytes = 0;
int g_allocations = 0;

void* countedAlloc( std::size_t size, int )
{
	constexpr std::size_t kHeader = 64; // keeps every alignment that Bullet requests, and stores the size in front
	char* block = static_cast<char*>( std::aligned_alloc( kHeader, ( size + 2 * kHeader - 1 ) / kHeader * kHeader ) );
	std::memcpy( block, &size, sizeof size );
	g_bytes += size;
	++g_allocations;
	return block + kHeader;
}

void countedFree( void* memory )
{
	if ( memory )
	{
		std::size_t size = 0;
		char* block = static_cast<char*>( memory ) - 64;
		std::memcpy( &size, block, sizeof size );
		g_bytes -= size;
		std::free( block );
	}
}

TEST( Lifetime, BulletsMemoryPerNodeIsSmallAndAWarmStepAllocatesNone )
{
	const auto shape = block( 13, 13, 13, 0.1f );
	btAlignedAllocSetCustomAligned( countedAlloc, countedFree );
	{
		TestWorld t;
		t.addFloor();
		const std::size_t before = g_bytes;
		SoftBody* cube = t.addSoft( shape, at( 0, btScalar( 0.66 ), 0 ), stiff( 2e5f ) );
		t.run( 100 );
		const int warm = g_allocations;
		const std::size_t bytes = g_bytes - before + std::size_t( t.parts.dispatcher.getNumManifolds() ) * sizeof( btPersistentManifold );
		t.run( 20 );
		EXPECT_EQ( t.world.stepReport().softContacts, 169 );
		EXPECT_EQ( g_allocations, warm ) << "a step of a body at rest allocates";
		const double perNode = double( bytes ) / cube->nodeCount();
		std::printf( "Bullet's side of a resting body of 2197 nodes: %.0f bytes a node\n", perNode );
		EXPECT_LT( perNode, sizeof( btScalar ) == 4 ? 500.0 : 1000.0 );
		EXPECT_GT( perNode, 100.0 );
	}
	btAlignedAllocSetCustomAligned( nullptr, nullptr );
}

TEST( Lifetime, RefusesInvalidArguments )
{
	EXPECT_EQ( SoftBody::create( nullptr, at( 0, 0, 0 ) ).status.code, ResultCode::BadArgument );
	btTransform bad = at( 0, 0, 0 );
	bad.setOrigin( btVector3( std::numeric_limits<btScalar>::quiet_NaN(), 0, 0 ) );
	EXPECT_EQ( SoftBody::create( block( 2, 2, 2, 0.1f ), bad ).status.code, ResultCode::BadArgument );
	Material material = test::explicitMaterial();
	material.density = -1.0f;
	EXPECT_EQ( SoftBody::create( block( 2, 2, 2, 0.1f ), at( 0, 0, 0 ), material ).status.code, ResultCode::BadMaterial );
}

} // namespace
} // namespace pliant
