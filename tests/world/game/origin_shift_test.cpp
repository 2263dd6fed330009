// The origin of a world is shifted, compared with an equal world without a shift.

#include "world/test_world.h"

#include <pliant/soft_body_world_over.h>

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>

#include <limits>

namespace pliant::test {

namespace {

/// Everything that has coordinates: soft cubes awake and asleep, joints with frames in the world, pins, an attachment, a ghost, a kinematic
/// box with a motion state.
struct Zoo : TestWorld
{
	std::vector<std::unique_ptr<btTypedConstraint>> joints;
	btDefaultMotionState motion{ at( 4, 1, 4 ) };
	SoftBody* asleep = nullptr;

	explicit Zoo( Elasticity elasticity )
	{
		addFloor();
		Material material = stiff( 3e5f );
		material.elasticity = elasticity;
		asleep = addSoft( block( 3, 3, 3, 0.1f ), at( -3, 0.15f, 0 ), material );
		btRigidBody* sleeper = addBox( 5, btVector3( 0.2f, 0.2f, 0.2f ), at( -3, 0.5f, 0 ) );
		sleeper->setFriction( 1 );
		run( 400 );
		EXPECT_FALSE( asleep->isActive() );
		addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.4f, 0 ), material )->setContactEvents( true );
		SoftBody* hung = addSoft( block( 4, 2, 2, 0.1f ), at( 3, 2, 0 ), material );
		static_cast<void>( hung->pinNode( 0 ) );
		SoftBody* attached = addSoft( block( 3, 3, 3, 0.1f ), at( 3, 1, -3 ), material );
		btRigidBody* anchor = addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 3, 1.3f, -3 ) );
		EXPECT_TRUE( world.attach( *attached, 26, *anchor ).ok() );
		addJoints();
	}
	~Zoo()
	{
		for ( const auto& joint : joints )
		{
			world.removeConstraint( joint.get() );
		}
	}
	void addJoints()
	{
		for ( int kind = 0; kind < 6; ++kind )
		{
			btRigidBody* body = addBox( 2, btVector3( 0.2f, 0.1f, 0.1f ), at( btScalar( kind ), 4, 5 ) );
			const btTransform frame = at( -0.2f, 0, 0 );
			btTypedConstraint* joint = nullptr;
			switch ( kind )
			{
				case 0: joint = new btPoint2PointConstraint( *body, frame.getOrigin() ); break;
				case 1: joint = new btHingeConstraint( *body, frame.getOrigin(), btVector3( 0, 0, 1 ) ); break;
				case 2: joint = new btSliderConstraint( *body, frame, true ); break;
				case 3: joint = new btGeneric6DofConstraint( *body, frame, true ); break;
				case 4: joint = new btGeneric6DofSpring2Constraint( *body, frame ); break;
				default: joint = new btConeTwistConstraint( *body, btTypedConstraint::getFixedBody(), frame, at( 5, 4, 5 ) ); break;
			}
			joints.emplace_back( joint );
			world.addConstraint( joint );
		}
		btBoxShape* shape = new btBoxShape( btVector3( 0.2f, 0.2f, 0.2f ) );
		shapes.emplace_back( shape );
		rigid.push_back( std::make_unique<btRigidBody>( 0, &motion, shape ) );
		rigid.back()->setCollisionFlags( btCollisionObject::CF_KINEMATIC_OBJECT );
		world.addRigidBody( rigid.back().get() );
	}
	std::vector<btVector3> positions() const
	{
		std::vector<btVector3> all;
		for ( const auto& body : soft )
		{
			for ( int node = 0; node < body->nodeCount(); ++node )
			{
				all.push_back( body->nodePosition( node ) );
			}
		}
		for ( const auto& body : rigid )
		{
			all.push_back( body->getWorldTransform().getOrigin() );
		}
		return all;
	}
	std::vector<int> states() const
	{
		std::vector<int> all;
		const btCollisionObjectArray& objects = world.getCollisionObjectArray();
		for ( int k = 0; k < objects.size(); ++k )
		{
			all.push_back( objects[k]->getActivationState() );
		}
		return all;
	}
};

