// Material::rigidStrain: bodies that hardly deform move as rigid ones, and deform again when necessary.

#include "body/rigid_state.h"
#include "support/explicit_material.h"
#include "support/mesh_of_boxes.h"
#include "support/momentum.h"
#include "world/bodies/soft_body_impl.h"
#include "world/test_world.h"

#include <cmath>
#include <utility>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

constexpr float kStrain = 0.01f;

class RigidState : public ::testing::TestWithParam<Elasticity>
{
protected:
	Material material( float youngsModulus, float rigidStrain = kStrain ) const
	{
		Material made = test::stiff( youngsModulus );
		made.elasticity = GetParam();
		made.rigidStrain = rigidStrain;
		return made;
	}
};

/// A slab in empty space that spins about an axis that is not a principal one.
SoftBody* addSpinning( TestWorld& test, const Material& material )
{
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = test.addSoft( block( 6, 4, 2, 0.1f ), at( 1, 2, 3 ), material );
	EXPECT_TRUE( body->setVelocities( btVector3( 1, -2, 0.5f ), btVector3( 0.6f, 0.2f, 1.1f ) ).ok() );
	return body;
}

std::vector<btVector3> positionsOf( const SoftBody& body )
{
	std::vector<btVector3> positions;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		positions.push_back( body.nodePosition( i ) );
	}
	return positions;
}

void expectSameMotion( const SoftBody& body, const test::Momentum& before )
{
	const test::Momentum now = test::momentumOf( body );
	EXPECT_LT( ( now.linear - before.linear ).length(), 1e-6 * before.linear.length() );
	EXPECT_LT( ( now.angular - before.angular ).length(), 1e-6 * before.angular.length() );
}

TEST_P( RigidState, KeepsMomentumAndPoseAtBothSeams )
{
	TestWorld test;
	SoftBody* const body = addSpinning( test, material( 1e7f, 0.0f ) );
	test.run( 60 ); // the vibration that the spin causes has decayed
	Material rigid = material( 1e7f );
	ASSERT_TRUE( body->setMaterial( rigid ).ok() );
	int frames = 0;
	for ( ; !body->isRigid() && frames < 60; ++frames )
	{
		const test::Momentum before = test::momentumOf( *body );
		test.run( 1 );
		expectSameMotion( *body, before );
	}
	ASSERT_TRUE( body->isRigid() );
	test.run( 10 );
	const test::Momentum before = test::momentumOf( *body );
	const std::vector<btVector3> positions = positionsOf( *body );
	// Back: the game sets another material, which takes effect at the start of a step.
	rigid.rigidStrain = 0.0f;
	ASSERT_TRUE( body->setMaterial( rigid ).ok() );
	test.world.stepSimulation( btScalar( 1e-5 ), 0 );
	EXPECT_FALSE( body->isRigid() );
	expectSameMotion( *body, before );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		EXPECT_LT( body->nodePosition( i ).distance( positions[std::size_t( i )] ), 1e-3 * 0.1 );
	}
}

TEST_P( RigidState, TumblesWithoutGainOrLoss )
{
	TestWorld test;
	SoftBody* const body = addSpinning( test, material( 1e8f ) );
	for ( int frames = 0; !body->isRigid() && frames < 60; ++frames )
	{
		test.run( 1 );
	}
	ASSERT_TRUE( body->isRigid() );
	const test::Momentum before = test::momentumOf( *body );
	const auto energyOf = [&] {
		double energy = 0.0;
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			energy += 0.5 * double( body->nodeMass( i ) ) * double( body->nodeVelocity( i ).length2() );
		}
		return energy;
	};
	const double energy = energyOf();
	test.run( 600 );
	EXPECT_TRUE( body->isRigid() );
	const test::Momentum now = test::momentumOf( *body );
	EXPECT_LT( ( now.linear - before.linear ).length(), 1e-5 * before.linear.length() );
	EXPECT_LT( ( now.angular - before.angular ).length(), 1e-4 * before.angular.length() );
	EXPECT_NEAR( energyOf(), energy, 1e-3 * energy );
}

TEST_P( RigidState, RestsWhereADeformableBodyRests )
{
	double height[2];
	for ( const bool isRigid : { false, true } )
	{
		TestWorld test;
		test.addFloor();
		SoftBody* const lower = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.22f, 0 ), material( 1e7f, isRigid ? kStrain : 0.0f ) );
		SoftBody* const upper = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0.02f, 0.65f, 0 ), material( 1e7f, isRigid ? kStrain : 0.0f ) );
		test.run( 300 );
		EXPECT_EQ( lower->isRigid(), isRigid );
		EXPECT_EQ( upper->isRigid(), isRigid );
		EXPECT_FALSE( lower->isActive() );
		EXPECT_EQ( test.world.stepReport().rigidBodies, isRigid ? 2 : 0 );
		height[isRigid] = double( upper->massCentre().y() );
	}
	EXPECT_NEAR( height[1], height[0], 0.15 * 0.1 ); // most of it is the sag of the deformable ones
}

