// Two-way attachments: points of soft bodies attached to rigid bodies and to other soft bodies.

#include "support/momentum.h"
#include "world/test_world.h"

#include <cmath>
#include <utility>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

Material material( Elasticity elasticity, float youngsModulus = 1e6f )
{
	Material made = test::stiff( youngsModulus );
	made.elasticity = elasticity;
	made.density = 1.0f / 0.064f; // a cube of 0.4 m: 1 kg
	made.damping = 5.0f;
	return made;
}

/// A cube of 0.4 m and 1 kg about a position.
SoftBody* addCube( TestWorld& test, const btVector3& where, const Material& material )
{
	return test.addSoft( block( 4, 4, 4, 0.1f ), btTransform( btQuaternion::getIdentity(), where ), material );
}

int nodeNear( const SoftBody& body, const btVector3& where )
{
	int nearest = 0;
	for ( int node = 1; node < body.nodeCount(); ++node )
	{
		nearest = body.nodePosition( node ).distance( where ) < body.nodePosition( nearest ).distance( where ) ? node : nearest;
	}
	return nearest;
}

/// Attaches the four nodes in the middle of a cube's upper side to a rigid body.
void attachTop( TestWorld& test, SoftBody& cube, btRigidBody& to )
{
	for ( const btScalar x : { btScalar( -0.05 ), btScalar( 0.05 ) } )
	{
		for ( const btScalar z : { btScalar( -0.05 ), btScalar( 0.05 ) } )
		{
			const int node = nodeNear( cube, cube.massCentre() + btVector3( x, btScalar( 0.15 ), z ) );
			ASSERT_TRUE( test.world.attach( cube, node, to ).ok() );
		}
	}
}

test::Momentum momentumOf( const TestWorld& test )
{
	test::Momentum sum;
	for ( const auto& body : test.soft )
	{
		sum += test::momentumOf( *body );
	}
	for ( const auto& body : test.rigid )
	{
		sum += body->getInvMass() > 0 ? test::momentumOf( *body ) : test::Momentum{};
	}
	return sum;
}

class Attached : public testing::TestWithParam<Elasticity>
{};

// The joint carries the box and the cube.
TEST_P( Attached, ABoxOnAJointCarriesACube )
{
	TestWorld test;
	const btScalar g = test.world.getGravity().length();
	btRigidBody* const box = test.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
	SoftBody* const cube = addCube( test, btVector3( 0, btScalar( 4.65 ), 0 ), material( GetParam() ) );
	attachTop( test, *cube, *box );
	btPoint2PointConstraint joint( *box, btVector3( 0, btScalar( 0.1 ), 0 ) );
	btJointFeedback feedback;
	joint.setJointFeedback( &feedback );
	joint.enableFeedback( true );
	test.world.addConstraint( &joint );
	cube->setActivationState( DISABLE_DEACTIVATION ); // asleep it would report the force of its last step
	test.run( 480 );
	btScalar carried = 0, pulled = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		test.run( 1 );
		carried += feedback.m_appliedForceBodyA.y() / 60;
		for ( int id = 0; id < 4; ++id )
		{
			pulled += test.world.attachmentForce( id ).y() / 60;
		}
	}
	EXPECT_NEAR( std::abs( carried ), 2 * g, 0.02 * 2 * g );
	EXPECT_NEAR( pulled, g, 0.02 * g );
	EXPECT_NEAR( cube->massCentre().y(), 4.65, 0.02 );
	test.world.removeConstraint( &joint );
}

// In free flight a rigid box and a cube attached to it keep their total momentum, and the attached points stay together.
TEST_P( Attached, KeepsMomentum )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	btRigidBody* const box = test.addBox( 2, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
	SoftBody* const cube = addCube( test, btVector3( 0, btScalar( 4.65 ), 0 ), material( GetParam() ) );
	attachTop( test, *cube, *box );
	box->setLinearVelocity( btVector3( 1, 2, 0 ) );
	box->setAngularVelocity( btVector3( 0, 0, 2 ) );
	const test::Momentum before = momentumOf( test );
	test.run( 120 );
	const test::Momentum after = momentumOf( test );
	EXPECT_LT( ( after.linear - before.linear ).length(), 1e-5 * before.linear.length() );
	EXPECT_LT( ( after.angular - before.angular ).length(), 1e-4 * before.angular.length() );
	const int node = nodeNear( *cube, box->getWorldTransform() * btVector3( btScalar( 0.05 ), btScalar( -0.2 ), btScalar( 0.05 ) ) );
	const btVector3 there = box->getWorldTransform().invXform( cube->nodePosition( node ) );
	EXPECT_NEAR( there.y(), -0.2, 0.01 );
}

