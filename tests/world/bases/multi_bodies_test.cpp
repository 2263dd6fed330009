// Soft bodies and multibodies in one world.

#include "world/bases/stage_over.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

namespace pliant {
namespace {

using test::at;
using test::materialOf;

using Stage = test::StageOver<btMultiBodyDynamicsWorld>;

/// A multibody of one box and no joint.
struct FreeBox
{
	FreeBox( Stage& inStage, btScalar mass, const btVector3& half, const btVector3& position ) :
		stage( inStage ), shape( half ), body( 0, mass, inertiaOf( shape, mass ), false, false ), collider( &body, -1 )
	{
		body.setBasePos( position );
		body.finalizeMultiDof();
		collider.setCollisionShape( &shape );
		collider.setWorldTransform( at( position.x(), position.y(), position.z() ) );
		body.setBaseCollider( &collider );
		stage.world->addMultiBody( &body );
		stage.world->addCollisionObject( &collider, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter );
	}
	~FreeBox()
	{
		stage.world->removeCollisionObject( &collider );
		stage.world->removeMultiBody( &body );
	}
	static btVector3 inertiaOf( const btBoxShape& shape, btScalar mass )
	{
		btVector3 inertia;
		shape.calculateLocalInertia( mass, inertia );
		return inertia;
	}