TEST_P( RigidState, DeformsBeforeItIsHit )
{
	TestWorld test;
	test.addFloor();
	SoftBody* const body = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.21f, 0 ), material( 2e6f ) );
	test.run( 200 );
	ASSERT_TRUE( body->isRigid() );
	btRigidBody* const ball = test.add( 10, new btSphereShape( btScalar( 0.15 ) ), at( 0, 1.5f, 0 ) );
	ball->setLinearVelocity( btVector3( 0, -8, 0 ) );
	double lowest = 1.0;
	bool wasRigidWhileApart = true, wasRigidInContact = false;
	for ( int frame = 0; frame < 10; ++frame )
	{
		test.run( 1 );
		const bool touches = ball->getLinearVelocity().y() > btScalar( -8 );
		wasRigidWhileApart = wasRigidWhileApart && ( frame > 3 || body->isRigid() );
		wasRigidInContact = wasRigidInContact || ( touches && body->isRigid() );
		lowest = std::min( lowest, double( body->nodePosition( body->nearestNode( btVector3( 0, 0.4f, 0 ) ) ).y() ) );
	}
	EXPECT_TRUE( wasRigidWhileApart );
	EXPECT_FALSE( wasRigidInContact );
	EXPECT_LT( lowest, 0.345 ); // the ball has dented it
	test.run( 240 );
	EXPECT_TRUE( body->isRigid() );
}

TEST_P( RigidState, DeformsUnderALoadThatIsPutOnSlowly )
{
	TestWorld test;
	test.addFloor();
	SoftBody* const body = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.205f, 0 ), material( 1e6f ) );
	test.run( 200 );
	ASSERT_TRUE( body->isRigid() );
	const double before = double( body->massCentre().y() );
	test.addBox( 800, btVector3( 0.2f, 0.05f, 0.2f ), at( 0, 0.46f, 0 ) ); // strains the cube by 800 kg g / ( E A ) = 5 %
	test.run( 240 );
	EXPECT_LT( double( body->massCentre().y() ), before - 0.5 * 0.05 * 0.2 );
}

TEST_P( RigidState, ObeysTheGame )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ), material( 1e7f ) );
	test.run( 10 );
	ASSERT_TRUE( body->isRigid() );
	const btScalar mass = body->mass();
	ASSERT_TRUE( body->applyCentralImpulse( mass * btVector3( 1, 0, 0 ) ).ok() );
	test.run( 1 );
	EXPECT_NEAR( body->linearVelocity().x(), 1, 1e-5 );
	ASSERT_TRUE( body->setVelocities( btVector3( 0, 2, 0 ), btVector3( 0, 0, 3 ) ).ok() );
	test.run( 1 );
	EXPECT_NEAR( body->linearVelocity().y(), 2, 1e-5 );
	EXPECT_NEAR( body->angularVelocity().z(), 3, 1e-4 );
	ASSERT_TRUE( body->isRigid() );
	ASSERT_TRUE( body->teleport( btTransform( btQuaternion( btVector3( 0, 0, 1 ), SIMD_HALF_PI ), btVector3( 10, 0, 0 ) ) ).ok() );
	EXPECT_NEAR( body->massCentre().x(), 10, 0.2 );
	test.run( 1 );
	EXPECT_NEAR( body->linearVelocity().x(), -2, 1e-4 ); // velocities rotate with the body
	ASSERT_TRUE( body->reset( at( 0, 5, 0 ) ).ok() );
	EXPECT_NEAR( body->massCentre().y(), 5, 1e-4 );
	EXPECT_NEAR( body->linearVelocity().length(), 0, 1e-6 );
	test.run( 20 );
	ASSERT_TRUE( body->isRigid() );
	ASSERT_TRUE( body->pinNode( 0 ).ok() );
	const btVector3 pinned = body->nodePosition( 0 );
	ASSERT_TRUE( body->applyCentralForce( mass * btVector3( 3, 0, 0 ) ).ok() );
	test.run( 30 );
	EXPECT_FALSE( body->isRigid() );
	EXPECT_LT( body->nodePosition( 0 ).distance( pinned ), 1e-4 );
	body->releaseNode( 0 );
	test.run( 60 );
	ASSERT_TRUE( body->isRigid() );
	ASSERT_TRUE( body->setLinearVelocity( btVector3( 0, 0, 0 ) ).ok() );
	ASSERT_TRUE( body->applyImpulse( mass * btVector3( 0, 0.02f, 0 ), 0 ).ok() );
	test.run( 1 );
	EXPECT_FALSE( body->isRigid() );
	EXPECT_NEAR( body->linearVelocity().y(), 0.02, 1e-5 );
	test.run( 60 );
	ASSERT_TRUE( body->isRigid() );
	EXPECT_GT( body->cutPlane( body->massCentre(), btVector3( 0, 1, 0 ) ), 0 );
	test.run( 2 );
	EXPECT_EQ( test.world.softBodyCount(), 2 );
}

