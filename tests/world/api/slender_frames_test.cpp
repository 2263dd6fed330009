// Bullet's joints on slender soft bodies. A bar of 2 x .1 x .1 m hung .07 m below its joint, a clamped one vibrated without end, and a
// stiff one on a hinge left its joint by 3 m: the frame's rigid body has one mass, the end of a bar moves sixteen times as easily across as
// along, and the force of the joints was learnt from what they lacked.

#include "world/test_world.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

constexpr btScalar kLength = 2, kWidth = btScalar( 0.1 ); // m
constexpr btScalar kMass = 20;                            // kg

/// A bar of 20 kg whose end at the origin is in a frame.
struct FramedBar
{
	FramedBar( Elasticity elasticity, float youngsModulus, const btVector3& along ) : end( 0, 5, 0 )
	{
		const btVector3 size = kLength * along + kWidth * ( btVector3( 1, 1, 1 ) - along );
		Material material;
		material.elasticity = elasticity;
		material.youngsModulus = youngsModulus;
		const btVector3 middle = end + ( along.y() > 0 ? -1 : 1 ) * kLength / 2 * along;
		bar = scene.addSoft( test::boxTemplate( { float( size.x() ), float( size.y() ), float( size.z() ) }, float( kWidth ) / 2 ),
			btTransform( btQuaternion::getIdentity(), middle ), material );
		bar->setActivationState( DISABLE_DEACTIVATION );
		frame = frameAt( end );
		inFrame = frame->getWorldTransform().invXform( end );
	}
	btRigidBody* frameAt( const btVector3& where )
	{
		const Result<btRigidBody*> made = scene.world.addFrame( *bar, where, btScalar( 1.5 ) * kWidth );
		EXPECT_TRUE( made.ok() ) << made.status.sentence;
		return made.value;
	}
	~FramedBar() { joint ? scene.world.removeConstraint( joint.get() ) : void(); }
	void add( std::unique_ptr<btTypedConstraint> made )
	{
		joint = std::move( made );
		joint->setJointFeedback( &feedback );
		joint->enableFeedback( true );
		scene.world.addConstraint( joint.get(), true );
	}
	/// Runs and returns the largest distance of the joint from its place, m.
	btScalar run( int frames )
	{
		btScalar most = 0;
		for ( int k = 0; k < frames; ++k )
		{
			scene.run( 1 );
			most = std::max( most, ( frame->getWorldTransform() * inFrame - end ).length() );
		}
		return most;
	}

	TestWorld scene;
	btVector3 end, inFrame;
	SoftBody* bar = nullptr;
	btRigidBody* frame = nullptr;
	std::unique_ptr<btTypedConstraint> joint;
	btJointFeedback feedback;
};

class SlenderFramed : public testing::TestWithParam<float>
{};

TEST_P( SlenderFramed, ABarHangsFromItsEnd )
{
	FramedBar test( Elasticity::Implicit, GetParam(), btVector3( 0, 1, 0 ) );
	test.add( std::make_unique<btPoint2PointConstraint>( *test.frame, test.inFrame ) );
	EXPECT_LT( test.run( 300 ), 1e-3 );
	EXPECT_NEAR( test.feedback.m_appliedForceBodyA.length(), kMass * test::kGravity, 0.01 * kMass * test::kGravity );
}

TEST_P( SlenderFramed, AClampedBarComesToRest )
{
	FramedBar test( Elasticity::Implicit, GetParam(), btVector3( 1, 0, 0 ) );
	btRigidBody* const wall = test.scene.addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( btScalar( -0.2 ), 5, 0 ) );
	const btTransform inWall( btQuaternion::getIdentity(), btVector3( 0.2f, 0, 0 ) );
	btTransform inFrame = test.frame->getWorldTransform().inverse();
	inFrame.setOrigin( test.inFrame );
	test.add( std::make_unique<btFixedConstraint>( *test.frame, *wall, inFrame, inWall ) );
	EXPECT_LT( test.run( 900 ), 1e-3 );
	EXPECT_NEAR( test.feedback.m_appliedForceBodyA.y(), kMass * test::kGravity, 0.05 * kMass * test::kGravity );
	EXPECT_NEAR( test.feedback.m_appliedForceBodyA.x(), 0, 0.05 * kMass * test::kGravity );
}

