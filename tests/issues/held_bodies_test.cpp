// Soft bodies with Bullet's static or kinematic flag are held as a whole, and do not affect the contacts of other bodies in the world.

#include "twin_worlds.h"

namespace pliant {
namespace {

using test::at;
using test::kFrame;
using test::RigidScene;

class HeldBodies : public testing::TestWithParam<Elasticity>
{
protected:
	HeldBodies()
	{
		m_own.addFloor();
		m_cube = m_own.addSoft( test::cubeTemplate( 1, 6 ), at( 0, btScalar( 0.5 ), 0 ), test::stepping( GetParam(), 1e5f ) );
	}
	void hold( int flag )
	{
		const int others = m_cube->getCollisionFlags() & ~( btCollisionObject::CF_STATIC_OBJECT | btCollisionObject::CF_KINEMATIC_OBJECT );
		m_cube->setCollisionFlags( others | flag );
	}
	test::TestWorld m_own;
	SoftBody* m_cube = nullptr;
};

INSTANTIATE_TEST_SUITE_P( Steps, HeldBodies, testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& with ) { return with.param == Elasticity::Explicit ? "Explicit" : "Implicit"; } );

TEST_P( HeldBodies, DoNotAffectOtherContacts )
{
	btRigidBody* const far = m_own.addBox(
		10, btVector3( btScalar( 0.3 ), btScalar( 0.3 ), btScalar( 0.3 ) ), at( 4, btScalar( 0.3 ), 0 ) );
	SoftBody* const other = m_own.addSoft(
		test::cubeTemplate( 0.5f, 4 ), at( -3, btScalar( 0.25 ), 0 ), test::stepping( GetParam(), 1e5f ) );
	m_own.run( 10 );
	for ( const int flag : { int( btCollisionObject::CF_KINEMATIC_OBJECT ), int( btCollisionObject::CF_STATIC_OBJECT ), 0 } )
	{
		hold( flag );
		far->activate( true );
		other->activate( true );
		m_own.run( 60 );
		EXPECT_NEAR( far->getWorldTransform().getOrigin().y(), 0.3, 0.02 );
		EXPECT_NEAR( other->massCentre().y(), 0.25, 0.02 );
		EXPECT_NEAR( m_cube->massCentre().y(), 0.5, 0.07 ); // it sags under its weight
	}
}

TEST_P( HeldBodies, CarryFallingBodies )
{
	hold( btCollisionObject::CF_STATIC_OBJECT );
	EXPECT_TRUE( m_cube->teleport( at( 0, 2, 0 ) ).ok() );
	btRigidBody* const box = m_own.addBox(
		200, btVector3( btScalar( 0.3 ), btScalar( 0.3 ), btScalar( 0.3 ) ), at( 0, btScalar( 3.5 ), 0 ) );
	SoftBody* const ball = m_own.addSoft(
		test::cubeTemplate( 0.3f, 3 ), at( btScalar( 0.1 ), btScalar( 4.5 ), 0 ), test::stepping( GetParam(), 1e5f ) );
	m_own.run( 180 );
	EXPECT_NEAR( m_cube->massCentre().y(), 2.5, 1e-4 );
	EXPECT_NEAR( box->getWorldTransform().getOrigin().y(), 3.3, 0.06 );
	EXPECT_GT( ball->massCentre().y(), 3.6 );
	hold( 0 );
	m_cube->activate( true );
	m_own.run( 120 );
	EXPECT_LT( m_cube->massCentre().y(), 0.7 ); // it falls again
}

// A soft lift, moved by `teleport` at a centimetre per frame.
TEST_P( HeldBodies, LiftBodiesOnThem )
{
	hold( btCollisionObject::CF_KINEMATIC_OBJECT );
	btRigidBody* const box = m_own.addBox(
		50, btVector3( btScalar( 0.3 ), btScalar( 0.3 ), btScalar( 0.3 ) ), at( 0, btScalar( 1.3 ), 0 ) );
	m_own.run( 60 );
	const btScalar from = box->getWorldTransform().getOrigin().y();
	for ( int k = 0; k < 100; ++k )
	{
		EXPECT_TRUE( m_cube->teleport( at( 0, btScalar( 0.01 ), 0 ) ).ok() );
		m_own.run( 1 );
	}
	EXPECT_NEAR( box->getWorldTransform().getOrigin().y() - from, 1, 0.03 );
}

// The game controls its shape too: nodes are driven one by one.
TEST_P( HeldBodies, BendAsTheGameDrivesThem )
{
	hold( btCollisionObject::CF_KINEMATIC_OBJECT );
	const int node = m_cube->nearestNode( btVector3( 0, 1, 0 ) );
	const btVector3 from = m_cube->nodePosition( node ),
					beside = m_cube->nodePosition( m_cube->nearestNode( btVector3( btScalar( 0.5 ), 1, 0 ) ) );
	for ( int k = 1; k <= 10; ++k )
	{
		ASSERT_TRUE( m_cube->driveNode( node, from + btVector3( 0, btScalar( 0.01 * k ), 0 ) ).ok() );
		m_own.run( 1 );
		EXPECT_NEAR( m_cube->nodePosition( node ).y() - from.y(), 0.01 * k, 1e-5 );
		EXPECT_NEAR( m_cube->nodeVelocity( node ).y(), k > 1 ? 0.6 : 0.0, 1e-3 );
	}
	EXPECT_EQ( m_cube->nodePosition( m_cube->nearestNode( beside ) ).y(), beside.y() );
}

} // namespace
} // namespace pliant
