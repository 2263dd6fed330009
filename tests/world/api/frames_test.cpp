// Frames: Bullet's own joints, motors and forces on soft bodies.

#include "support/momentum.h"
#include "world/test_world.h"

#include <cmath>
#include <memory>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

Material material( Elasticity elasticity, float density, float youngsModulus = 1e6f )
{
	Material made = test::stiff( youngsModulus );
	made.elasticity = elasticity;
	made.density = density;
	made.damping = 5.0f;
	return made;
}

/// A cube of 0.4 m and 1 kg.
SoftBody* addCube( TestWorld& test, const btVector3& where, Elasticity elasticity )
{
	return test.addSoft( block( 4, 4, 4, 0.1f ), btTransform( btQuaternion::getIdentity(), where ), material( elasticity, 1.0f / 0.064f ) );
}

btRigidBody* frameOf( TestWorld& test, SoftBody& body, const btVector3& where, btScalar radius )
{
	const Result<btRigidBody*> made = test.world.addFrame( body, where, radius );
	EXPECT_TRUE( made.ok() ) << made.status.sentence;
	return made.value;
}

/// A world position in a frame.
btVector3 inFrame( const btRigidBody& frame, const btVector3& where )
{
	return frame.getWorldTransform().invXform( where );
}

/// A hinge about z between a body and another, or the world.
std::unique_ptr<btHingeConstraint> hinge( TestWorld& test, btRigidBody& a, btRigidBody* b, const btVector3& where )
{
	const btVector3 z( 0, 0, 1 ), inA = a.getWorldTransform().invXform( where ), zInA = a.getWorldTransform().getBasis().transpose() * z;
	auto made = b ? std::make_unique<btHingeConstraint>(
						a, *b, inA, b->getWorldTransform().invXform( where ), zInA, b->getWorldTransform().getBasis().transpose() * z )
				  : std::make_unique<btHingeConstraint>( a, inA, zInA );
	test.world.addConstraint( made.get(), true );
	return made;
}

btScalar angleOf( const btRigidBody& body )
{
	const btVector3 x = body.getWorldTransform().getBasis().getColumn( 0 ); // of rigid bodies
	return std::atan2( x.y(), x.x() );
}

class Framed : public testing::TestWithParam<Elasticity>
{};

// A cube of 1 kg on a point-to-point joint, and a box of 1 kg on another below it.
TEST_P( Framed, JointsCarryACubeAndABoxBelow )
{
	TestWorld test;
	const btScalar g = test.world.getGravity().length();
	SoftBody* const cube = addCube( test, btVector3( 0, 4, 0 ), GetParam() );
	btRigidBody* const box = test.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, btScalar( 3.6 ), 0 ) );
	btRigidBody* const top = frameOf( test, *cube, btVector3( 0, btScalar( 4.2 ), 0 ), btScalar( 0.12 ) );
	btRigidBody* const bottom = frameOf( test, *cube, btVector3( 0, btScalar( 3.8 ), 0 ), btScalar( 0.12 ) );
	const btVector3 topPoint = inFrame( *top, btVector3( 0, btScalar( 4.2 ), 0 ) );
	btPoint2PointConstraint hook( *top, topPoint );
	btPoint2PointConstraint load(
		*bottom, *box, inFrame( *bottom, btVector3( 0, btScalar( 3.8 ), 0 ) ), btVector3( 0, btScalar( 0.2 ), 0 ) );
	btJointFeedback hookFeedback, loadFeedback;
	hook.setJointFeedback( &hookFeedback );
	hook.enableFeedback( true );
	load.setJointFeedback( &loadFeedback );
	load.enableFeedback( true );
	test.world.addConstraint( &hook );
	test.world.addConstraint( &load );
	cube->setActivationState( DISABLE_DEACTIVATION );
	test.run( 480 );
	btScalar carried = 0, loaded = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		test.run( 1 );
		carried += std::abs( hookFeedback.m_appliedForceBodyA.y() ) / 60;
		loaded += std::abs( loadFeedback.m_appliedForceBodyA.y() ) / 60;
	}
	EXPECT_NEAR( carried, 2 * g, 0.02 * 2 * g );
	EXPECT_NEAR( loaded, g, 0.02 * g );
	EXPECT_NEAR( cube->massCentre().y(), 4, 0.02 );
	EXPECT_NEAR( box->getWorldTransform().getOrigin().y(), 3.6, 0.03 );
	EXPECT_NEAR( ( top->getWorldTransform() * topPoint ).y(), 4.2, 2e-3 );
	EXPECT_TRUE( test.world.removeFrame( top ) ); // with its joint
	EXPECT_EQ( test.world.getNumConstraints(), 1 );
	test.run( 30 );
	EXPECT_LT( cube->massCentre().y(), 3.5 );
	EXPECT_TRUE( test.world.removeFrame( bottom ) );
	EXPECT_EQ( test.world.getNumConstraints(), 0 );
}

