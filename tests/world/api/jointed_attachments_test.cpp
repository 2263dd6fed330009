// Attachments to rigid bodies on Bullet's joints, such as a tool on a motor or a hook, which are lighter than their loads.

#include "world/test_world.h"

#include <memory>
#include <string>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

enum class JointKind : int
{
	Point,
	Hinge,
	Motor,
	Fixed,
	Crank ///< a hinge half a metre aside, with a motor
};

struct JointedCase
{
	Elasticity elasticity;
	JointKind kind;
};

/// A cube of 0.4 m, 10 kg, attached by four nodes below a box on a joint with the world.
struct Jointed
{
	TestWorld test;
	btRigidBody* box = nullptr;
	SoftBody* cube = nullptr;
	std::unique_ptr<btTypedConstraint> joint;
	btJointFeedback feedback;
	btRigidBody world{ 0, nullptr, nullptr };

	Jointed( Elasticity elasticity, JointKind kind, btScalar mass )
	{
		Material material = test::stiff( 1e6f );
		material.elasticity = elasticity;
		material.density = 10.0f / 0.064f;
		material.damping = 5.0f;
		box = test.addBox( mass, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 5, 0 ) );
		cube = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 4.65 ), 0 ), material );
		cube->setIgnoreCollisionCheck( box, true );
		cube->setActivationState( DISABLE_DEACTIVATION );
		for ( const btScalar x : { btScalar( -0.05 ), btScalar( 0.05 ) } )
		{
			for ( const btScalar z : { btScalar( -0.05 ), btScalar( 0.05 ) } )
			{
				EXPECT_TRUE( test.world.attach( *cube, cube->massCentre() + btVector3( x, btScalar( 0.15 ), z ), *box ).ok() );
			}
		}
		joint = make( kind );
		joint->setJointFeedback( &feedback );
		test.world.addConstraint( joint.get() );
	}
	~Jointed() { test.world.removeConstraint( joint.get() ); }

	std::unique_ptr<btTypedConstraint> make( JointKind kind )
	{
		if ( kind == JointKind::Point )
		{
			return std::make_unique<btPoint2PointConstraint>( *box, btVector3( 0, btScalar( 0.1 ), 0 ) );
		}
		if ( kind == JointKind::Fixed )
		{
			return std::make_unique<btFixedConstraint>( *box, world, btTransform::getIdentity(), box->getWorldTransform() );
		}
		const btVector3 pivot( kind == JointKind::Crank ? btScalar( 0.5 ) : btScalar( 0 ), 0, 0 );
		auto hinge = std::make_unique<btHingeConstraint>( *box, pivot, btVector3( 0, 1, 0 ) );
		if ( kind != JointKind::Hinge )
		{
			hinge->enableAngularMotor( true, 2, 10 );
		}
		return hinge;
	}
};

std::string nameOfJointed( const testing::TestParamInfo<JointedCase>& given )
{
	static const char* const kNames[] = { "Point", "Hinge", "Motor", "Fixed", "Crank" };
	return std::string( given.param.elasticity == Elasticity::Explicit ? "Explicit" : "Implicit" ) + kNames[int( given.param.kind )];
}

class OnJoints : public testing::TestWithParam<JointedCase>
{};

INSTANTIATE_TEST_SUITE_P( Joints, OnJoints,
	testing::Values( JointedCase{ Elasticity::Explicit, JointKind::Point }, JointedCase{ Elasticity::Implicit, JointKind::Point },
		JointedCase{ Elasticity::Explicit, JointKind::Hinge }, JointedCase{ Elasticity::Implicit, JointKind::Hinge },
		JointedCase{ Elasticity::Explicit, JointKind::Motor }, JointedCase{ Elasticity::Implicit, JointKind::Motor },
		JointedCase{ Elasticity::Explicit, JointKind::Fixed }, JointedCase{ Elasticity::Implicit, JointKind::Fixed },
		JointedCase{ Elasticity::Explicit, JointKind::Crank }, JointedCase{ Elasticity::Implicit, JointKind::Crank } ),
	nameOfJointed );

TEST_P( OnJoints, CarryLoadsHeavierThanTheJointedBody )
{
	for ( const btScalar mass : { btScalar( 0.2 ), btScalar( 1 ), btScalar( 10 ) } )
	{
		SCOPED_TRACE( mass );
		Jointed scene( GetParam().elasticity, GetParam().kind, mass );
		scene.test.run( 120 );
		const btScalar turn = GetParam().kind == JointKind::Motor || GetParam().kind == JointKind::Crank ? btScalar( 2 ) : btScalar( 0 );
		btVector3 load( 0, 0, 0 );
		for ( int k = 0; k < 60; ++k )
		{
			scene.test.run( 1 );
			const btVector3 apart = scene.cube->massCentre() - scene.box->getWorldTransform().getOrigin();
			EXPECT_NEAR( apart.length(), 0.35, 0.005 );
			EXPECT_NEAR( scene.cube->angularVelocity().y(), turn, 0.3 );
			EXPECT_NEAR( scene.box->getAngularVelocity().y(), turn, 0.6 ); // 0.2 kg on 10 kg: it trembles about a free axis
			load += scene.feedback.m_appliedForceBodyA / 60;
		}
		// Bullet's iterations leave more on a crank than on a joint at the box.
		const btScalar weight = ( 10 + mass ) * 10, part = GetParam().kind == JointKind::Crank ? btScalar( 0.12 ) : btScalar( 0.02 );
		EXPECT_NEAR( load.y(), weight, weight * part ) << "the joint carries both";
	}
}

// A joint that is too weak for the load breaks.
TEST( OnJoint, BreaksUnderTheLoad )
{
	for ( const btScalar limit : { btScalar( 1 ), btScalar( 4 ) } ) // N s a step; the weight: 1.8
	{
		Jointed scene( Elasticity::Implicit, JointKind::Fixed, 1 );
		scene.joint->setBreakingImpulseThreshold( limit );
		scene.test.run( 60 );
		EXPECT_EQ( scene.joint->isEnabled(), limit > 2 );
		EXPECT_EQ( scene.box->getWorldTransform().getOrigin().y() > 4.9, limit > 2 );
	}
}

} // namespace
} // namespace pliant