class OriginShift : public ::testing::TestWithParam<Elasticity>
{};

} // namespace

INSTANTIATE_TEST_SUITE_P( Steps, OriginShift, ::testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& given ) { return given.param == Elasticity::Explicit ? "Explicit" : "Implicit"; } );

TEST_P( OriginShift, EverythingGoesOnAsInAWorldThatStays )
{
	Zoo shifted( GetParam() ), stays( GetParam() );
	shifted.run( 20 );
	stays.run( 20 );
	const btVector3 by( -64, 32, 16 );
	const std::vector<int> before = shifted.states();
	const int manifolds = shifted.parts.dispatcher.getNumManifolds();
	ASSERT_TRUE( shifted.world.shiftOrigin( by ).ok() );
	EXPECT_EQ( shifted.states(), before ) << "nothing wakes";
	EXPECT_EQ( shifted.parts.dispatcher.getNumManifolds(), manifolds );
	for ( int frame = 0; frame < 60; ++frame )
	{
		const std::vector<btVector3> a = shifted.positions(), b = stays.positions();
		ASSERT_EQ( a.size(), b.size() );
		btScalar worst = 0;
		for ( std::size_t k = 0; k < a.size(); ++k )
		{
			worst = btMax( worst, ( a[k] - by - b[k] ).length() );
		}
		// Rounding errors of rigid bodies' coordinates, which the impacts magnify.
		ASSERT_LT( worst, frame == 0 ? btScalar( 1e-5 ) : btScalar( 0.02 ) ) << frame;
		ASSERT_FALSE( shifted.asleep->isActive() ) << frame;
		ASSERT_EQ( shifted.states(), stays.states() ) << frame;
		shifted.run( 1 );
		stays.run( 1 );
	}
	EXPECT_NEAR( shifted.motion.m_graphicsWorldTrans.getOrigin().x(), 4 - 64, 1e-5 );
}

TEST_P( OriginShift, ByNothingChangesNoBit )
{
	Zoo shifted( GetParam() ), stays( GetParam() );
	for ( int frame = 0; frame < 60; ++frame )
	{
		if ( frame % 7 == 0 )
		{
			ASSERT_TRUE( shifted.world.shiftOrigin( btVector3( 0, 0, 0 ) ).ok() );
		}
		shifted.run( 1 );
		stays.run( 1 );
		ASSERT_TRUE( shifted.positions() == stays.positions() ) << frame;
	}
}

TEST( OriginShiftOf, ManifoldsDrawnSurfacesTargetsAndRays )
{
	TestWorld t;
	btRigidBody* floor = t.addFloor();
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.15f, 0 ) );
	t.run( 300 );
	ASSERT_FALSE( cube->isActive() );
	const btVector3 by( 1000, -50, btScalar( 7.3 ) ), surface = cube->surface().origin;
	ASSERT_TRUE( t.world.shiftOrigin( by ).ok() );
	EXPECT_LT( ( cube->surface().origin - surface - by ).length(), 1e-3 );
	for ( int m = 0; m < t.parts.dispatcher.getNumManifolds(); ++m )
	{
		const btManifoldPoint& point = t.parts.dispatcher.getManifoldByIndexInternal( m )->getContactPoint( 0 );
		EXPECT_NEAR( point.getPositionWorldOnB().y(), -50, 0.02 );
		EXPECT_NEAR( point.getPositionWorldOnA().x(), 1000, 0.2 );
	}
	btCollisionWorld::ClosestRayResultCallback ray( by + btVector3( 0, 2, 0 ), by + btVector3( 0, -2, 0 ) );
	t.world.rayTest( ray.m_rayFromWorld, ray.m_rayToWorld, ray );
	EXPECT_EQ( SoftBody::upcast( ray.m_collisionObject ), cube );
	EXPECT_NEAR( ray.m_hitPointWorld.y(), -50 + 0.3, 0.02 );
	t.run( 60 );
	EXPECT_FALSE( cube->isActive() );
	EXPECT_FALSE( floor->getWorldTransform().getOrigin().fuzzyZero() );
	ASSERT_TRUE( cube->driveNode( 0, cube->nodePosition( 0 ) + btVector3( 0, 0.02f, 0 ) ).ok() );
	const btVector3 target = cube->nodePosition( 0 ) + btVector3( 0, 0.02f, 0 ) - by;
	ASSERT_TRUE( t.world.shiftOrigin( -by ).ok() );
	t.run( 1 );
	EXPECT_LT( ( cube->nodePosition( 0 ) - target ).length(), 2e-4 );
}