// Two links hang from hinges in the world, and a bar from the lower end of one to that of the other: it lifts the far one as the near one
// turns.
struct Linkage
{
	std::unique_ptr<btHingeConstraint> drive, axle, near, far;
	btRigidBody *left = nullptr, *right = nullptr;

	void addLinks( TestWorld& test )
	{
		left = test.addBox( 1, btVector3( 0.05f, 0.2f, 0.05f ), at( -1, btScalar( 2.6 ), 0 ) );
		right = test.addBox( 1, btVector3( 0.05f, 0.2f, 0.05f ), at( 1, btScalar( 2.6 ), 0 ) );
		drive = hinge( test, *left, nullptr, btVector3( -1, btScalar( 2.8 ), 0 ) );
		axle = hinge( test, *right, nullptr, btVector3( 1, btScalar( 2.8 ), 0 ) );
	}
};

constexpr btScalar kTurn = btScalar( 0.8 ); // rad

void turn( TestWorld& test, Linkage& linkage )
{
	linkage.left->setActivationState( DISABLE_DEACTIVATION );
	linkage.drive->enableMotor( true );
	linkage.drive->setMaxMotorImpulse( 10 );
	for ( int frame = 0; frame < 240; ++frame )
	{
		linkage.drive->setMotorTarget( std::min( kTurn, kTurn * btScalar( frame ) / 120 ), test::kFrame );
		test.run( 1 );
	}
	for ( auto* joint : { linkage.drive.get(), linkage.axle.get(), linkage.near.get(), linkage.far.get() } )
	{
		test.world.removeConstraint( joint );
	}
}

TEST_P( Framed, ABarBetweenTwoHingedLinksTurnsTheFarOne )
{
	btScalar turned[2];
	for ( const bool isSoft : { false, true } )
	{
		TestWorld test;
		Linkage linkage;
		linkage.addLinks( test );
		test.world.getSolverInfo().m_numIterations = 50;
		btRigidBody *near = nullptr, *far = nullptr;
		if ( isSoft )
		{
			SoftBody* const bar = test.addSoft( block( 21, 3, 3, 0.1f ), at( 0, btScalar( 2.4 ), 0 ), material( GetParam(), 20.0f, 3e6f ) );
			near = frameOf( test, *bar, btVector3( -1, btScalar( 2.4 ), 0 ), btScalar( 0.12 ) );
			far = frameOf( test, *bar, btVector3( 1, btScalar( 2.4 ), 0 ), btScalar( 0.12 ) );
		}
		else
		{
			near = far = test.addBox( btScalar( 3.78 ), btVector3( 1.05f, 0.15f, 0.15f ), at( 0, btScalar( 2.4 ), 0 ) );
		}
		linkage.near = hinge( test, *linkage.left, near, btVector3( -1, btScalar( 2.4 ), 0 ) );
		linkage.far = hinge( test, *linkage.right, far, btVector3( 1, btScalar( 2.4 ), 0 ) );
		for ( const auto& bar : test.soft ) // they overlap
		{
			bar->setIgnoreCollisionCheck( linkage.left, true );
			bar->setIgnoreCollisionCheck( linkage.right, true );
		}
		turn( test, linkage );
		turned[isSoft] = angleOf( *linkage.right );
		EXPECT_NEAR( turned[isSoft], angleOf( *linkage.left ), 0.03 );
	}
	EXPECT_NEAR( turned[1], turned[0], 0.05 );
	EXPECT_NEAR( std::abs( turned[1] ), kTurn, 0.05 );
}

