// Soft bodies in each of Bullet's worlds, and in a game's own subclass of one.

#include "world/bases/stage_over.h"

#include <BulletSoftBody/btSoftBodyHelpers.h>

namespace pliant {
namespace {

using test::at;
using test::materialOf;
using test::StageOver;

template <class Base>
class OtherWorlds : public testing::Test
{};

using Bases = testing::Types<btDiscreteDynamicsWorld, btDiscreteDynamicsWorldMt, btMultiBodyDynamicsWorld, btSoftRigidDynamicsWorld,
	test::CountingWorld>;
TYPED_TEST_SUITE( OtherWorlds, Bases );

TYPED_TEST( OtherWorlds, CubeCarriesABoxAsInBulletsDiscreteWorld )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		btScalar height[2];
		{
			StageOver<btDiscreteDynamicsWorld> plain;
			plain.addCube( at( 0, btScalar( 0.55 ), 0 ), materialOf( elasticity ) );
			const btRigidBody* const box = plain.addBox(
				500, btVector3( btScalar( 0.4 ), btScalar( 0.1 ), btScalar( 0.4 ) ), at( 0, btScalar( 1.2 ), 0 ) );
			plain.run( 240 );
			height[0] = box->getWorldTransform().getOrigin().y();
		}
		StageOver<TypeParam> stage;
		SoftBody* const cube = stage.addCube( at( 0, btScalar( 0.55 ), 0 ), materialOf( elasticity ) );
		const btRigidBody* const box = stage.addBox(
			500, btVector3( btScalar( 0.4 ), btScalar( 0.1 ), btScalar( 0.4 ) ), at( 0, btScalar( 1.2 ), 0 ) );
		stage.run( 240 );
		height[1] = box->getWorldTransform().getOrigin().y();
		EXPECT_NEAR( height[1], height[0], 1e-3 ) << "elasticity " << int( elasticity );
		EXPECT_GT( height[1], btScalar( 1.0 ) );
		EXPECT_TRUE( cube->isHealthy() );
	}
}

// Bodies that a soft one does not touch keep their bits while it moves, in any world, where the soft body steps implicitly.
TYPED_TEST( OtherWorlds, BystandersKeepTheirBitsBesideAnImplicitCube )
{
	std::vector<btVector3> track[2];
	for ( int with = 0; with < 2; ++with )
	{
		StageOver<TypeParam> stage;
		for ( int k = 0; k < 4; ++k )
		{
			stage.addBox( 1, btVector3( btScalar( 0.3 ), btScalar( 0.3 ), btScalar( 0.3 ) ),
				at( btScalar( 0.1 ) * btScalar( k ), btScalar( 0.4 ) + btScalar( 0.7 ) * btScalar( k ), 0 ) );
		}
		if ( with == 1 )
		{
			stage.addCube( at( 20, 2, 0 ), materialOf( Elasticity::Implicit ) );
		}
		for ( int frame = 0; frame < 120; ++frame )
		{
			stage.run( 1 );
			for ( const auto& body : stage.rigid )
			{
				track[with].push_back( body->getWorldTransform().getOrigin() );
			}
		}
	}
	std::size_t differences = 0;
	for ( std::size_t k = 0; k < track[0].size(); ++k )
	{
		differences += track[0][k] == track[1][k] ? 0 : 1;
	}
	EXPECT_EQ( differences, 0u );
}

TYPED_TEST( OtherWorlds, FragmentsComeOffAndLeaveWithTheWorld )
{
	Fracture brittle;
	brittle.rule = BreakRule::Distance;
	brittle.breakStrain = 0.02f;
	StageOver<TypeParam> stage;
	SoftBody* const cube = stage.addCube( at( 0, 3, 0 ), materialOf( Elasticity::Explicit ), brittle );
	EXPECT_TRUE( cube->setLinearVelocity( btVector3( 0, -12, 0 ) ).ok() );
	stage.run( 60 );
	EXPECT_GT( stage.world->fragmentCount(), 0 );
	EXPECT_EQ( stage.world->softBodyCount(), stage.world->fragmentCount() + 1 );
}