// A stiff one was torn off its hinge: velocities that are not quite those of the implicit step's matrix shake a body in which sound travels
// far in a step, and a force that follows the joints at once alternates where the patch yields more than was solved for.
TEST_P( SlenderFramed, AHingedBarSwingsAsARigidOne )
{
	FramedBar test( Elasticity::Implicit, GetParam(), btVector3( 1, 0, 0 ) );
	btRigidBody* const twin = test.scene.addBox( kMass, btVector3( kLength, kWidth, kWidth ) / 2, at( kLength / 2, 5, 3 ) );
	twin->setActivationState( DISABLE_DEACTIVATION );
	const btVector3 axis( 0, 0, 1 );
	btHingeConstraint twinHinge( *twin, btVector3( -kLength / 2, 0, 0 ), axis );
	test.scene.world.addConstraint( &twinHinge );
	test.add(
		std::make_unique<btHingeConstraint>( *test.frame, test.inFrame, test.frame->getWorldTransform().getBasis().transpose() * axis ) );
	btScalar worst = 0;
	for ( int k = 0; k < 60; ++k )
	{
		EXPECT_LT( test.run( 1 ), 5e-3 ); // the rigid bar: 9 mm
		worst = std::max( worst, std::abs( test.bar->massCentre().y() - twin->getWorldTransform().getOrigin().y() ) );
	}
	EXPECT_LT( worst, 0.03 );
	test.scene.world.removeConstraint( &twinHinge );
}

INSTANTIATE_TEST_SUITE_P( Moduli, SlenderFramed, testing::Values( 1e8f, 1e9f ) );

// The bar's weight needs 3.3 N m s a frame: a motor of 1 must not hold it.
TEST( SlenderFrames, AMotorKeepsToItsLimit )
{
	for ( const btScalar limit : { btScalar( 1 ), btScalar( 20 ) } )
	{
		FramedBar test( Elasticity::Implicit, 1e8f, btVector3( 1, 0, 0 ) );
		const btVector3 axis( 0, 0, 1 );
		auto hinge = std::make_unique<btHingeConstraint>(
			*test.frame, test.inFrame, test.frame->getWorldTransform().getBasis().transpose() * axis );
		hinge->enableAngularMotor( true, 0, limit );
		test.add( std::move( hinge ) );
		EXPECT_LT( test.run( 60 ), 1e-2 );
		EXPECT_EQ( 5 - test.bar->massCentre().y() > 0.3, limit < 2 ) << test.bar->massCentre().y();
	}
}

// A cube of .6 m on one hinge through a patch of a fifth of it spun ever faster, at 80 rad/s after five seconds.
TEST( SlenderFrames, ACubeOnAHingeKeepsItsEnergy )
{
	TestWorld scene;
	SoftBody* const cube = scene.addSoft( test::boxTemplate( { 0.6f, 0.6f, 0.6f }, 0.15f ), at( btScalar( 0.3 ), 5, 0 ), Material() );
	cube->setActivationState( DISABLE_DEACTIVATION );
	const btVector3 pin( 0, 5, 0 ), axis( 0, 0, 1 );
	btRigidBody& frame = *scene.world.addFrame( *cube, pin, btScalar( 0.185 ) ).value;
	btHingeConstraint hinge( frame, frame.getWorldTransform().invXform( pin ), frame.getWorldTransform().getBasis().transpose() * axis );
	scene.world.addConstraint( &hinge );
	btScalar fastest = 0;
	for ( int k = 0; k < 600; ++k )
	{
		scene.run( 1 );
		fastest = std::max( fastest, cube->angularVelocity().length() );
	}
	EXPECT_LT( fastest, 6.6 ); // sqrt( 2 m g d / I ) = 6.3 rad/s
	EXPECT_GT( fastest, 5.5 );
	scene.world.removeConstraint( &hinge );
}