// A motor at its axle accelerates a wheel up to the motor's velocity, with its torque over the wheel's inertia.
TEST_P( Framed, AMotorTurnsAWheel )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const wheel = addCube( test, btVector3( 0, 2, 0 ), GetParam() );
	btRigidBody* const axle = frameOf( test, *wheel, btVector3( 0, 2, 0 ), btScalar( 0.1 ) );
	const auto joint = hinge( test, *axle, nullptr, btVector3( 0, 2, 0 ) );
	const btScalar torque = btScalar( 0.05 ), speed = 3;           // N m, rad/s
	const double inertia = 0.4 * 0.4 / 6.0 * ( 1.0 - 1.0 / 16.0 ); // kg m^2, of its nodes as points
	joint->enableAngularMotor( true, -speed, torque * test::kFrame );
	test.run( 30 );
	const double spin = std::abs( double( wheel->angularMomentum().z() ) );
	EXPECT_NEAR( spin, double( torque ) * 0.5, 0.03 * double( torque ) );
	EXPECT_NEAR( std::abs( double( wheel->angularVelocity().z() ) ), double( torque ) * 0.5 / inertia, 0.1 );
	joint->setMaxMotorImpulse( 1 );
	test.run( 120 );
	EXPECT_NEAR( std::abs( wheel->angularVelocity().z() ), speed, 0.03 );
	EXPECT_NEAR( std::abs( axle->getAngularVelocity().z() ), speed, 0.2 );
	EXPECT_LT( ( wheel->massCentre() - btVector3( 0, 2, 0 ) ).length(), 0.01 );
	test.world.removeConstraint( joint.get() );
}

// A slider holds a cube up and lets it move along x, with the acceleration of an applied force.
TEST_P( Framed, ASliderGuidesACube )
{
	TestWorld test;
	SoftBody* const cube = addCube( test, btVector3( 0, 2, 0 ), GetParam() );
	btRigidBody* const frame = frameOf( test, *cube, btVector3( 0, 2, 0 ), btScalar( 0.2 ) );
	btRigidBody* const rail = test.addBox( 0, btVector3( 0.05f, 0.05f, 0.05f ), at( 0, 3, 0 ) );
	btSliderConstraint slider( *rail, *frame, at( 0, -1, 0 ), frame->getWorldTransform().inverse() * at( 0, 2, 0 ), true );
	slider.setLowerLinLimit( -5 );
	slider.setUpperLinLimit( 5 );
	slider.setLowerAngLimit( 0 );
	slider.setUpperAngLimit( 0 );
	test.world.addConstraint( &slider );
	test.run( 60 );
	EXPECT_NEAR( cube->massCentre().y(), 2, 0.02 );
	for ( int k = 0; k < 60; ++k )
	{
		ASSERT_TRUE( cube->applyCentralForce( btVector3( 2, 0, 0 ) ).ok() );
		test.run( 1 );
	}
	EXPECT_NEAR( cube->linearVelocity().x(), 2, 0.1 );
	EXPECT_NEAR( cube->massCentre().x(), 1, 0.1 );
	EXPECT_NEAR( cube->massCentre().y(), 2, 0.02 );
	EXPECT_LT( cube->bestFitTransform().getRotation().getAngleShortestPath(), 0.05 );
	test.world.removeConstraint( &slider );
}

// In free flight joints of every axis keep the momentum of a cube and a box.
TEST_P( Framed, KeepsMomentum )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const cube = addCube( test, btVector3( 0, 2, 0 ), GetParam() );
	btRigidBody* const box = test.addBox( 2, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, btScalar( 1.5 ), 0 ) );
	btRigidBody* const frame = frameOf( test, *cube, btVector3( 0, btScalar( 1.8 ), 0 ), btScalar( 0.12 ) );
	const btTransform inCube = frame->getWorldTransform().inverse() * at( 0, btScalar( 1.8 ), 0 ), inBox = at( 0, btScalar( 0.3 ), 0 );
	btGeneric6DofSpring2Constraint joint( *frame, *box, inCube, inBox );
	for ( int axis = 0; axis < 6; ++axis )
	{
		joint.setLimit( axis, 0, 0 );
	}
	test.world.addConstraint( &joint );
	box->setLinearVelocity( btVector3( 1, 2, 0 ) );
	box->setAngularVelocity( btVector3( 0, 0, 2 ) );
	test::Momentum before = test::momentumOf( *cube );
	before += test::momentumOf( *box );
	test.run( 120 );
	test::Momentum after = test::momentumOf( *cube );
	after += test::momentumOf( *box );
	EXPECT_LT( ( after.linear - before.linear ).length(), 1e-5 * before.linear.length() );
	EXPECT_LT( ( after.angular - before.angular ).length(), 3e-3 * before.angular.length() ); // Bullet's joints lose some, too
	const btTransform apart = ( frame->getWorldTransform() * inCube ).inverseTimes( box->getWorldTransform() * inBox );
	EXPECT_LT( apart.getOrigin().length(), 0.01 );
	EXPECT_LT( apart.getRotation().getAngleShortestPath(), 0.05 );
	test.world.removeConstraint( &joint );
}

