// Collisions of two bodies: momentum, fast bodies, all kinds of shapes, callbacks, filters.

#include "world/test_world.h"

#include "support/energy_of_motion.h"
#include "support/momentum.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::Momentum;
using test::stiff;
using test::TestWorld;

Momentum momentumOf( const btRigidBody& rigid, const SoftBody& soft )
{
	Momentum sum = test::momentumOf( rigid );
	sum += test::momentumOf( soft );
	return sum;
}

/// Of the soft bodies only.
Momentum momentumOf( const TestWorld& t )
{
	Momentum sum;
	for ( const auto& body : t.soft )
	{
		sum += test::momentumOf( *body );
	}
	return sum;
}

double motionOf( const TestWorld& t )
{
	double sum = 0.0;
	for ( const auto& body : t.soft )
	{
		sum += test::energyOfMotion( *body );
	}
	return sum;
}

// Friction acts on two nodes at their centres, which are apart. Uncorrected it would lose half of the angular momentum.
TEST( Collision, OfTwoSoftBodiesKeepsSpinForAnyFriction )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const double friction : { 0.0, 0.1, 1.0 } )
		{
			TestWorld t;
			t.world.setGravity( btVector3( 0, 0, 0 ) );
			Material material = stiff( 1e5f );
			material.elasticity = elasticity;
			SoftBody* still = t.addSoft( block( 6, 4, 4, 0.08f ), at( 0, 0, 0 ), material );
			SoftBody* coming = t.addSoft( block( 4, 4, 4, 0.08f ), at( btScalar( 0.05 ), btScalar( 0.6 ), btScalar( 0.03 ) ), material );
			still->setFriction( btScalar( friction ) );
			coming->setFriction( 1 );
			EXPECT_TRUE( coming->setVelocities( btVector3( 0, -5, 0 ), btVector3( 1, 2, 3 ) ).ok() );
			const Momentum before = momentumOf( t );
			const double motion = motionOf( t );
			for ( int frame = 0; frame < 80; ++frame )
			{
				t.run( 1 );
				EXPECT_LT( motionOf( t ), 1.0001 * motion );
			}
			const Momentum after = momentumOf( t );
			EXPECT_GT( still->linearVelocity().length(), btScalar( 0.5 ) ); // they did touch
			const double linear = double( ( after.linear - before.linear ).length() / before.linear.length() );
			const double angular = double( ( after.angular - before.angular ).length() / before.angular.length() );
			std::printf( "%s, friction %.1f: momentum lost %.1e, spin %.1e\n", elasticity == Elasticity::Explicit ? "explicit" : "implicit",
				friction, linear, angular );
			EXPECT_LT( linear, 1e-5 );
			EXPECT_LT( angular, 1e-4 );
		}
	}
}

// An implicit body between two explicit ones makes their mutual contact part of a block, with friction in two directions. When it
// leaves, Bullet's solver with one direction must not reuse the other direction's impulse for the angular momentum correction.
TEST( Collision, KeepsSpinWhereAnImplicitBodyLeavesTwoExplicitOnes )
{
	double lost = 0.0;
	for ( int k = 0; k < 24; ++k )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		for ( int body = 0; body < 3; ++body )
		{
			const btScalar angle = SIMD_2_PI * btScalar( body ) / 3, own = btScalar( 3 * k + body );
			const btVector3 out( std::cos( angle ), btScalar( 0.2 ) * std::sin( own ), std::sin( angle ) );
			Material material = stiff( 1e5f );
			material.elasticity = body == 1 ? Elasticity::Implicit : Elasticity::Explicit;
			SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ),
				btTransform( btQuaternion( btVector3( 1, std::cos( own ), 1 ).normalized(), own ), btScalar( 0.7 ) * out ), material );
			EXPECT_TRUE( cube->setVelocities( ( btScalar( -1.5 ) - btScalar( k % 4 ) ) * out,
								 4 * btVector3( std::sin( 2 * own ), std::cos( 3 * own ), std::sin( 5 * own ) ) )
							 .ok() );
			cube->setFriction( btScalar( 0.8 ) );
		}
		const Momentum before = momentumOf( t );
		t.run( 60 );
		double spins = 0.0; // sum of the spins of each body
		for ( const auto& body : t.soft )
		{
			spins += double( body->angularMomentum().length() );
		}
		lost = std::max( lost, double( ( momentumOf( t ).angular - before.angular ).length() ) / spins );
	}
	std::printf( "spin lost at most: %.1e\n", lost );
	EXPECT_LT( lost, 1e-4 );
}