TYPED_TEST( OtherWorlds, ActionsRunOnceAGameStep )
{
	struct Counter : btActionInterface
	{
		void updateAction( btCollisionWorld*, btScalar step ) override
		{
			++calls;
			seconds += double( step );
		}
		void debugDraw( btIDebugDraw* ) override {}
		int calls = 0;
		double seconds = 0.0;
	} counter;
	int ticks = 0;
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		StageOver<TypeParam> stage;
		stage.addCube( at( 0, 2, 0 ), materialOf( elasticity ) );
		stage.world->addAction( &counter );
		stage.world->setInternalTickCallback(
			[]( btDynamicsWorld* world, btScalar ) { ++*static_cast<int*>( world->getWorldUserInfo() ); }, &ticks );
		stage.run( 60 );
		stage.world->removeAction( &counter );
	}
	EXPECT_EQ( counter.calls, 120 );
	EXPECT_NEAR( counter.seconds, 2.0, 1e-4 );
	EXPECT_EQ( ticks, 120 );
}

TEST( OtherWorlds, AGamesOverridesAreCalledOnceAPass )
{
	StageOver<test::CountingWorld> stage;
	stage.addCube( at( 0, 2, 0 ), materialOf( Elasticity::Implicit ) );
	stage.run( 10 );
	EXPECT_EQ( stage.world->integrations, 10 );
}

// Bullet's own cloth next to a soft cube moves as without it, and the bodies of both kinds are distinguished.
TEST( OtherWorlds, BulletsClothKeepsItsBitsBesideACube )
{
	std::vector<btVector3> track[2];
	for ( int with = 0; with < 2; ++with )
	{
		StageOver<btSoftRigidDynamicsWorld> stage;
		btSoftBodyWorldInfo& info = stage.world->getWorldInfo();
		info.m_broadphase = &stage.parts.broadphase;
		info.m_dispatcher = &stage.parts.dispatcher;
		info.m_gravity = stage.world->getGravity();
		btSoftBody* const cloth = btSoftBodyHelpers::CreatePatch(
			info, btVector3( 3, 2, 0 ), btVector3( 5, 2, 0 ), btVector3( 3, 2, 2 ), btVector3( 5, 2, 2 ), 9, 9, 1 + 2, true );
		stage.world->addSoftBody( cloth );
		if ( with == 1 )
		{
			stage.addCube( at( -5, 2, 0 ), materialOf( Elasticity::Implicit ) );
			EXPECT_EQ( stage.world->softBodyCount(), 1 );
			EXPECT_EQ( stage.world->getSoftBodyArray().size(), 1 );
		}
		for ( int frame = 0; frame < 60; ++frame )
		{
			stage.run( 1 );
			for ( int k = 0; k < cloth->m_nodes.size(); ++k )
			{
				track[with].push_back( cloth->m_nodes[k].m_x );
			}
		}
		stage.world->removeSoftBody( cloth );
		delete cloth;
	}
	ASSERT_EQ( track[0].size(), track[1].size() );
	std::size_t differences = 0;
	for ( std::size_t k = 0; k < track[0].size(); ++k )
	{
		differences += track[0][k] == track[1][k] ? 0 : 1;
	}
	EXPECT_EQ( differences, 0u );
}

TEST( OtherWorlds, BulletsClothFallsAsFastBesideAnExplicitCube )
{
	btScalar height[2];
	for ( int with = 0; with < 2; ++with )
	{
		StageOver<btSoftRigidDynamicsWorld> stage;
		stage.addBox( 1, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ), at( -20, 9, 0 ) );
		btSoftBodyWorldInfo& info = stage.world->getWorldInfo();
		info.m_broadphase = &stage.parts.broadphase;
		info.m_dispatcher = &stage.parts.dispatcher;
		info.m_gravity = stage.world->getGravity();
		btSoftBody* const cloth = btSoftBodyHelpers::CreatePatch(
			info, btVector3( 0, 9, 0 ), btVector3( 2, 9, 0 ), btVector3( 0, 9, 2 ), btVector3( 2, 9, 2 ), 5, 5, 0, true );
		stage.world->addSoftBody( cloth );
		if ( with == 1 )
		{
			stage.addCube( at( 20, 5, 0 ), materialOf( Elasticity::Explicit ) );
		}
		stage.run( 45 );
		height[with] = cloth->m_nodes[12].m_x.y();
		stage.world->removeSoftBody( cloth );
		delete cloth;
	}
	EXPECT_NEAR( height[1], height[0], 0.1 );
}

} // namespace
} // namespace pliant