// A load of ten times the cube's mass on a frame of a sixteenth of it.
TEST_P( Framed, CarriesAHeavyLoad )
{
	TestWorld test;
	SoftBody* const cube = addCube( test, btVector3( 0, 4, 0 ), GetParam() );
	btRigidBody* const box = test.addBox( 10, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, btScalar( 3.6 ), 0 ) );
	for ( int node = 0; node < cube->nodeCount(); ++node )
	{
		if ( cube->nodePosition( node ).y() > btScalar( 4.1 ) )
		{
			ASSERT_TRUE( cube->pinNode( node ).ok() );
		}
	}
	btRigidBody* const frame = frameOf( test, *cube, btVector3( 0, btScalar( 3.8 ), 0 ), btScalar( 0.12 ) );
	const btVector3 point = inFrame( *frame, btVector3( 0, btScalar( 3.8 ), 0 ) );
	btPoint2PointConstraint joint( *frame, *box, point, btVector3( 0, btScalar( 0.2 ), 0 ) );
	test.world.addConstraint( &joint );
	test.run( 600 );
	EXPECT_LT( ( frame->getWorldTransform() * point - box->getWorldTransform() * btVector3( 0, btScalar( 0.2 ), 0 ) ).length(), 2e-3 );
	EXPECT_NEAR( box->getWorldTransform().getOrigin().y(), 3.6, 0.05 );
	EXPECT_LT( box->getLinearVelocity().length(), 0.01 );
	EXPECT_FALSE( cube->isActive() ); // it has come to rest and sleeps, the frame with it
	EXPECT_FALSE( frame->isActive() );
	frame->activate();
	test.run( 1 );
	EXPECT_TRUE( cube->isActive() );
	test.world.removeConstraint( &joint );
}

INSTANTIATE_TEST_SUITE_P( Steps, Framed, testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& step ) { return std::string( step.param == Elasticity::Implicit ? "Implicit" : "Explicit" ); } );

// The piece with most of the patch keeps the frame, and with it its hook.
TEST( Frames, GoWithThePieceThatHasThePatch )
{
	for ( const int coarseLevels : { 0, 1 } )
	{
		TestWorld test;
		Adaptivity settings;
		settings.coarseLevels = coarseLevels;
		SoftBody* const bar = test.addSoft( block( 12, 4, 4, 0.1f ), at( 0, 3, 0 ), material( Elasticity::Explicit, 10.0f ), settings );
		btRigidBody* const left = frameOf( test, *bar, btVector3( btScalar( -0.5 ), 3, 0 ), btScalar( 0.22 ) );
		btRigidBody* const right = frameOf( test, *bar, btVector3( btScalar( 0.5 ), 3, 0 ), btScalar( 0.22 ) );
		btPoint2PointConstraint hook( *left, btVector3( 0, 0, 0 ) );
		test.world.addConstraint( &hook );
		test.run( 5 );
		ASSERT_GT( bar->cutPlane( bar->massCentre(), btVector3( 1, 0, 0 ) ), 0 );
		test.run( 60 );
		ASSERT_EQ( test.world.softBodyCount(), 2 );
		SoftBody *const holds = test.world.frameOwner( left ), *const falls = test.world.frameOwner( right );
		ASSERT_TRUE( holds && falls );
		EXPECT_NE( holds, falls );
		EXPECT_GT( holds->massCentre().y(), 2.3 );
		EXPECT_LT( falls->massCentre().y(), 1 );
		EXPECT_LT( ( right->getWorldTransform().getOrigin() - falls->massCentre() ).length(), 0.5 );
		test.world.removeConstraint( &hook );
	}
}