// Contact proxies live as long as their contacts, so changed settings of a body at rest must reach them.
TEST( Collision, FrictionSetOnARestingBodyActsFromTheNextStep )
{
	TestWorld t;
	t.addPlane();
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.2 ), 0 ), stiff( 1e5f ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	t.run( 60 );
	ASSERT_GT( t.world.stepReport().softContacts, 0 );
	cube->setFriction( 0 );
	EXPECT_TRUE( cube->setVelocities( btVector3( 1, 0, 0 ), btVector3( 0, 0, 0 ) ).ok() );
	t.run( 30 );
	EXPECT_GT( cube->linearVelocity().x(), btScalar( 0.95 ) );
	cube->setFriction( 1 );
	t.run( 30 );
	EXPECT_LT( cube->linearVelocity().x(), btScalar( 0.1 ) );
}

TEST( Collision, KeepsMomentum )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), at( 0, 0, 0 ), stiff( 2e4f ) );
	btRigidBody* box = t.addBox( 20, btVector3( 0.15f, 0.15f, 0.15f ), at( -1, btScalar( 0.12 ), btScalar( 0.03 ) ) );
	box->setLinearVelocity( btVector3( 4, 0, 0 ) );
	box->setDamping( 0, 0 );
	box->setActivationState( DISABLE_DEACTIVATION );
	const Momentum before = momentumOf( *box, *cube );
	t.run( 120 );
	const Momentum after = momentumOf( *box, *cube );
	const btScalar linear = ( after.linear - before.linear ).length() / before.linear.length();
	const btScalar angular = ( after.angular - before.angular ).length() / before.angular.length();
	std::printf( "momentum in a collision: linear %.1e, angular %.1e of what there was\n", double( linear ), double( angular ) );
	EXPECT_LT( box->getLinearVelocity().x(), btScalar( 2 ) ) << "they did not touch";
	EXPECT_LT( linear, btScalar( 1e-5 ) );
	EXPECT_LT( angular, btScalar( 1e-4 ) );
}

TEST( Collision, TwoSoftBodiesKeepMomentum )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	const auto shape = block( 4, 4, 4, 0.1f );
	SoftBody* a = t.addSoft( shape, at( 0, 0, 0 ) );
	SoftBody* b = t.addSoft( shape, at( btScalar( 0.6 ), btScalar( 0.1 ), btScalar( 0.05 ) ) );
	EXPECT_TRUE( b->setLinearVelocity( btVector3( -3, 0, 0 ) ).ok() );
	const btVector3 before = b->linearVelocity() * b->mass();
	t.run( 60 );
	const btVector3 after = b->linearVelocity() * b->mass() + a->linearVelocity() * a->mass();
	EXPECT_LT( a->linearVelocity().x(), btScalar( -0.5 ) );
	EXPECT_LT( ( after - before ).length() / before.length(), btScalar( 1e-5 ) );
}