// Fields and explosions changed the nodes' velocities only, which the rigid motion then overwrote.
TEST_P( RigidState, FeelsFieldsAndBlasts )
{
	btScalar height[2], velocity[2];
	for ( const bool isRigid : { false, true } )
	{
		TestWorld test;
		Water water;
		ASSERT_TRUE( test.world.addForceField( water ).ok() );
		Material light = material( 1e7f, isRigid ? kStrain : 0.0f );
		light.density = 500;
		SoftBody* const body = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.05f, 0 ), light );
		test.run( 60 );
		EXPECT_EQ( body->isRigid(), isRigid );
		test.run( 240 );
		height[isRigid] = body->massCentre().y();
		ASSERT_TRUE( test.world.removeForceField( water ) );
		ASSERT_TRUE( body->reset( at( 0, 5, 0 ) ).ok() );
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		test.run( 30 );
		EXPECT_EQ( body->isRigid(), isRigid );
		Explosion explosion;
		explosion.centre = btVector3( -1, 5, 0 );
		ASSERT_TRUE( test.world.explode( explosion ).ok() );
		test.run( 5 );
		velocity[isRigid] = body->linearVelocity().x();
	}
	EXPECT_NEAR( height[1], height[0], 0.02 ); // the deformable one keeps bobbing
	EXPECT_NEAR( height[0], 0, 0.05 );         // half of it is in the water
	EXPECT_GT( velocity[0], 0.05 );
	EXPECT_NEAR( velocity[1], velocity[0], 0.01 * velocity[0] );
}

TEST_P( RigidState, IsTheSameObjectToTheGame )
{
	TestWorld test;
	test.addFloor();
	auto body = SoftBody::create( block( 4, 4, 4, 0.1f ), at( 0, 0.205f, 0 ), material( 1e7f ) ).value;
	body->setUserIndex( 7 );
	test.world.addSoftBody( body.get() );
	test.run( 100 );
	ASSERT_TRUE( body->isRigid() );
	btCollisionWorld::ClosestRayResultCallback ray( btVector3( 0.01f, 3, 0.02f ), btVector3( 0.01f, -3, 0.02f ) );
	test.world.rayTest( ray.m_rayFromWorld, ray.m_rayToWorld, ray );
	EXPECT_EQ( ray.m_collisionObject, body.get() );
	EXPECT_NEAR( ray.m_hitPointWorld.y(), 0.4, 0.02 );
	bool touches = false;
	btDispatcher& dispatcher = *test.world.getDispatcher();
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		touches = touches || SoftBody::upcast( manifold.getBody0() ) == body.get() || SoftBody::upcast( manifold.getBody1() ) == body.get();
	}
	EXPECT_TRUE( touches );
	const int objects = test.world.getNumCollisionObjects();
	test.world.removeCollisionObject( body.get() );
	EXPECT_EQ( test.world.getNumCollisionObjects(), objects - 1 );
	EXPECT_FALSE( body->isRigid() );
	test.run( 2 );
	test.world.addSoftBody( body.get() );
	test.run( 100 );
	EXPECT_TRUE( body->isRigid() );
	body.reset(); // deleted in the world
	test.run( 2 );
	EXPECT_EQ( test.world.softBodyCount(), 0 );
}

// The contact ended and began again in events when hulls replaced the node spheres.
TEST_P( RigidState, KeepsItsContactsInEvents )
{
	TestWorld test;
	test.addFloor();
	SoftBody* const body = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.201f, 0 ), material( 1e7f ) );
	body->setContactEvents( true );
	int began = 0, ended = 0;
	for ( int frame = 0; frame < 40; ++frame )
	{
		test.run( 1 );
		for ( const ContactEvent& event : test.world.contactEvents() )
		{
			began += event.began ? 1 : 0;
			ended += event.ended ? 1 : 0;
		}
	}
	EXPECT_TRUE( body->isRigid() );
	EXPECT_EQ( began, 1 );
	EXPECT_EQ( ended, 0 );
	EXPECT_EQ( body->nodeOfShapeIndex( 0 ), -1 ); // rays meet hulls
}