TEST( Frames, FollowLevels )
{
	TestWorld test;
	Adaptivity settings;
	settings.coarseLevels = 2;
	SoftBody* const cube = test.addSoft(
		block( 8, 8, 8, 0.05f ), at( 0, btScalar( 4.6 ), 0 ), material( Elasticity::Explicit, 1.0f / 0.064f ), settings );
	btRigidBody* const frame = frameOf( test, *cube, btVector3( 0, btScalar( 4.8 ), 0 ), btScalar( 0.2 ) );
	const btVector3 point = inFrame( *frame, btVector3( 0, btScalar( 4.8 ), 0 ) );
	btPoint2PointConstraint hook( *frame, point );
	test.world.addConstraint( &hook );
	for ( int level = 0; level < 3; ++level )
	{
		cube->requestRefinement( btVector3( -9, -9, -9 ), btVector3( 9, 9, 9 ) );
		cube->setFinestLevel( level );
		test.run( 60 );
		EXPECT_EQ( test.world.frameOwner( frame ), cube );
		EXPECT_GT( cube->massCentre().y(), 4.4 ) << "level " << level;
		EXPECT_NEAR( ( frame->getWorldTransform() * point ).y(), 4.8, 0.01 ) << "level " << level;
	}
	test.world.removeConstraint( &hook );
}

// Either object may be removed first; the other stays valid, and the frame can still be removed.
TEST( Frames, OutliveTheirSoftBody )
{
	TestWorld test;
	SoftBody* const cube = addCube( test, btVector3( 0, 2, 0 ), Elasticity::Explicit );
	btRigidBody* const frame = frameOf( test, *cube, btVector3( 0, 2, 0 ), btScalar( 0.12 ) );
	btRigidBody* const other = frameOf( test, *cube, btVector3( 0, btScalar( 2.2 ), 0 ), btScalar( 0.12 ) );
	test.run( 2 );
	test.world.removeRigidBody( other ); // as a game may do with all its rigid bodies
	EXPECT_EQ( test.world.frameOwner( other ), nullptr );
	test.run( 2 );
	EXPECT_TRUE( test.world.removeFrame( other ) );
	test.soft.clear();
	EXPECT_EQ( test.world.frameOwner( frame ), nullptr );
	const btScalar mass = frame->getMass();
	EXPECT_GT( mass, 0.05 );
	test.run( 30 );
	EXPECT_LT( frame->getWorldTransform().getOrigin().y(), 1 ); // it falls as a rigid body
	EXPECT_TRUE( test.world.removeFrame( frame ) );
	EXPECT_FALSE( test.world.removeFrame( frame ) );
}

TEST( Frames, RefuseBadArguments )
{
	TestWorld test, elsewhere;
	SoftBody* const cube = addCube( test, btVector3( 0, 2, 0 ), Elasticity::Implicit );
	btRigidBody* const box = test.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
	const int objects = test.world.getNumCollisionObjects();
	const btVector3 middle( 0, 2, 0 );
	EXPECT_EQ( test.world.addFrame( *cube, btVector3( NAN, 0, 0 ), 1 ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.addFrame( *cube, middle, NAN ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.addFrame( *cube, middle, 0 ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.addFrame( *cube, middle, -1 ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.addFrame( *cube, middle, btScalar( 0.01 ) ).status.code, ResultCode::BadArgument ); // no node
	EXPECT_EQ( test.world.addFrame( *cube, middle + btVector3( 0, 9, 0 ), 1 ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( elsewhere.world.addFrame( *cube, middle, 1 ).status.code, ResultCode::BadArgument );
	SoftBody* const rod = test.addSoft( block( 6, 1, 1, 0.1f ), at( 2, 2, 0 ), material( Elasticity::Explicit, 10.0f ) );
	EXPECT_EQ( test.world.addFrame( *rod, btVector3( 2, 2, 0 ), 1 ).status.code, ResultCode::BadArgument ); // nodes on a line
	EXPECT_EQ( test.world.getNumCollisionObjects(), objects + 1 );
	EXPECT_FALSE( test.world.removeFrame( nullptr ) );
	EXPECT_FALSE( test.world.removeFrame( box ) );
	EXPECT_EQ( test.world.frameOwner( nullptr ), nullptr );
	EXPECT_EQ( test.world.frameOwner( box ), nullptr );
}

} // namespace
} // namespace pliant