TEST( Collision, FastBulletTransfersItsMomentum )
{
	// With and without Bullet's continuous detection, slow and fast: the momentum that the bullet loses goes to the body.
	for ( const bool continuous : { false, true } )
	{
		for ( const btScalar speed : { btScalar( 30 ), btScalar( 100 ), btScalar( 300 ) } )
		{
			TestWorld t;
			t.world.setGravity( btVector3( 0, 0, 0 ) );
			SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, 0, 0 ), stiff( 2e4f ) );
			btRigidBody* shot = t.add(
				btScalar( 0.5 ), new btSphereShape( btScalar( 0.06 ) ), at( -3, btScalar( 0.02 ), btScalar( 0.03 ) ) );
			shot->setLinearVelocity( btVector3( speed, 0, 0 ) );
			if ( continuous )
			{
				shot->setCcdMotionThreshold( btScalar( 0.06 ) );
				shot->setCcdSweptSphereRadius( btScalar( 0.05 ) );
			}
			t.run( 30 );
			const btScalar total = cube->linearVelocity().x() * cube->mass() + shot->getLinearVelocity().x() * btScalar( 0.5 );
			EXPECT_GT( cube->linearVelocity().x() * cube->mass(), btScalar( 0.3 ) * speed * btScalar( 0.5 ) )
				<< speed << " m/s, continuous " << continuous;
			EXPECT_NEAR( double( total / ( speed * btScalar( 0.5 ) ) ), 1.0, 1e-3 ) << speed << " m/s, continuous " << continuous;
		}
	}
}

TEST( Collision, AFastSoftBodyDoesNotPassAThinWall )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	t.addBox( 0, btVector3( 0.02f, 3, 3 ), at( 2, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ) );
	EXPECT_TRUE( cube->setLinearVelocity( btVector3( 60, 0, 0 ) ).ok() );
	t.run( 60 );
	for ( int i = 0; i < cube->nodeCount(); ++i )
	{
		ASSERT_LT( cube->nodePosition( i ).x(), 2 );
	}
}

struct Ground
{
	const char* name;
	btScalar top; ///< m
	btCollisionShape* ( *make )( TestWorld&, std::vector<std::unique_ptr<btStridingMeshInterface>>&, std::vector<float>& );
};

class CollisionWith : public testing::TestWithParam<Ground>
{};