// Two welded cubes are lifted by one of them.
TEST_P( Attached, WeldedCubesAreLiftedByOne )
{
	TestWorld test;
	SoftBody* const upper = addCube( test, btVector3( 0, btScalar( 4.4 ), 0 ), material( GetParam() ) );
	SoftBody* const lower = addCube( test, btVector3( 0, 4, 0 ), material( GetParam() ) );
	const Result<int> welded = test.world.weld( *upper, *lower, btScalar( 0.11 ) );
	ASSERT_TRUE( welded.ok() ) << welded.status.sentence;
	EXPECT_EQ( welded.value, 16 );
	for ( int node = 0; node < upper->nodeCount(); ++node )
	{
		if ( upper->nodePosition( node ).y() > btScalar( 4.5 ) )
		{
			ASSERT_TRUE( upper->pinNode( node ).ok() );
		}
	}
	test.run( 240 );
	EXPECT_NEAR( lower->massCentre().y(), 4, 0.01 );
	EXPECT_NEAR( lower->massCentre().x(), 0, 0.01 );
}

// Two welded cubes of different stiffness fly and spin freely: forces at shared points have the right torque.
TEST_P( Attached, WeldedCubesKeepMomentumAndSpin )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const upper = addCube( test, btVector3( 0, btScalar( 4.4 ), 0 ), material( GetParam() ) );
	SoftBody* const lower = addCube( test, btVector3( 0, 4, 0 ), material( GetParam(), 1e5f ) );
	ASSERT_TRUE( test.world.weld( *upper, *lower, btScalar( 0.11 ) ).ok() );
	for ( SoftBody* body : { upper, lower } )
	{
		const btVector3 spin( 0, 0, 1 ), arm = body->massCentre() - btVector3( 0, btScalar( 4.2 ), 0 );
		ASSERT_TRUE( body->setVelocities( btVector3( 1, 0, 0 ) + spin.cross( arm ), spin ).ok() );
	}
	const test::Momentum before = momentumOf( test );
	test.run( 120 );
	const test::Momentum after = momentumOf( test );
	EXPECT_LT( ( after.linear - before.linear ).length(), 2e-5 * before.linear.length() );
	EXPECT_LT( ( after.angular - before.angular ).length(), 1e-4 * before.angular.length() );
	EXPECT_LT( ( upper->massCentre() - lower->massCentre() ).length(), 0.45 );
}

// Points stay together under a load of twenty times the cube's mass, in the implicit step of two hundred times.
TEST_P( Attached, HoldsHeavyLoads )
{
	TestWorld test;
	SoftBody* const cube = addCube( test, btVector3( 0, 4, 0 ), material( GetParam() ) );
	const btScalar mass = GetParam() == Elasticity::Implicit ? btScalar( 200 ) : btScalar( 20 );
	btRigidBody* const box = test.addBox( mass, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, btScalar( 3.6 ), 0 ) );
	std::vector<std::pair<int, btVector3>> held;
	for ( int node = 0; node < cube->nodeCount(); ++node )
	{
		const btVector3 where = cube->nodePosition( node ) - cube->massCentre();
		if ( where.y() > btScalar( 0.14 ) )
		{
			ASSERT_TRUE( cube->pinNode( node ).ok() );
		}
		else if ( where.y() < btScalar( -0.14 ) )
		{
			held.emplace_back( node, box->getWorldTransform().invXform( cube->nodePosition( node ) ) );
			ASSERT_TRUE( test.world.attach( *cube, node, *box ).ok() );
		}
	}
	test.run( 300 );
	for ( const auto& [node, point] : held )
	{
		EXPECT_LT( ( box->getWorldTransform() * point - cube->nodePosition( node ) ).length(), 3e-5 );
	}
}