// The responses counted a part of the body's rotation twice: a rotating cube on a joint with a free box lost a tenth of its angular
// momentum.
TEST( SlenderFrames, AJointWithAFreeBoxKeepsAngularMomentum )
{
	for ( const float youngsModulus : { 1e6f, 1e8f } )
	{
		TestWorld scene;
		scene.world.setGravity( btVector3( 0, 0, 0 ) );
		Material material;
		material.elasticity = Elasticity::Implicit;
		material.youngsModulus = youngsModulus;
		SoftBody* const cube = scene.addSoft( test::boxTemplate( { 0.4f, 0.4f, 0.4f }, 0.1f ), at( 0, 5, 0 ), material );
		cube->setActivationState( DISABLE_DEACTIVATION );
		btRigidBody* const box = scene.addBox( 64, btVector3( 0.2f, 0.2f, 0.2f ), at( btScalar( 0.6 ), 5, 0 ) );
		box->setActivationState( DISABLE_DEACTIVATION );
		btRigidBody& frame = *scene.world.addFrame( *cube, btVector3( 0.2f, 5, 0 ), btScalar( 0.16 ) ).value;
		const btTransform middle = at( btScalar( 0.3 ), 5, 0 );
		btFixedConstraint joint( frame, *box, frame.getWorldTransform().inverse() * middle, box->getWorldTransform().inverse() * middle );
		scene.world.addConstraint( &joint, true );
		ASSERT_TRUE( cube->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, 0, 3 ) ).ok() );
		const auto spin = [&] {
			const auto about = []( const btVector3& position, const btVector3& momentum ) {
				return ( position - btVector3( 0.3f, 5, 0 ) ).cross( momentum );
			};
			return cube->angularMomentum() + about( cube->massCentre(), cube->mass() * cube->linearVelocity() ) +
				about( box->getWorldTransform().getOrigin(), 64 * box->getLinearVelocity() ) +
				box->getInvInertiaTensorWorld().inverse() * box->getAngularVelocity();
		};
		const btVector3 before = spin();
		for ( int k = 0; k < 60; ++k )
		{
			scene.run( 1 );
			EXPECT_LT( ( spin() - before ).length(), 5e-3 * before.length() );
		}
		scene.world.removeConstraint( &joint );
	}
}

// A chain of three links of 1 kg carries a cube of 64 kg at 1/240 s, by an attachment and by a frame; at 1/60 s it does not (guide,
// joints).
TEST( SlenderFrames, AHeavyCubeHangsOnLightLinksInShortSteps )
{
	for ( const bool byFrame : { false, true } )
	{
		TestWorld scene;
		btRigidBody* last = scene.addBox( 0, btVector3( 0.05f, 0.05f, 0.05f ), at( 0, 5, 0 ) );
		std::vector<std::unique_ptr<btPoint2PointConstraint>> joints;
		const btVector3 below( 0, -0.15f, 0 );
		for ( int k = 1; k <= 3; ++k )
		{
			btRigidBody* const link = scene.add( 1, new btSphereShape( 0.05f ), at( 0, 5 - btScalar( 0.3 ) * btScalar( k ), 0 ) );
			link->setActivationState( DISABLE_DEACTIVATION );
			joints.push_back( std::make_unique<btPoint2PointConstraint>( *last, *link, below, -below ) );
			scene.world.addConstraint( joints.back().get(), true );
			last = link;
		}
		const btVector3 end = last->getWorldTransform().getOrigin() + below;
		SoftBody* const cube = scene.addSoft(
			test::boxTemplate( { 0.4f, 0.4f, 0.4f }, 0.4f / 6 ), at( 0, end.y() - btScalar( 0.2 ), 0 ), Material() );
		cube->setIgnoreCollisionCheck( last, true );
		if ( byFrame )
		{
			btRigidBody& frame = *scene.world.addFrame( *cube, end, btScalar( 0.15 ) ).value;
			joints.push_back( std::make_unique<btPoint2PointConstraint>( *last, frame, below, frame.getWorldTransform().invXform( end ) ) );
			scene.world.addConstraint( joints.back().get(), true );
		}
		else
		{
			ASSERT_TRUE( scene.world.attach( *cube, end, *last ).ok() );
		}
		for ( int k = 0; k < 960; ++k )
		{
			scene.world.stepSimulation( btScalar( 1 ) / 240, 0 );
		}
		EXPECT_NEAR( cube->massCentre().y(), end.y() - 0.2, 0.05 );
		for ( const auto& joint : joints )
		{
			scene.world.removeConstraint( joint.get() );
		}
	}
}

