// Bullet's kinematic character on soft bodies, compared with the same on rigid ones. It presses with unlimited force, but must not sink
// through soft bodies, crush them, or be thrown up by them.

#include "twin_worlds.h"

#include <BulletDynamics/Character/btKinematicCharacterController.h>

#include <cmath>
#include <string>

namespace pliant {
namespace {

using test::at;
using test::kFrame;
using test::RigidScene;

constexpr btScalar kRadius = btScalar( 0.3 ), kHeight = btScalar( 1 ); // of the capsule, m
constexpr btScalar kFootToMiddle = kRadius + kHeight / 2;

/// A character in any world.
class Walker
{
public:
	Walker( btDiscreteDynamicsWorld& world, const btVector3& foot ) :
		m_world( world ), m_capsule( kRadius, kHeight ), m_character( &m_ghost, &m_capsule, btScalar( 0.35 ), btVector3( 0, 1, 0 ) )
	{
		world.getPairCache()->setInternalGhostPairCallback( &m_pairs );
		m_ghost.setCollisionShape( &m_capsule );
		m_ghost.setCollisionFlags( btCollisionObject::CF_CHARACTER_OBJECT );
		m_ghost.setWorldTransform( at( foot.x(), foot.y() + kFootToMiddle, foot.z() ) );
		world.addCollisionObject(
			&m_ghost, btBroadphaseProxy::CharacterFilter, btBroadphaseProxy::StaticFilter | btBroadphaseProxy::DefaultFilter );
		world.addAction( &m_character );
		m_character.setGravity( btVector3( 0, -10, 0 ) );
	}
	~Walker()
	{
		m_world.removeAction( &m_character );
		m_world.removeCollisionObject( &m_ghost );
		m_world.getPairCache()->setInternalGhostPairCallback( nullptr );
	}
	Walker( const Walker& ) = delete;
	Walker& operator=( const Walker& ) = delete;