TEST_P( CollisionWith, CubeComesToRestOnIt )
{
	std::vector<std::unique_ptr<btStridingMeshInterface>> meshes;
	std::vector<float> heights;
	TestWorld t;
	btCollisionShape* shape = GetParam().make( t, meshes, heights );
	t.add( 0, shape, at( 0, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( btScalar( 0.013 ), GetParam().top + btScalar( 0.3 ), btScalar( 0.021 ) ) );
	t.run( 400 );
	EXPECT_FALSE( cube->isActive() );
	EXPECT_NEAR( test::lowestNode( *cube ), GetParam().top + btScalar( 0.05 ), 0.004 );
	EXPECT_NEAR( cube->massCentre().x(), 0.013, 0.01 );
}

btCollisionShape* makeMesh( TestWorld&, std::vector<std::unique_ptr<btStridingMeshInterface>>& meshes, std::vector<float>& )
{
	auto* mesh = new btTriangleMesh;
	meshes.emplace_back( mesh );
	for ( int k = 0; k < 400; ++k )
	{
		const btScalar x = btScalar( k % 20 - 10 ) / 5, z = btScalar( k / 20 - 10 ) / 5, d = btScalar( 0.2 );
		mesh->addTriangle( btVector3( x, 0, z ), btVector3( x, 0, z + d ), btVector3( x + d, 0, z ) );
		mesh->addTriangle( btVector3( x + d, 0, z ), btVector3( x, 0, z + d ), btVector3( x + d, 0, z + d ) );
	}
	return new btBvhTriangleMeshShape( mesh, true );
}

btCollisionShape* makeTerrain( TestWorld&, std::vector<std::unique_ptr<btStridingMeshInterface>>&, std::vector<float>& heights )
{
	heights.assign( 9 * 9, 0.0f );
	return new btHeightfieldTerrainShape( 9, 9, heights.data(), btScalar( -1 ), btScalar( 1 ), 1, false );
}

btCollisionShape* makeCompound( TestWorld& t, std::vector<std::unique_ptr<btStridingMeshInterface>>&, std::vector<float>& )
{
	auto* compound = new btCompoundShape;
	for ( int k = 0; k < 4; ++k )
	{
		t.shapes.push_back( std::make_unique<btBoxShape>( btVector3( 0.5, 0.5, 0.5 ) ) );
		compound->addChildShape(
			at( btScalar( k % 2 ) - btScalar( 0.5 ), btScalar( -0.5 ), btScalar( k / 2 ) - btScalar( 0.5 ) ), t.shapes.back().get() );
	}
	return compound;
}

btCollisionShape* makeHull( TestWorld&, std::vector<std::unique_ptr<btStridingMeshInterface>>&, std::vector<float>& )
{
	auto* hull = new btConvexHullShape;
	for ( int k = 0; k < 8; ++k )
	{
		hull->addPoint( btVector3( btScalar( k & 1 ? 1 : -1 ), btScalar( k & 2 ? 0 : -1 ), btScalar( k & 4 ? 1 : -1 ) ) );
	}
	hull->setMargin( btScalar( 0.01 ) );
	return hull;
}

btCollisionShape* makeCylinder( TestWorld&, std::vector<std::unique_ptr<btStridingMeshInterface>>&, std::vector<float>& )
{
	return new btCylinderShape( btVector3( 1, btScalar( 0.5 ), 1 ) );
}

INSTANTIATE_TEST_SUITE_P( All, CollisionWith,
	testing::Values( Ground{ "TriangleMesh", 0, makeMesh }, Ground{ "Heightfield", 0, makeTerrain }, Ground{ "Compound", 0, makeCompound },
		Ground{ "Hull", btScalar( 0.01 ), makeHull }, Ground{ "Cylinder", btScalar( 0.5 ), makeCylinder } ),
	[]( const testing::TestParamInfo<Ground>& ground ) { return std::string( ground.param.name ); } );

TEST( Collision, SeamsOfAFlatMeshDoNotStopSlidingBodies )
{
	std::vector<std::unique_ptr<btStridingMeshInterface>> meshes;
	std::vector<float> heights;
	TestWorld t;
	t.add( 0, makeMesh( t, meshes, heights ), at( 0, 0, 0 ) );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( btScalar( -1.5 ), btScalar( 0.2 ), btScalar( 0.021 ) ) );
	cube->setFriction( 0 );
	t.run( 60 );
	EXPECT_TRUE( cube->setLinearVelocity( btVector3( 2, 0, 0 ) ).ok() );
	t.run( 60 );
	EXPECT_NEAR( cube->linearVelocity().x(), 2, 0.005 );
	EXPECT_NEAR( cube->massCentre().x(), 0.5, 0.02 );
}

TEST( Collision, RollingFrictionStaysFinite )
{
	TestWorld t;
	t.addFloor()->setRollingFriction( btScalar( 0.5 ) );
	SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.3 ), 0 ) );
	cube->setRollingFriction( btScalar( 0.5 ) );
	t.run( 60 );
	EXPECT_TRUE( cube->isHealthy() );
	EXPECT_NEAR( test::lowestNode( *cube ), 0.05, 0.01 );
}

TEST( Collision, RestitutionAndContactResponseAreObeyed )
{
	TestWorld t;
	t.addFloor()->setRestitution( 1 );
	SoftBody* ghost = t.addSoft( block( 3, 3, 3, 0.1f ), at( 3, btScalar( 0.3 ), 0 ) );
	ghost->setCollisionFlags( ghost->getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE );
	SoftBody* filtered = t.addSoft( block( 3, 3, 3, 0.1f ), at( -3, btScalar( 0.3 ), 0 ) );
	t.world.removeSoftBody( filtered );
	t.world.addSoftBody( filtered, btBroadphaseProxy::DebrisFilter, btBroadphaseProxy::DebrisFilter );
	t.run( 60 );
	EXPECT_LT( ghost->massCentre().y(), btScalar( -2 ) );
	EXPECT_LT( filtered->massCentre().y(), btScalar( -2 ) );
}

} // namespace
} // namespace pliant