TEST_P( RigidState, ShapeFollowsTheMaterial )
{
	// A U of three blocks: a single hull would contain the gap, into which a ball falls.
	TestWorld test;
	test.addFloor();
	test::MeshOfBoxes mesh;
	mesh.add( btVector3( 0, 0.1f, 0 ), btVector3( 0.5f, 0.1f, 0.2f ) );
	mesh.add( btVector3( -0.4f, 0.5f, 0 ), btVector3( 0.1f, 0.3f, 0.2f ) );
	mesh.add( btVector3( 0.4f, 0.5f, 0 ), btVector3( 0.1f, 0.3f, 0.2f ) );
	const std::shared_ptr<const BodyTemplate> shape = mesh.build( 0.1f );
	ASSERT_TRUE( shape );
	SoftBody* const body = test.addSoft( shape, at( 0, 0.01f, 0 ), material( 1e7f ) );
	test.run( 100 );
	ASSERT_TRUE( body->isRigid() );
	btRigidBody* const ball = test.add( 1, new btSphereShape( btScalar( 0.15 ) ), at( 0, 0.6f, 0 ) );
	test.run( 30 );
	EXPECT_NEAR( ball->getWorldTransform().getOrigin().y(), 0.35, 0.03 );
}

// A body kept the share of gravity of the substep in which it became rigid, after steps of other lengths: .6 or 2.5 of it.
TEST_P( RigidState, FallsByAllOfGravity )
{
	TestWorld t;
	SoftBody* const body = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 50, 0 ), material( 1e6f ) );
	ASSERT_TRUE( body->applyImpulse( btVector3( 0, 1, 0 ), 0 ).ok() );
	const btScalar before = body->linearVelocity().y(), longest = btScalar( 1.0 / 60 );
	for ( int step = 0; step < 60; ++step )
	{
		t.world.stepSimulation( step % 2 == 0 ? longest : longest / 4, 0 );
	}
	EXPECT_TRUE( body->isRigid() );
	EXPECT_NEAR( body->linearVelocity().y(), before - 10 * 30 * btScalar( 1.25 ) * longest, 0.1 );
}

INSTANTIATE_TEST_SUITE_P( BothSteps, RigidState, ::testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& suite ) { return std::string( suite.param == Elasticity::Explicit ? "Explicit" : "Implicit" ); } );

TEST( RigidStateBreaks, AsIfItHadNeverBeenRigid )
{
	int links[2];
	for ( const bool isRigid : { false, true } )
	{
		TestWorld test;
		test.addFloor();
		Material material = test::implicit( 2e6f );
		material.rigidStrain = isRigid ? 0.05f : 0.0f;
		SoftBody* const body = test.addSoft( block( 10, 10, 2, 0.1f ), at( 0, 0.505f, 0 ), material );
		Fracture fracture;
		fracture.rule = BreakRule::Plane;
		fracture.breakStrain = 0.01f;
		ASSERT_TRUE( body->setFracture( fracture ).ok() );
		test.run( 90 );
		EXPECT_EQ( body->isRigid(), isRigid );
		btRigidBody* const ball = test.add( 50, new btSphereShape( btScalar( 0.15 ) ), at( 0, 0.5f, 1.2f ) );
		ball->setLinearVelocity( btVector3( 0, 0, -20 ) );
		links[isRigid] = 0;
		for ( int frame = 0; frame < 60; ++frame )
		{
			test.run( 1 );
			links[isRigid] += test.world.stepReport().brokenLinks;
		}
	}
	EXPECT_GT( links[0], 50 );
	EXPECT_NEAR( links[1], links[0], 0.3 * links[0] );
}

TEST( RigidStateBits, AreTheSameForAnyThreadCount )
{
	std::vector<btVector3> results[2];
	for ( const int threads : { 1, 2 } )
	{
		TestWorld test;
		test.addFloor();
		const auto runner = createThreadPool( threads );
		test.world.setTaskRunner( runner.get() );
		Material material = test::stiff( 1e7f );
		material.rigidStrain = kStrain;
		for ( int k = 0; k < 6; ++k )
		{
			test.addSoft( block( 3, 3, 3, 0.1f ), at( 0.05f * btScalar( k % 3 ), 0.3f + 0.35f * btScalar( k ), 0 ), material );
		}
		test.run( 120 );
		for ( const auto& body : test.soft )
		{
			const std::vector<btVector3> positions = positionsOf( *body );
			results[threads - 1].insert( results[threads - 1].end(), positions.begin(), positions.end() );
		}
		test.world.setTaskRunner( nullptr );
	}
	ASSERT_EQ( results[0].size(), results[1].size() );
	for ( std::size_t k = 0; k < results[0].size(); ++k )
	{
		ASSERT_EQ( results[0][k], results[1][k] );
	}
}

TEST( RigidStrain, IsRefusedOutOfRange )
{
	for ( const float bad : { -0.1f, 0.2f, std::nanf( "" ) } )
	{
		Material material = test::explicitMaterial();
		material.rigidStrain = bad;
		EXPECT_EQ( check( material ).code, ResultCode::BadMaterial );
	}
}

} // namespace
} // namespace pliant