	btKinematicCharacterController& character() { return m_character; }
	btVector3 foot() const { return m_ghost.getWorldTransform().getOrigin() - btVector3( 0, kFootToMiddle, 0 ); }
	void run( int frames )
	{
		for ( int k = 0; k < frames; ++k )
		{
			m_world.stepSimulation( kFrame, 0 );
			lowest = btMin( lowest, foot().y() );
			highest = btMax( highest, foot().y() );
		}
	}
	void watch() { lowest = highest = foot().y(); }
	btScalar lowest = SIMD_INFINITY, highest = -SIMD_INFINITY; ///< height of the foot since watch(), m

private:
	btDiscreteDynamicsWorld& m_world;
	btGhostPairCallback m_pairs;
	btCapsuleShape m_capsule;
	btPairCachingGhostObject m_ghost;
	btKinematicCharacterController m_character;
};

struct Ground
{
	const char* name;
	Elasticity elasticity;
	float youngsModulus;
};

class Characters : public testing::TestWithParam<Ground>
{
protected:
	static Material material() { return test::stepping( GetParam().elasticity, GetParam().youngsModulus ); }
	static constexpr float kCell = 0.125f;
};

INSTANTIATE_TEST_SUITE_P( Grounds, Characters,
	testing::Values( Ground{ "Explicit2e4", Elasticity::Explicit, 2e4f }, Ground{ "Explicit3e5", Elasticity::Explicit, 3e5f },
		Ground{ "Explicit1e7", Elasticity::Explicit, 1e7f }, Ground{ "Implicit2e4", Elasticity::Implicit, 2e4f },
		Ground{ "Implicit3e6", Elasticity::Implicit, 3e6f }, Ground{ "Implicit1e7", Elasticity::Implicit, 1e7f },
		Ground{ "Automatic3e5", Elasticity::Automatic, 3e5f } ),
	[]( const auto& with ) { return std::string( with.param.name ); } );

/// Returns the highest point of a body's nodes under a character, m.
btScalar topUnder( const SoftBody& body, const btVector3& foot )
{
	btScalar high = -SIMD_INFINITY;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const btVector3 at = body.nodePosition( i );
		if ( btVector3( at.x() - foot.x(), 0, at.z() - foot.z() ).length() < kRadius )
		{
			high = btMax( high, at.y() + body.nodeRadius( i ) );
		}
	}
	return high;
}

TEST_P( Characters, StandOnASoftCube )
{
	test::TestWorld own;
	own.addFloor();
	SoftBody* const cube = own.addSoft( test::cubeTemplate( 1, 8 ), at( 0, btScalar( 0.5 ), 0 ), material() );
	own.run( 240 );
	const btScalar top = topUnder( *cube, btVector3( 0, 0, 0 ) );
	Walker walker( own.world, btVector3( 0, top + btScalar( 0.1 ), 0 ) );
	walker.run( 60 );
	walker.watch();
	walker.run( 240 );
	EXPECT_GT( walker.lowest, top - btScalar( kCell / 2 ) );
	EXPECT_LT( walker.highest, top + btScalar( kCell / 2 ) );
	EXPECT_NEAR( topUnder( *cube, btVector3( 0, 0, 0 ) ), top, 0.02 );
	EXPECT_TRUE( walker.character().onGround() );
}

TEST_P( Characters, JumpAsHighAsFromTheFloor )
{
	const auto jump = []( Walker& walker ) {
		walker.run( 60 );
		walker.character().jump( btVector3( 0, 5, 0 ) );
		walker.watch();
		const btScalar from = walker.foot().y();
		walker.run( 60 );
		return walker.highest - from;
	};
	test::BulletWorld bullet;
	RigidScene scene( bullet.world );
	scene.addFloor();
	Walker twin( bullet.world, btVector3( 0, btScalar( 0.1 ), 0 ) );
	const btScalar expected = jump( twin );
	EXPECT_GT( expected, 0.5 );

	test::TestWorld own;
	own.addFloor();
	own.addSoft( test::cubeTemplate( 1, 8 ), at( 0, btScalar( 0.5 ), 0 ), material() );
	own.run( 60 );
	Walker walker( own.world, btVector3( 0, btScalar( 1.1 ), 0 ) );
	EXPECT_NEAR( jump( walker ), expected, btScalar( 0.05 ) * expected );
}

// The character steps onto a soft slab of .25 m, and down from it at the far side.
TEST_P( Characters, WalkOverASoftStep )
{
	test::TestWorld own;
	own.addFloor();
	SoftBody* const slab = own.addSoft( test::block( 12, 2, 12, kCell ), at( btScalar( 1.5 ), kCell, 0 ), material() );
	slab->setFriction( 1 );
	own.run( 60 );
	Walker walker( own.world, btVector3( 0, 0, 0 ) );
	walker.run( 20 );
	walker.character().setWalkDirection( btVector3( btScalar( 0.03 ), 0, 0 ) );
	walker.watch();
	walker.run( 60 );
	EXPECT_GT( walker.foot().y(), topUnder( *slab, walker.foot() ) - btScalar( kCell / 2 ) ) << "at " << walker.foot().x();
	EXPECT_GT( walker.foot().y(), kCell );
	walker.run( 40 );
	EXPECT_NEAR( walker.foot().x(), 3, 0.15 );
	EXPECT_GT( walker.lowest, -0.06 );
}

TEST_P( Characters, WalkOverAHeapWithoutSinking )
{
	test::TestWorld own;
	own.addFloor();
	own.addBox( 0, btVector3( 3, 1, btScalar( 0.1 ) ), at( 1, 1, btScalar( 0.65 ) ) ); // a trench that holds the cubes
	own.addBox( 0, btVector3( 3, 1, btScalar( 0.1 ) ), at( 1, 1, btScalar( -0.65 ) ) );
	const auto cube = test::cubeTemplate( 0.25f, 3 );
	for ( int k = 0; k < 24; ++k )
	{
		SoftBody* const body = own.addSoft(
			cube, at( btScalar( 0.3 * ( k % 8 ) ), btScalar( 0.13 ), btScalar( 0.3 * ( k / 8 - 1 ) ) ), material() );
		body->setFriction( 1 );
	}
	own.run( 60 );
	Walker walker( own.world, btVector3( btScalar( 0.3 ), btScalar( 0.3 ), 0 ) );
	walker.run( 30 );
	walker.character().setWalkDirection( btVector3( btScalar( 0.02 ), 0, 0 ) );
	walker.watch();
	walker.run( 60 );
	EXPECT_GT( walker.foot().x(), 1.3 );
	EXPECT_GT( walker.lowest, 0.25 - 0.25 / 3 );
}

// A character that walks against a block on the floor pushes it about as far as a rigid one.
TEST_P( Characters, PushSoftBlocksAsFarAsRigidOnes )
{
	if ( GetParam().youngsModulus < 1e5f )
	{
		GTEST_SKIP() << "such a soft block is bent, not pushed";
	}
	const auto push = []( Walker& walker ) {
		walker.run( 10 );
		walker.character().setWalkDirection( btVector3( btScalar( 0.03 ), 0, 0 ) );
		walker.run( 120 );
		return walker.foot().x();
	};
	test::BulletWorld bullet;
	RigidScene scene( bullet.world );
	scene.addFloor();
	btRigidBody* const box = scene.addBox(
		125, btVector3( btScalar( 0.25 ), btScalar( 0.25 ), btScalar( 0.25 ) ), at( 1, btScalar( 0.25 ), 0 ) );
	Walker twin( bullet.world, btVector3( 0, 0, 0 ) );
	push( twin );
	const btScalar expected = box->getWorldTransform().getOrigin().x() - 1;

	test::TestWorld own;
	own.addFloor();
	SoftBody* const block = own.addSoft( test::cubeTemplate( 0.5f, 4 ), at( 1, btScalar( 0.25 ), 0 ), material() );
	own.run( 60 );
	const btScalar from = block->massCentre().x();
	Walker walker( own.world, btVector3( 0, 0, 0 ) );
	push( walker );
	const btScalar found = block->massCentre().x() - from;
	EXPECT_GT( found, btScalar( 0.7 ) * expected );
	EXPECT_LT( found, btScalar( 1.4 ) * expected );
}

} // namespace
} // namespace pliant
