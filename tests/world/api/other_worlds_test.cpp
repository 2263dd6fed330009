// Soft bodies in each of Bullet's worlds, and in a game's own subclass of one.

#include "support/bullet_worlds.h"
#include "support/explicit_material.h"
#include "world/test_world.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>

namespace pliant {
namespace {

using test::at;
using test::kFrame;

/// A world over Base with a floor and the objects of a test.
template <class Base>
struct Stage
{
	using World = SoftBodyWorldOver<Base>;

	Stage() { addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) ); }
	~Stage()
	{
		soft.clear();
		for ( const auto& body : rigid )
		{
			world->removeRigidBody( body.get() );
		}
	}
	btRigidBody* addBox( btScalar mass, const btVector3& half, const btTransform& where )
	{
		shapes.push_back( std::make_unique<btBoxShape>( half ) );
		btVector3 inertia( 0, 0, 0 );
		shapes.back()->calculateLocalInertia( mass, inertia );
		btRigidBody::btRigidBodyConstructionInfo info( mass, nullptr, shapes.back().get(), inertia );
		info.m_startWorldTransform = where;
		rigid.push_back( std::make_unique<btRigidBody>( info ) );
		world->addRigidBody( rigid.back().get() );
		return rigid.back().get();
	}
	SoftBody* addCube( const btTransform& where, const Material& material, const Fracture& fracture = {} )
	{
		SoftBodyResult made = SoftBody::create( test::block( 4, 4, 4, 0.25f ), where, material );
		EXPECT_TRUE( made.ok() ) << made.status.sentence;
		EXPECT_TRUE( made.value->setFracture( fracture ).ok() );
		soft.push_back( std::move( made.value ) );
		world->addSoftBody( soft.back().get() );
		return soft.back().get();
	}
	void run( int frames )
	{
		for ( int frame = 0; frame < frames; ++frame )
		{
			world->stepSimulation( kFrame, 1, kFrame );
		}
	}

	test::PartsOf<Base> parts;
	std::unique_ptr<World> world = parts.template make<World>();
	std::vector<std::unique_ptr<btCollisionShape>> shapes;
	std::vector<std::unique_ptr<btRigidBody>> rigid;
	std::vector<std::unique_ptr<SoftBody>> soft;
};

template <class Base>
class OtherWorlds : public testing::Test
{};

using Bases = testing::Types<btDiscreteDynamicsWorld, btDiscreteDynamicsWorldMt, btMultiBodyDynamicsWorld, btSoftRigidDynamicsWorld,
	test::CountingWorld>;
TYPED_TEST_SUITE( OtherWorlds, Bases );

Material materialOf( Elasticity elasticity )
{
	Material made = test::explicitMaterial();
	made.youngsModulus = 1e6f;
	made.elasticity = elasticity;
	return made;
}

TYPED_TEST( OtherWorlds, CubeCarriesABoxAsInBulletsDiscreteWorld )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		btScalar height[2];
		{
			Stage<btDiscreteDynamicsWorld> plain;
			plain.addCube( at( 0, btScalar( 0.55 ), 0 ), materialOf( elasticity ) );
			const btRigidBody* const box = plain.addBox(
				500, btVector3( btScalar( 0.4 ), btScalar( 0.1 ), btScalar( 0.4 ) ), at( 0, btScalar( 1.2 ), 0 ) );
			plain.run( 240 );
			height[0] = box->getWorldTransform().getOrigin().y();
		}
		Stage<TypeParam> stage;
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
		Stage<TypeParam> stage;
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
	Stage<TypeParam> stage;
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
		Stage<TypeParam> stage;
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
	Stage<test::CountingWorld> stage;
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
		Stage<btSoftRigidDynamicsWorld> stage;
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

