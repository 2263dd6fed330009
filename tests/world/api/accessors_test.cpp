// Settings can be read back; calls with an index out of range return a neutral value; each kind of mistake has its code.

#include "support/explicit_material.h"
#include "world/levels/adaptive_bodies.h"

#include <pliant/build.h>
#include <pliant/vehicle_raycaster.h>

#include <cmath>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::levels;
using test::stiff;
using test::TestWorld;

constexpr int kOutOfRange[] = { -1, -1000000, 1000000 };

TEST( Accessors, AngularVelocityIsThatOfARigidMotion )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* bar = t.addSoft( block( 8, 2, 3, 0.1f ), at( 5, 6, 7 ) );
	EXPECT_EQ( bar->angularVelocity().length(), 0 );
	const btVector3 spin( btScalar( 0.5 ), -2, 1 );
	ASSERT_TRUE( bar->setVelocities( btVector3( 3, 0, 0 ), spin ).ok() );
	EXPECT_LT( ( bar->angularVelocity() - spin ).length(), btScalar( 1e-4 ) );
	ASSERT_TRUE( bar->teleport( btTransform( btQuaternion( btVector3( 0, 0, 1 ), SIMD_HALF_PI ) ) ).ok() );
	EXPECT_LT( ( bar->angularVelocity() - btVector3( 2, btScalar( 0.5 ), 1 ) ).length(), btScalar( 1e-4 ) );
}

TEST( Accessors, NothingTurnsAboutALineOfNodes )
{
	TestWorld t;
	SoftBody* row = t.addSoft( block( 5, 1, 1, 0.1f ), at( 0, 0, 0 ) );
	ASSERT_TRUE( row->setVelocities( btVector3( 0, 0, 0 ), btVector3( 7, 0, 2 ) ).ok() );
	EXPECT_LT( ( row->angularVelocity() - btVector3( 0, 0, 2 ) ).length(), btScalar( 1e-3 ) );
	SoftBody* point = t.addSoft( block( 1, 1, 1, 0.1f ), at( 0, 3, 0 ) );
	ASSERT_TRUE( point->setVelocities( btVector3( 1, 0, 0 ), btVector3( 0, 5, 0 ) ).ok() );
	EXPECT_EQ( point->angularVelocity().length(), 0 );
}

TEST( Accessors, CellsOfNodesAreTheInverseOfNodesOfCells )
{
	TestWorld t;
	SoftBody* plain = t.addSoft( block( 4, 3, 2, 0.1f ), at( 0, 0, 0 ) );
	SoftBody* coarse = t.addSoft( block( 8, 8, 8, 0.1f ), at( 0, 3, 0 ), stiff( 1e5f ), levels( 2 ) );
	ASSERT_LT( coarse->nodeCount(), coarse->cellCount() );
	for ( const SoftBody* body : { plain, coarse } )
	{
		for ( int node = 0; node < body->nodeCount(); ++node )
		{
			const int cell = body->cellOfNode( node );
			ASSERT_EQ( body->nodeOfCell( cell ), node );
			for ( int lower = 0; lower < cell; ++lower )
			{
				ASSERT_NE( body->nodeOfCell( lower ), node );
			}
		}
		for ( const int node : kOutOfRange )
		{
			EXPECT_EQ( body->cellOfNode( node ), -1 );
			EXPECT_EQ( body->nodeOfCell( node ), -1 );
		}
	}
}