// A slab on the four crates that carry it. The joints' solution does not know the floor under them.
TEST( SlenderFrames, ASlabIsCarriedByCrates )
{
	TestWorld scene;
	scene.addFloor();
	Material material;
	material.elasticity = Elasticity::Implicit;
	material.youngsModulus = 1e7f;
	SoftBody* const slab = scene.addSoft( test::boxTemplate( { 0.6f, 0.1f, 0.6f }, 0.05f ), at( 0, btScalar( 0.45 ), 0 ), material );
	slab->setActivationState( DISABLE_DEACTIVATION );
	std::vector<std::unique_ptr<btFixedConstraint>> joints;
	for ( int k = 0; k < 4; ++k )
	{
		const btVector3 corner( k % 2 == 0 ? -0.25f : 0.25f, btScalar( 0.4 ), k / 2 == 0 ? -0.25f : 0.25f );
		btRigidBody* const crate = scene.addBox( 50, btVector3( 0.1f, 0.1f, 0.1f ), at( corner.x() * 2, btScalar( 0.1 ), corner.z() * 2 ) );
		crate->setActivationState( DISABLE_DEACTIVATION );
		btRigidBody& frame = *scene.world.addFrame( *slab, corner, btScalar( 0.12 ) ).value;
		const btTransform at( btQuaternion::getIdentity(), corner );
		joints.push_back( std::make_unique<btFixedConstraint>(
			frame, *crate, frame.getWorldTransform().inverse() * at, crate->getWorldTransform().inverse() * at ) );
		scene.world.addConstraint( joints.back().get(), true );
	}
	scene.run( 120 );
	btScalar fastest = 0;
	for ( int k = 0; k < 180; ++k )
	{
		scene.run( 1 );
		fastest = std::max( fastest, slab->linearVelocity().length() );
	}
	EXPECT_LT( fastest, 0.1 );
	EXPECT_NEAR( slab->massCentre().y(), 0.45, 0.02 );
	for ( const auto& joint : joints )
	{
		scene.world.removeConstraint( joint.get() );
	}
}

// The crate's mass counts beside the bar's, the ground below it does not.
TEST( SlenderFrames, ABarHangsOnACrateThatStandsOnTheGround )
{
	FramedBar test( Elasticity::Implicit, 1e8f, btVector3( 0, 1, 0 ) );
	test.scene.addFloor( btScalar( 4.8 ) - 5 );
	btRigidBody* const tower = test.scene.addBox( 200, btVector3( 0.3f, 2.6f, 0.3f ), at( 1, btScalar( 2.4 ), 0 ) );
	test.add(
		std::make_unique<btPoint2PointConstraint>( *test.frame, *tower, test.inFrame, tower->getWorldTransform().invXform( test.end ) ) );
	test.run( 300 );
	EXPECT_NEAR(
		( test.frame->getWorldTransform() * test.inFrame - tower->getWorldTransform() * btVector3( -1, 2.6f, 0 ) ).length(), 0, 5e-3 );
	EXPECT_NEAR( test.feedback.m_appliedForceBodyA.length(), kMass * test::kGravity, 0.05 * kMass * test::kGravity );
	EXPECT_LT( tower->getLinearVelocity().length(), 0.02 );
}

} // namespace
} // namespace pliant