// Where the base's step cannot be divided by objects, the whole world takes the substeps of an awake explicit body: no object takes two
// steps in one.
TEST( OtherWorlds, AMultiBodyFallsAsFastBesideAnExplicitCube )
{
	btScalar height[2];
	for ( int with = 0; with < 2; ++with )
	{
		Stage<btMultiBodyDynamicsWorld> stage;
		if ( with == 1 )
		{
			stage.addCube( at( 20, 5, 0 ), materialOf( Elasticity::Explicit ) );
		}
		btBoxShape shape( btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ) );
		btVector3 inertia;
		shape.calculateLocalInertia( 1, inertia );
		btMultiBody body( 0, 1, inertia, false, false );
		body.setBasePos( btVector3( 0, 9, 0 ) );
		body.finalizeMultiDof();
		btMultiBodyLinkCollider collider( &body, -1 );
		collider.setCollisionShape( &shape );
		collider.setWorldTransform( at( 0, 9, 0 ) );
		body.setBaseCollider( &collider );
		stage.world->addMultiBody( &body );
		stage.world->addCollisionObject( &collider, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter );
		stage.run( 45 );
		height[with] = body.getBasePos().y();
		stage.world->removeCollisionObject( &collider );
		stage.world->removeMultiBody( &body );
	}
	EXPECT_NEAR( height[1], height[0], 0.1 );
}