TEST_P( Attached, AKinematicBodyCarriesACube )
{
	TestWorld test;
	btRigidBody* const crane = test.addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
	crane->setCollisionFlags( crane->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
	crane->setActivationState( DISABLE_DEACTIVATION );
	SoftBody* const cube = addCube( test, btVector3( 0, btScalar( 4.65 ), 0 ), material( GetParam() ) );
	attachTop( test, *cube, *crane );
	for ( int frame = 0; frame < 240; ++frame )
	{
		crane->setWorldTransform( at( btScalar( frame ) / 120, 5, 0 ) );
		crane->setInterpolationWorldTransform( crane->getWorldTransform() );
		test.run( 1 );
	}
	EXPECT_NEAR( cube->massCentre().x(), 2, 0.1 );
	EXPECT_NEAR( cube->massCentre().y(), 4.65, 0.05 );
}

TEST_P( Attached, BreaksAtItsForceAndTells )
{
	TestWorld test;
	const btScalar g = test.world.getGravity().length();
	btRigidBody* const hook = test.addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
	SoftBody* const cube = addCube( test, btVector3( 0, btScalar( 4.65 ), 0 ), material( GetParam() ) );
	AttachmentSettings settings;
	settings.breakingForce = btScalar( 3 ) * g;
	const Result<int> made = test.world.attach( *cube, btVector3( 0, btScalar( 4.8 ), 0 ), *hook, settings );
	ASSERT_TRUE( made.ok() );
	test.run( 120 );
	EXPECT_EQ( test.world.attachmentCount(), 1 );
	ASSERT_TRUE( cube->applyCentralForce( btVector3( 0, btScalar( -4 ) * g, 0 ) ).ok() );
	test.run( 1 );
	for ( int frame = 0; frame < 30 && test.world.attachmentEvents().empty(); ++frame )
	{
		ASSERT_TRUE( cube->applyCentralForce( btVector3( 0, btScalar( -4 ) * g, 0 ) ).ok() );
		test.run( 1 );
	}
	ASSERT_EQ( test.world.attachmentEvents().size(), 1u );
	const AttachmentEvent& event = test.world.attachmentEvents()[0];
	EXPECT_EQ( event.id, made.value );
	EXPECT_EQ( event.body, cube );
	EXPECT_EQ( event.rigid, hook );
	EXPECT_GT( event.force.length(), settings.breakingForce );
	EXPECT_EQ( test.world.attachmentCount(), 0 );
	test.run( 1 );
	EXPECT_TRUE( test.world.attachmentEvents().empty() );
}

// A spring of compliance c is stretched by m g c.
TEST_P( Attached, GivesWayByItsCompliance )
{
	TestWorld test;
	const btScalar g = test.world.getGravity().length();
	btRigidBody* const hook = test.addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
	SoftBody* const cube = addCube( test, btVector3( 0, btScalar( 4.6 ), 0 ), material( GetParam() ) );
	AttachmentSettings settings;
	settings.compliance = btScalar( 0.01 );
	ASSERT_TRUE( test.world.attach( *cube, btVector3( 0, btScalar( 4.6 ), 0 ), *hook, settings ).ok() );
	cube->setActivationState( DISABLE_DEACTIVATION );
	double height = 0.0; // it oscillates at 1.6 / s: the mean of sixteen samples
	for ( int frame = 0; frame < 600; ++frame )
	{
		test.run( 1 );
		height += double( cube->massCentre().y() ) / 600;
	}
	EXPECT_NEAR( height, 4.6 - double( g ) * 0.01, 0.005 );
}

INSTANTIATE_TEST_SUITE_P( Steps, Attached, testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& step ) { return std::string( step.param == Elasticity::Implicit ? "Implicit" : "Explicit" ); } );

// Random cuts and breaks: attachments follow their pieces, without dangling references.
TEST( Attachments, SurviveFracture )
{
	for ( unsigned seed = 1; seed <= 20; ++seed )
	{
		TestWorld test;
		SoftBody* const bar = test.addSoft(
			block( 12, 3, 3, 0.1f ), at( 0, 3, 0 ), material( seed % 2 ? Elasticity::Explicit : Elasticity::Implicit ) );
		btRigidBody* const left = test.addBox( 0, btVector3( 0.05f, 0.05f, 0.05f ), at( btScalar( -0.55 ), btScalar( 3.5 ), 0 ) );
		btRigidBody* const right = test.addBox( 1, btVector3( 0.05f, 0.05f, 0.05f ), at( btScalar( 0.55 ), btScalar( 3.5 ), 0 ) );
		const int leftNode = nodeNear( *bar, btVector3( btScalar( -0.55 ), 3, 0 ) ),
				  rightNode = nodeNear( *bar, btVector3( btScalar( 0.55 ), 3, 0 ) );
		ASSERT_TRUE( test.world.attach( *bar, leftNode, *left ).ok() );
		ASSERT_TRUE( test.world.attach( *bar, rightNode, *right ).ok() );
		test.run( 5 );
		const btScalar where = btScalar( 0.07 ) * btScalar( seed % 7 ) - btScalar( 0.2 );
		ASSERT_GT(
			bar->cutPlane( bar->massCentre() + btVector3( where, 0, 0 ), btVector3( 1, btScalar( 0.1 ) * btScalar( seed % 3 ), 0 ) ), 0 );
		test.run( 60 );
		EXPECT_EQ( test.world.softBodyCount(), 2 );
		EXPECT_EQ( test.world.attachmentCount(), 2 );
		// The left piece hangs from its hook; the right one falls with its box.
		btScalar highest = -10;
		for ( int k = 0; k < 2; ++k )
		{
			highest = std::max( highest, test.world.softBody( k )->massCentre().y() );
		}
		EXPECT_GT( highest, 2 );
		EXPECT_LT( right->getWorldTransform().getOrigin().y(), 1 );
		test.world.removeRigidBody( right );
		EXPECT_EQ( test.world.attachmentCount(), 1 );
		test.world.addRigidBody( right );
		test.soft.clear();
		for ( int k = test.world.softBodyCount() - 1; k >= 0; --k )
		{
			const std::unique_ptr<SoftBody> fragment( test.world.softBody( k ) ); // the game's once it is removed
			test.world.removeSoftBody( fragment.get() );
		}
		EXPECT_EQ( test.world.attachmentCount(), 0 );
		test.run( 2 );
	}
}

