// A robot's arm, a btMultiBody, grips a soft ball between two fingers and lifts it.

#include "lattice/test_meshes.h"
#include "world/test_world.h"

#include <pliant/soft_body_world_over.h>

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <memory>
#include <vector>

namespace pliant {
namespace {

constexpr btScalar kGap = btScalar( 0.2 ); // m, from the middle to an open finger

/// A carriage that slides up and down, and two fingers on it that slide along x.
class Gripper
{
public:
	explicit Gripper( btMultiBodyDynamicsWorld& world ) : m_world( world ), arm( 3, 0, btVector3( 0, 0, 0 ), true, false )
	{
		const btVector3 inertia( btScalar( 0.01 ), btScalar( 0.01 ), btScalar( 0.01 ) ), none( 0, 0, 0 );
		const btQuaternion unturned = btQuaternion::getIdentity();
		arm.setBasePos( btVector3( 0, 1, 0 ) );
		arm.setupPrismatic( 0, 2, inertia, -1, unturned, btVector3( 0, 1, 0 ), none, none, true );
		for ( int side = 0; side < 2; ++side )
		{
			const btScalar sign = side == 0 ? btScalar( -1 ) : btScalar( 1 );
			arm.setupPrismatic(
				1 + side, 1, inertia, 0, unturned, btVector3( -sign, 0, 0 ), btVector3( sign * kGap, btScalar( -0.85 ), 0 ), none, true );
		}
		arm.finalizeMultiDof();
		arm.setCanSleep( false );
		m_world.addMultiBody( &arm );
		for ( int link = 0; link < 3; ++link ) // a motor works at links with a collider
		{
			const btScalar x[3] = { 0, -kGap, kGap };
			parts.push_back( std::make_unique<btMultiBodyLinkCollider>( &arm, link ) );
			parts.back()->setCollisionShape( &m_plate );
			parts.back()->setFriction( 1 );
			parts.back()->setWorldTransform( test::at( x[link], link == 0 ? btScalar( 1 ) : btScalar( 0.15 ), 0 ) );
			arm.getLink( link ).m_collider = parts.back().get();
			m_world.addCollisionObject( parts.back().get(), btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter );
		}
		for ( int link = 0; link < 3; ++link )
		{
			motors.push_back( std::make_unique<btMultiBodyJointMotor>( &arm, link, 0, link == 0 ? btScalar( 100 ) : btScalar( 0.5 ) ) );
			m_world.addMultiBodyConstraint( motors.back().get() );
		}
	}
	~Gripper()
	{
		for ( const auto& motor : motors )
		{
			m_world.removeMultiBodyConstraint( motor.get() );
		}
		for ( const auto& part : parts )
		{
			m_world.removeCollisionObject( part.get() );
		}
		m_world.removeMultiBody( &arm );
	}
	/// m/s; a finger pushes with 0.5 N s a step at most, 30 N.
	void move( btScalar up, btScalar close )
	{
		motors[0]->setVelocityTarget( up );
		motors[1]->setVelocityTarget( close );
		motors[2]->setVelocityTarget( close );
	}

private:
	btMultiBodyDynamicsWorld& m_world;
	btBoxShape m_plate{ btVector3( btScalar( 0.02 ), btScalar( 0.1 ), btScalar( 0.1 ) ) };

public:
	btMultiBody arm;
	std::vector<std::unique_ptr<btMultiBodyLinkCollider>> parts;
	std::vector<std::unique_ptr<btMultiBodyJointMotor>> motors;
};

class Gripping : public ::testing::TestWithParam<Elasticity>
{};

// The ball slipped from implicit fingers: the links of the fingers seemed to yield, because the resistance that their joints add was
// estimated without the effect of the other links on the response to one link's impulse.
TEST_P( Gripping, AnArmLiftsASoftBall )
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher( &configuration );
	btDbvtBroadphase broadphase;
	btMultiBodyConstraintSolver solver;
	SoftBodyWorldOver<btMultiBodyDynamicsWorld> world( &dispatcher, &broadphase, &solver, &configuration );
	btStaticPlaneShape plane( btVector3( 0, 1, 0 ), 0 );
	btRigidBody ground( btRigidBody::btRigidBodyConstructionInfo( 0, nullptr, &plane ) );
	world.addRigidBody( &ground );
	Gripper gripper( world );

	Material material = test::stiff( 3e4f );
	material.elasticity = GetParam();
	material.density = 50.0f;
	material.damping = 5.0f;
	LatticeSettings settings;
	settings.cellSize = 0.05f;
	const auto shape = BodyTemplate::build( test::makeSphere( 0.15, 12, 24 ).view(), settings );
	ASSERT_TRUE( shape.ok() ) << shape.status.sentence;
	SoftBodyResult made = SoftBody::create( shape.value, test::at( 0, btScalar( 0.15 ), 0 ), material );
	ASSERT_TRUE( made.ok() ) << made.status.sentence;
	SoftBody& ball = *made.value;
	ball.setFriction( 1 );
	world.addSoftBody( &ball );

	const auto run = [&world]( int frames ) {
		for ( int k = 0; k < frames; ++k )
		{
			world.stepSimulation( test::kFrame, 0 );
		}
	};
	run( 30 );
	const btScalar low = ball.massCentre().y();
	gripper.move( 0, btScalar( 0.2 ) );
	run( 60 );
	gripper.move( btScalar( 0.4 ), btScalar( 0.2 ) );
	run( 75 );
	gripper.move( 0, btScalar( 0.2 ) );
	run( 60 );
	const btScalar high = ball.massCentre().y(), lifted = gripper.arm.getJointPos( 0 );
	EXPECT_NEAR( lifted, 0.5, 0.05 );
	EXPECT_NEAR( high - low, lifted, 0.03 );
	run( 120 ); // and holds it
	EXPECT_NEAR( ball.massCentre().y(), high, 0.02 );
	EXPECT_LT( ball.linearVelocity().length(), 0.02 );
	gripper.move( 0, btScalar( -0.2 ) );
	run( 90 );
	EXPECT_LT( ball.massCentre().y(), high - btScalar( 0.1 ) ); // it has been released
	EXPECT_TRUE( ball.isHealthy() );
	world.removeRigidBody( &ground );
}

INSTANTIATE_TEST_SUITE_P( BothSteps, Gripping, ::testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& suite ) { return std::string( suite.param == Elasticity::Explicit ? "Explicit" : "Implicit" ); } );

} // namespace
} // namespace pliant