TEST( OtherWorlds, BulletsClothFallsAsFastBesideAnExplicitCube )
{
	btScalar height[2];
	for ( int with = 0; with < 2; ++with )
	{
		Stage<btSoftRigidDynamicsWorld> stage;
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

/// A multibody with a free base of 20 kg on a soft cube.
void restMultiBody( Elasticity elasticity )
{
	Stage<btMultiBodyDynamicsWorld> stage;
	SoftBody* const cube = stage.addCube( at( 0, btScalar( 0.5 ), 0 ), materialOf( elasticity ) );
	btBoxShape shape( btVector3( btScalar( 0.3 ), btScalar( 0.1 ), btScalar( 0.3 ) ) );
	btVector3 inertia;
	shape.calculateLocalInertia( 20, inertia );
	btMultiBody body( 0, 20, inertia, false, false );
	body.setBasePos( btVector3( 0, btScalar( 1.2 ), 0 ) );
	body.finalizeMultiDof();
	btMultiBodyLinkCollider collider( &body, -1 );
	collider.setCollisionShape( &shape );
	collider.setWorldTransform( at( 0, btScalar( 1.2 ), 0 ) );
	body.setBaseCollider( &collider );
	stage.world->addMultiBody( &body );
	stage.world->addCollisionObject( &collider, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter );
	stage.run( 300 );
	EXPECT_NEAR( body.getBasePos().y(), 1.1, 0.03 ) << "elasticity " << int( elasticity );
	EXPECT_LT( body.getBaseVel().length(), 0.05 );
	EXPECT_TRUE( cube->isHealthy() );
	stage.world->removeCollisionObject( &collider );
	stage.world->removeMultiBody( &body );
}

TEST( OtherWorlds, MultiBodyRestsOnAnExplicitCube )
{
	restMultiBody( Elasticity::Explicit );
}

TEST( OtherWorlds, MultiBodyRestsOnAnImplicitCube )
{
	restMultiBody( Elasticity::Implicit );
}

/// Six links of 2 kg, hinged to each other and longer than the cube, fall on it and drape over it.
void drapeChain( Elasticity elasticity )
{
	constexpr int kHinges = 5;
	Stage<btMultiBodyDynamicsWorld> stage;
	SoftBody* const cube = stage.addCube( at( 0, btScalar( 0.5 ), 0 ), materialOf( elasticity ) );
	btBoxShape shape( btVector3( btScalar( 0.18 ), btScalar( 0.06 ), btScalar( 0.1 ) ) );
	btVector3 inertia;
	shape.calculateLocalInertia( 2, inertia );
	btMultiBody chain( kHinges, 2, inertia, false, false );
	chain.setBasePos( btVector3( -1, btScalar( 1.5 ), 0 ) );
	const btVector3 half( btScalar( 0.2 ), 0, 0 );
	for ( int link = 0; link < kHinges; ++link )
	{
		chain.setupRevolute( link, 2, inertia, link - 1, btQuaternion::getIdentity(), btVector3( 0, 0, 1 ), half, half, true );
	}
	chain.finalizeMultiDof();
	stage.world->addMultiBody( &chain );
	std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders;
	for ( int link = -1; link < kHinges; ++link )
	{
		colliders.push_back( std::make_unique<btMultiBodyLinkCollider>( &chain, link ) );
		btMultiBodyLinkCollider* const collider = colliders.back().get();
		collider->setCollisionShape( &shape );
		collider->setFriction( 1 ); // or it slides off
		collider->setWorldTransform( at( btScalar( -1 ) + btScalar( 0.4 ) * btScalar( link + 1 ), btScalar( 1.5 ), 0 ) );
		stage.world->addCollisionObject( collider, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter );
		link < 0 ? chain.setBaseCollider( collider ) : void( chain.getLink( link ).m_collider = collider );
	}
	stage.run( 420 );
	EXPECT_NEAR( colliders[2]->getWorldTransform().getOrigin().y(), 1.06, 0.06 ); // one of the two is tilted
	EXPECT_NEAR( colliders[3]->getWorldTransform().getOrigin().y(), 1.06, 0.06 );
	for ( const auto& collider : colliders )
	{
		EXPECT_GT( collider->getWorldTransform().getOrigin().y(), 0.3 );
		stage.world->removeCollisionObject( collider.get() );
	}
	EXPECT_TRUE( cube->isHealthy() );
	stage.world->removeMultiBody( &chain );
}

TEST( OtherWorlds, ChainDrapesOverAnExplicitCube )
{
	drapeChain( Elasticity::Explicit );
}

TEST( OtherWorlds, ChainDrapesOverAnImplicitCube )
{
	drapeChain( Elasticity::Implicit );
}

// A pendulum of a multibody swings with a soft cube at its end.
TEST( OtherWorlds, ALinkCarriesACube )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		Stage<btMultiBodyDynamicsWorld> stage;
		btBoxShape shape( btVector3( btScalar( 0.5 ), btScalar( 0.05 ), btScalar( 0.05 ) ) );
		btVector3 inertia;
		shape.calculateLocalInertia( 500, inertia );
		btMultiBody arm( 1, 0, btVector3( 0, 0, 0 ), true, false );
		arm.setBasePos( btVector3( 0, 6, 0 ) );
		const btVector3 half( btScalar( 0.5 ), 0, 0 );
		arm.setupRevolute( 0, 500, inertia, -1, btQuaternion::getIdentity(), btVector3( 0, 0, 1 ), btVector3( 0, 0, 0 ), half, true );
		arm.finalizeMultiDof();
		stage.world->addMultiBody( &arm );
		btMultiBodyLinkCollider link( &arm, 0 );
		link.setCollisionShape( &shape );
		link.setWorldTransform( at( btScalar( 0.5 ), 6, 0 ) );
		arm.getLink( 0 ).m_collider = &link;
		stage.world->addCollisionObject( &link, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter );
		SoftBody* const cube = stage.addCube( at( btScalar( 1.5 ), btScalar( 5.4 ), 0 ), materialOf( elasticity ) );
		const btVector3 corner( btScalar( 1.1 ), btScalar( 5.8 ), 0 );
		const Result<int> made = stage.world->attach( *cube, corner, link );
		ASSERT_TRUE( made.ok() ) << made.status.sentence;
		EXPECT_EQ( stage.world->attach( *cube, 0, *cube ).status.code, ResultCode::BadArgument );
		stage.run( 2 );
		const btScalar before = ( cube->massCentre() - link.getWorldTransform().getOrigin() ).length();
		btScalar lowest = 9, farthest = 0;
		for ( int frame = 0; frame < 90; ++frame )
		{
			stage.run( 1 );
			lowest = std::min( lowest, cube->massCentre().y() );
			farthest = std::max( farthest, cube->massCentre().length() );
		}
		EXPECT_LT( before, 2 );
		EXPECT_LT( lowest, 4.6 ) << "it swings down";
		EXPECT_GT( lowest, 3.5 ) << "it stays on the arm";
		EXPECT_TRUE( cube->isHealthy() );
		stage.world->removeCollisionObject( &link );
		EXPECT_EQ( stage.world->attachmentCount(), 0 );
		stage.world->removeMultiBody( &arm );
	}
}

} // namespace
} // namespace pliant