TEST( OriginShiftOf, MultiBodiesAndTheirJoints )
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher( &configuration );
	btDbvtBroadphase broadphase;
	btMultiBodyConstraintSolver solver;
	SoftBodyWorldOver<btMultiBodyDynamicsWorld> world( &dispatcher, &broadphase, &solver, &configuration );
	btMultiBody arm( 1, 1, btVector3( 0.1f, 0.1f, 0.1f ), false, false );
	arm.setupRevolute( 0, 1, btVector3( 0.1f, 0.1f, 0.1f ), -1, btQuaternion::getIdentity(), btVector3( 0, 0, 1 ), btVector3( 0.5f, 0, 0 ),
		btVector3( 0.5f, 0, 0 ), true );
	arm.finalizeMultiDof();
	arm.setBasePos( btVector3( 0, 5, 0 ) );
	arm.setWorldToBaseRot( btQuaternion::getIdentity() );
	world.addMultiBody( &arm );
	btBoxShape shape( btVector3( 0.2f, 0.1f, 0.1f ) );
	btMultiBodyLinkCollider collider( &arm, 0 );
	collider.setCollisionShape( &shape );
	arm.getLink( 0 ).m_collider = &collider;
	world.addCollisionObject( &collider );
	btMultiBodyPoint2Point ball( &arm, 0, nullptr, btVector3( 0, 0, 0 ), btVector3( 1, 5, 0 ) );
	world.addMultiBodyConstraint( &ball );
	for ( int frame = 0; frame < 30; ++frame )
	{
		world.stepSimulation( kFrame, 0 );
	}
	const btVector3 by( 100, -20, 3 ), base = arm.getBasePos(), link = collider.getWorldTransform().getOrigin();
	ASSERT_TRUE( world.shiftOrigin( by ).ok() );
	EXPECT_LT( ( arm.getBasePos() - base - by ).length(), 1e-4 );
	EXPECT_LT( ( collider.getWorldTransform().getOrigin() - link - by ).length(), 1e-4 );
	EXPECT_LT( ( ball.getPivotInB() - btVector3( 101, -15, 3 ) ).length(), 1e-4 );
	for ( int frame = 0; frame < 5; ++frame )
	{
		world.stepSimulation( kFrame, 0 );
	}
	EXPECT_LT( ( collider.getWorldTransform().getOrigin() - link - by ).length(), 0.02 ) << "still held";
	world.removeMultiBodyConstraint( &ball );
	world.removeCollisionObject( &collider );
	world.removeMultiBody( &arm );
}

TEST( OriginShiftOf, BadNumbersIsRefused )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 1, 2, 3 ) );
	const btVector3 before = cube->nodePosition( 0 );
	EXPECT_EQ( t.world.shiftOrigin( btVector3( std::numeric_limits<btScalar>::quiet_NaN(), 0, 0 ) ).code, ResultCode::BadArgument );
	EXPECT_EQ( t.world.shiftOrigin( btVector3( 0, 0, SIMD_INFINITY ) ).code, ResultCode::BadArgument );
	EXPECT_EQ( t.world.shiftOrigin( btVector3( 0, btScalar( 2e9 ), 0 ) ).code, ResultCode::BadArgument );
	EXPECT_EQ( cube->nodePosition( 0 ), before );
	EXPECT_TRUE( t.world.shiftOrigin( btVector3( 0, 0, 0 ) ).ok() );
	EXPECT_EQ( cube->nodePosition( 0 ), before );
}

} // namespace pliant::test
