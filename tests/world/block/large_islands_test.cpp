// Soft bodies in large islands of rigid bodies: which of these their block solves (block_reach.h).

#include "world/block/block_contacts.h"
#include "world/block/block_reach.h"
#include "world/constants.h"
#include "world/joints/attachments.h"
#include "world/test_world.h"

#include <algorithm>

namespace pliant {
namespace {

using test::at;

/// A soft cube of 1 m with a plate on it that carries `count` boxes of 2 kg, which do not touch one another: one island.
struct LadenCube
{
	test::TestWorld t;
	SoftBody* cube = nullptr;
	btRigidBody* plate = nullptr;
	std::vector<btRigidBody*> boxes;
	std::vector<btVector3> from;

	/// `lumped`: the plate has the boxes' mass, and there are no boxes.
	explicit LadenCube( int count, bool lumped = false )
	{
		t.addFloor();
		cube = t.addSoft( test::cubeTemplate( 1.0f, 6 ), at( 0, btScalar( 0.5 ), 0 ), test::implicit( 3e5f ) );
		const btScalar half = btScalar( 0.6 );
		plate = t.addBox(
			20 + ( lumped ? 2 * btScalar( count ) : 0 ), btVector3( half, btScalar( 0.025 ), half ), at( 0, btScalar( 1.025 ), 0 ) );
		for ( int k = 0; k < count && !lumped; ++k )
		{
			from.emplace_back( btScalar( k % 12 ) * btScalar( 0.098 ) - btScalar( 0.539 ), btScalar( 1.09 ),
				btScalar( k / 12 ) * btScalar( 0.098 ) - btScalar( 0.539 ) );
			boxes.push_back( t.addBox( 2, btVector3( btScalar( 0.04 ), btScalar( 0.04 ), btScalar( 0.04 ) ),
				btTransform( btQuaternion::getIdentity(), from.back() ) ) );
		}
	}
};

/// All bodies are in one block.
struct OneBlock : BlockLookup
{
	int blockOf( const SoftBody& ) const override { return 0; }
	int blockOfIsland( int tag ) const override { return tag >= 0 ? 0 : -1; }
	int softPart( const SoftBody& ) const override { return 0; }
	bool takesPart( int, const btCollisionObject& ) const override { return true; }
	int rigidPart( int, btCollisionObject& ) override { return 0; }
};

// A cube in a heap of 3 000: the number of rigid bodies in a block is bounded, and those nearest to the soft body are chosen first.
TEST( LargeIslands, TakePartUpToTheLimitNearestFirst )
{
	for ( const int count : { 60, 95, 96, 144 } )
	{
		LadenCube scene( count );
		scene.t.run( 20 ); // after ten the plate is falling away from many of them;
		BlockReach reach;
		reach.choose( scene.t.parts.dispatcher, Attachments(), OneBlock(), 1, btVector3( 0, -10, 0 ), ManifoldFilter() );
		int taking = 0;
		for ( const btRigidBody* box : scene.boxes )
		{
			taking += reach.takesPart( 0, *box ) ? 1 : 0;
		}
		EXPECT_TRUE( reach.takesPart( 0, *scene.plate ) ) << count;
		EXPECT_EQ( taking, std::min( count, kMostBlockRigid - 1 ) );
	}
}

// All bodies around a cube on a heap were in its block, which cost up to half of Bullet's frame.
TEST( LargeIslands, LeaveSupportsToBullet )
{
	test::TestWorld t;
	t.addFloor();
	const btScalar half = btScalar( 0.1 );
	std::vector<btRigidBody*> boxes;
	for ( int k = 0; k < 64; ++k )
	{
		const double x = 0.2 * ( k % 4 ) - 0.3, z = 0.2 * ( k / 4 % 4 ) - 0.3, y = 0.1 + 0.2 * ( k / 16 );
		boxes.push_back( t.addBox( 8, btVector3( half, half, half ), at( btScalar( x ), btScalar( y ), btScalar( z ) ) ) );
	}
	t.addSoft( test::cubeTemplate( 0.6f, 6 ), at( 0, btScalar( 1.1 ), 0 ), test::implicit( 3e5f ) );
	btRigidBody* const load = t.addBox( 8, btVector3( half, half, half ), at( 0, btScalar( 1.5 ), 0 ) );
	t.run( 20 );
	BlockReach reach;
	reach.choose( t.parts.dispatcher, Attachments(), OneBlock(), 1, btVector3( 0, -10, 0 ), ManifoldFilter() );
	EXPECT_TRUE( reach.takesPart( 0, *load ) );
	for ( std::size_t k = 0; k < boxes.size(); ++k )
	{
		const bool isInTopLayer = k >= 48;
		EXPECT_TRUE( isInTopLayer || !reach.takesPart( 0, *boxes[k] ) ) << k;
	}
	EXPECT_TRUE( reach.takesPart( 0, *boxes[48 + 5] ) ) << "below the middle of the cube";
}

// Bullet solves the remaining bodies; their weight still acts in full.
TEST( LargeIslands, CarryTheirWholeWeight )
{
	LadenCube lump( 144, true ), scene( 144 );
	for ( LadenCube* all : { &lump, &scene } )
	{
		all->plate->setActivationState( DISABLE_DEACTIVATION );
		all->t.run( 180 );
	}
	const btScalar height = scene.plate->getWorldTransform().getOrigin().y(), wanted = lump.plate->getWorldTransform().getOrigin().y();
	EXPECT_LT( wanted, btScalar( 1.01 ) ) << "the cube is compressed";
	EXPECT_NEAR( height, wanted, 0.003 );
	EXPECT_GT( scene.plate->getWorldTransform().getBasis()[1][1], btScalar( 0.9999 ) ) << "the plate is level";
	for ( std::size_t k = 0; k < scene.boxes.size(); ++k )
	{
		const btVector3 went = scene.boxes[k]->getWorldTransform().getOrigin() - scene.from[k];
		EXPECT_LT( btVector3( went.x(), 0, went.z() ).length(), btScalar( 0.05 ) ) << k; // on a rigid cube Bullet's move .014 m
		EXPECT_NEAR( scene.boxes[k]->getWorldTransform().getOrigin().y(), height + btScalar( 0.065 ), 0.01 ) << k;
	}
}

} // namespace
} // namespace pliant