TEST( Attachments, FollowLevels )
{
	TestWorld test;
	Adaptivity settings;
	settings.coarseLevels = 2;
	SoftBody* const cube = test.addSoft( block( 8, 8, 8, 0.05f ), at( 0, btScalar( 4.6 ), 0 ), material( Elasticity::Explicit ), settings );
	btRigidBody* const hook = test.addBox( 0, btVector3( 0.05f, 0.05f, 0.05f ), at( 0, 5, 0 ) );
	ASSERT_TRUE( test.world.attach( *cube, nodeNear( *cube, btVector3( 0, btScalar( 4.8 ), 0 ) ), *hook ).ok() );
	for ( int level = 0; level < 3; ++level )
	{
		cube->requestRefinement( btVector3( -9, -9, -9 ), btVector3( 9, 9, 9 ) );
		cube->setFinestLevel( level );
		test.run( 60 );
		EXPECT_EQ( test.world.attachmentCount(), 1 );
		EXPECT_GT( cube->massCentre().y(), 4.3 ) << "level " << level;
	}
}

TEST( Attachments, SurviveFractureOfABodyWithLevels )
{
	TestWorld test;
	Adaptivity settings;
	settings.coarseLevels = 1;
	SoftBody* const bar = test.addSoft( block( 12, 4, 4, 0.1f ), at( 0, 3, 0 ), material( Elasticity::Explicit ), settings );
	btRigidBody* const hook = test.addBox( 0, btVector3( 0.05f, 0.05f, 0.05f ), at( btScalar( -0.5 ), btScalar( 3.5 ), 0 ) );
	btRigidBody* const load = test.addBox( 1, btVector3( 0.05f, 0.05f, 0.05f ), at( btScalar( 0.5 ), btScalar( 3.5 ), 0 ) );
	ASSERT_TRUE( test.world.attach( *bar, btVector3( btScalar( -0.5 ), 3, 0 ), *hook ).ok() );
	ASSERT_TRUE( test.world.attach( *bar, btVector3( btScalar( 0.5 ), 3, 0 ), *load ).ok() );
	test.run( 5 );
	ASSERT_GT( bar->cutPlane( bar->massCentre(), btVector3( 1, 0, 0 ) ), 0 );
	test.run( 60 );
	EXPECT_EQ( test.world.softBodyCount(), 2 );
	EXPECT_EQ( test.world.attachmentCount(), 2 );
	EXPECT_LT( load->getWorldTransform().getOrigin().y(), 1 );
	EXPECT_GT( std::max( test.world.softBody( 0 )->massCentre().y(), test.world.softBody( 1 )->massCentre().y() ), 2 );
}

TEST( Attachments, RefuseBadArguments )
{
	TestWorld test, elsewhere;
	SoftBody* const cube = addCube( test, btVector3( 0, 2, 0 ), material( Elasticity::Implicit ) );
	btRigidBody* const box = test.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
	btRigidBody* const far = elsewhere.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
	AttachmentSettings bad;
	bad.compliance = btScalar( -1 );
	EXPECT_EQ( test.world.attach( *cube, -1, *box ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.attach( *cube, cube->nodeCount(), *box ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.attach( *cube, 0, *far ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( elsewhere.world.attach( *cube, 0, *far ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.attach( *cube, 0, *box, bad ).status.code, ResultCode::BadSettings );
	EXPECT_EQ( test.world.attach( *cube, *cube, btVector3( 0, 2, 0 ) ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.attach( *cube, btVector3( NAN, 0, 0 ), *box ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( test.world.weld( *cube, *cube, 1 ).status.code, ResultCode::BadArgument );
	EXPECT_FALSE( test.world.detach( 0 ) );
	EXPECT_EQ( test.world.attachmentForce( 7 ).length(), 0 );
	EXPECT_EQ( test.world.attachmentCount(), 0 );
}

} // namespace
} // namespace pliant