TEST( Accessors, CellsOfAPieceAreThoseOfTheTemplate )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* bar = t.addSoft( block( 8, 2, 2, 0.1f ), at( 0, 0, 0 ) );
	ASSERT_GT( bar->cutPlane( btVector3( btScalar( 0.21 ), 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	t.run( 1 );
	ASSERT_EQ( t.world.softBodyCount(), 2 );
	std::vector<bool> isTaken( 32, false );
	for ( int k = 0; k < 2; ++k )
	{
		const SoftBody& piece = *t.world.softBody( k );
		for ( int node = 0; node < piece.nodeCount(); ++node )
		{
			const int cell = piece.cellOfNode( node );
			EXPECT_EQ( piece.nodeOfCell( cell ), node );
			EXPECT_EQ( t.world.softBody( 1 - k )->nodeOfCell( cell ), -1 );
			EXPECT_FALSE( isTaken[std::size_t( cell )] );
			isTaken[std::size_t( cell )] = true;
		}
	}
	EXPECT_EQ( std::count( isTaken.begin(), isTaken.end(), true ), 32 );
}

TEST( Accessors, LevelsOfDetailAreReadBack )
{
	TestWorld t;
	Adaptivity settings = levels( 2 );
	settings.refineStrain = 0.25f;
	settings.nodesPerStep = 77;
	SoftBody* coarse = t.addSoft( block( 8, 8, 8, 0.1f ), at( 0, 3, 0 ), stiff( 1e5f ), settings );
	EXPECT_EQ( coarse->adaptivity().coarseLevels, 2 );
	EXPECT_EQ( coarse->adaptivity().refineStrain, 0.25f );
	EXPECT_EQ( coarse->adaptivity().nodesPerStep, 77 );
	EXPECT_EQ( coarse->finestLevel(), 0 );
	for ( const int level : { 1, 2, 9, -3 } )
	{
		coarse->setFinestLevel( level );
		EXPECT_EQ( coarse->finestLevel(), std::clamp( level, 0, 2 ) );
	}
	SoftBody* plain = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	plain->setFinestLevel( 2 ); // it has no levels: nothing happens
	EXPECT_EQ( plain->finestLevel(), 0 );
	EXPECT_EQ( plain->adaptivity().coarseLevels, 0 );
}

TEST( Accessors, GravityIsItsOwnOrTheWorlds )
{
	TestWorld t;
	const SoftBodyResult free = SoftBody::create( block( 2, 2, 2, 0.1f ), at( 0, 9, 0 ) );
	ASSERT_TRUE( free.ok() );
	EXPECT_EQ( free.value->gravity().length(), 0 ) << "in no world";
	t.world.setGravity( btVector3( 0, 0, -3 ) );
	SoftBody* cube = t.addSoft( block( 2, 2, 2, 0.1f ), at( 0, 0, 0 ) );
	EXPECT_EQ( cube->gravity(), btVector3( 0, 0, -3 ) );
	EXPECT_FALSE( cube->hasOwnGravity() );
	ASSERT_TRUE( cube->setGravity( btVector3( 1, 2, 3 ) ).ok() );
	EXPECT_EQ( cube->setGravity( btVector3( 0, std::nanf( "" ), 0 ) ).code, ResultCode::BadArgument );
	EXPECT_EQ( cube->gravity(), btVector3( 1, 2, 3 ) );
	EXPECT_TRUE( cube->hasOwnGravity() );
	cube->clearGravity();
	EXPECT_EQ( cube->gravity(), btVector3( 0, 0, -3 ) );
}

TEST( Accessors, SettingsOfTheWorldAreReadBack )
{
	TestWorld t;
	EXPECT_EQ( t.world.threadCount(), 1 );
	t.world.setThreadCount( 3 );
	EXPECT_EQ( t.world.threadCount(), 3 );
	t.world.setThreadCount( -5 );
	EXPECT_EQ( t.world.threadCount(), 1 );
	const auto pool = createThreadPool( 2 );
	t.world.setTaskRunner( pool.get() );
	EXPECT_EQ( t.world.threadCount(), 2 );
	t.world.setTaskRunner( nullptr );
	EXPECT_EQ( t.world.threadCount(), 1 );
	EXPECT_EQ( VehicleRaycaster( t.world ).vehicle(), nullptr );
}

TEST( Accessors, SelfCollisionAnswers )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	EXPECT_EQ( cube->setSelfCollision( true ).ok(), hasFeature( Feature::SelfCollision ) );
	EXPECT_EQ( cube->selfCollision(), hasFeature( Feature::SelfCollision ) );
	EXPECT_TRUE( cube->setSelfCollision( false ).ok() );
	EXPECT_FALSE( cube->selfCollision() );
}

TEST( Accessors, TheCodeFollowsTheKindOfMistake )
{
	TestWorld t;
	const auto shape = block( 3, 3, 3, 0.1f );
	SoftBody* cube = t.addSoft( shape, at( 0, 0, 0 ) );
	Material soft = test::explicitMaterial();
	soft.beta = 2.0f;
	EXPECT_EQ( cube->setMaterial( soft ).code, ResultCode::BadMaterial );
	Fracture brittle;
	brittle.rule = BreakRule::Distance;
	brittle.breakStrain = -1.0f;
	EXPECT_EQ( cube->setFracture( brittle ).code, ResultCode::BadSettings );
	EXPECT_EQ( cube->fracture().rule, BreakRule::Never );
	EXPECT_EQ( SoftBody::create( shape, at( 0, 0, 0 ), {}, levels( 9 ) ).status.code, ResultCode::BadSettings );
	Material cluster = test::explicitMaterial();
	cluster.method = Method::SingleCluster;
	EXPECT_EQ( SoftBody::create( shape, at( 0, 0, 0 ), cluster, levels( 1 ) ).status.code, ResultCode::BadSettings );
	brittle.breakStrain = 0.3f;
	ASSERT_TRUE( cube->setFracture( brittle ).ok() );
	EXPECT_EQ( cube->fracture().rule, BreakRule::Distance );
	EXPECT_EQ( cube->setMaterial( cluster ).code, ResultCode::BadMaterial ) << "it is the material that does not go with the body";
	EXPECT_EQ( cube->pinNode( 27 ).code, ResultCode::BadArgument );
}

} // namespace
} // namespace pliant