	Stage& stage;
	btBoxShape shape;
	btMultiBody body;
	btMultiBodyLinkCollider collider;
};

btVector3 cubeOf( btScalar half )
{
	return btVector3( half, half, half );
}

// The whole world took the substeps of an awake explicit body, and a multibody fell a little less fast.
TEST( MultiBodies, KeepTheirBitsBesideAnExplicitCube )
{
	std::vector<btVector3> track[2];
	for ( int with = 0; with < 2; ++with )
	{
		Stage stage;
		if ( with == 1 )
		{
			stage.addCube( at( 20, 2, 0 ), materialOf( Elasticity::Explicit ) );
		}
		FreeBox box( stage, 1, cubeOf( btScalar( 0.1 ) ), btVector3( 0, 2, 0 ) );
		box.body.setBaseOmega( btVector3( 1, 2, 3 ) );
		for ( int frame = 0; frame < 90; ++frame )
		{
			stage.run( 1 );
			track[with].push_back( box.body.getBasePos() );
		}
	}
	EXPECT_EQ( track[0], track[1] );
	EXPECT_LT( track[0].back().y(), btScalar( 0.3 ) ); // it has landed
}

/// The highest position of the mass centre after an implicit cube of a metre of the default material fell by .6 m onto the floor, or onto a
/// box on it.
template <class Base, class MakeBox>
btScalar reboundOf( const MakeBox& makeBox )
{
	test::StageOver<Base> stage;
	[[maybe_unused]] const auto box = makeBox( stage ); // stays in the world meanwhile
	Material rubber;
	rubber.elasticity = Elasticity::Implicit;
	SoftBody* const cube = stage.addCube( at( 0, btScalar( 1.5 ), 0 ), rubber );
	stage.run( 30 );
	btScalar highest = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		stage.run( 1 );
		highest = std::max( highest, cube->massCentre().y() );
	}
	return highest;
}

// In a world with multibodies no impact of an implicit body was resolved: it did not rebound at all.
TEST( MultiBodies, TheirWorldLetsAnImplicitCubeRebound )
{
	const btScalar plain = reboundOf<btDiscreteDynamicsWorld>( []( auto& ) { return 0; } );
	const btScalar withNone = reboundOf<btMultiBodyDynamicsWorld>( []( auto& ) { return 0; } );
	const btScalar beside = reboundOf<btMultiBodyDynamicsWorld>( []( auto& stage ) {
		return std::make_unique<FreeBox>( stage, btScalar( 1 ), cubeOf( btScalar( 0.2 ) ), btVector3( 5, btScalar( 0.2 ), 0 ) );
	} );
	std::printf( "mass centre rebounds to %.3f m, in a world for multibodies to %.3f and %.3f m\n", double( plain ), double( withNone ),
		double( beside ) );
	EXPECT_GT( plain, btScalar( 0.7 ) );
	EXPECT_EQ( withNone, plain );
	EXPECT_NEAR( beside, plain, 0.01 );
}

TEST( MultiBodies, AnImplicitCubeReboundsFromALinkAsFromARigidBox )
{
	const btVector3 half( 1, btScalar( 0.1 ), 1 );
	const btScalar rigid = reboundOf<btDiscreteDynamicsWorld>( [&]( auto& stage ) {
		stage.addBox( 8000, half, at( 0, btScalar( 0.1 ), 0 ) );
		return 0;
	} );
	const btScalar link = reboundOf<btMultiBodyDynamicsWorld>(
		[&]( auto& stage ) { return std::make_unique<FreeBox>( stage, btScalar( 8000 ), half, btVector3( 0, btScalar( 0.1 ), 0 ) ); } );
	std::printf( "mass centre rebounds to %.3f m from a rigid box, to %.3f m from a link\n", double( rigid ), double( link ) );
	EXPECT_GT( rigid, btScalar( 0.85 ) );
	EXPECT_NEAR( link, rigid, 0.03 );
}

// The substeps of a cube do not see multibodies that it does not touch. One that a callback removes then must not come back.
TEST( MultiBodies, RemovedWithinSubstepsStayAway )
{
	static Stage::World* world = nullptr;
	static btMultiBody* removed = nullptr;
	Stage stage;
	FreeBox box( stage, 1, cubeOf( btScalar( 0.2 ) ), btVector3( 20, 2, 0 ) );
	world = stage.world.get();
	removed = &box.body;
	stage.addCube( at( 0, btScalar( 0.6 ), 0 ), materialOf( Elasticity::Explicit ) );
	stage.parts.dispatcher.setNearCallback( []( btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info ) {
		if ( world->getNumMultibodies() == 0 && removed )
		{
			world->removeMultiBody( removed );
			removed = nullptr;
		}
		btCollisionDispatcher::defaultNearCallback( pair, dispatcher, info );
	} );
	stage.run( 1 );
	EXPECT_EQ( removed, nullptr ) << "a pass saw no multibody";
	EXPECT_EQ( stage.world->getNumMultibodies(), 0 );
	stage.run( 10 );
}

/// A multibody with a free base of 20 kg on a soft cube.
void restMultiBody( Elasticity elasticity )
{
	Stage stage;
	SoftBody* const cube = stage.addCube( at( 0, btScalar( 0.5 ), 0 ), materialOf( elasticity ) );
	FreeBox box( stage, 20, btVector3( btScalar( 0.3 ), btScalar( 0.1 ), btScalar( 0.3 ) ), btVector3( 0, btScalar( 1.2 ), 0 ) );
	stage.run( 300 );
	EXPECT_NEAR( box.body.getBasePos().y(), 1.1, 0.03 ) << "elasticity " << int( elasticity );
	EXPECT_LT( box.body.getBaseVel().length(), 0.05 );
	EXPECT_TRUE( cube->isHealthy() );
}

TEST( MultiBodies, MultiBodyRestsOnAnExplicitCube )
{
	restMultiBody( Elasticity::Explicit );
}

TEST( MultiBodies, MultiBodyRestsOnAnImplicitCube )
{
	restMultiBody( Elasticity::Implicit );
}

/// Six links of 2 kg, hinged to each other and longer than the cube, fall on it and drape over it.
void drapeChain( Elasticity elasticity )
{
	constexpr int kHinges = 5;
	Stage stage;
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

TEST( MultiBodies, ChainDrapesOverAnExplicitCube )
{
	drapeChain( Elasticity::Explicit );
}

TEST( MultiBodies, ChainDrapesOverAnImplicitCube )
{
	drapeChain( Elasticity::Implicit );
}

// A pendulum of a multibody swings with a soft cube at its end.
TEST( MultiBodies, ALinkCarriesACube )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		Stage stage;
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
