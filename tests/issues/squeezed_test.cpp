// A body squeezed flatter than the width of its nodes returns no more energy than was put in.

#include "support/squeezes.h"
#include "test_meshes.h"
#include "twin_worlds.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace pliant {
namespace {

void expectBounded( const test::Squeeze& how )
{
	const test::Squeezed squeezed = test::squeeze( how );
	EXPECT_TRUE( squeezed.isHealthy );
	EXPECT_LT( squeezed.late, 1.5 * squeezed.early + 1.0 );
	EXPECT_LT( squeezed.motion, squeezed.strain + squeezed.out );
}

// A press squeezes a soft cube to .09 m above the floor, less than its nodes' width of .1 m, waits for some seconds and rises. The released
// energy must not exceed what the springs can store, and must not grow with the waiting time.
TEST( Squeezed, ByAPlateNearerToTheFloorThanANodeIsWide )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		test::Squeeze how;
		how.elasticity = elasticity;
		expectBounded( how );
	}
	test::Squeeze stiff;
	stiff.elasticity = Elasticity::Implicit;
	stiff.youngsModulus = 1e7;
	stiff.gap = 0.06;
	stiff.seconds = 2.0;
	expectBounded( stiff );
}

// The same cube is created between two walls .32 m apart: contact impulses must not grow without bound.
TEST( Squeezed, InASlotBetweenTwoWalls )
{
	for ( const double gap : { 0.32, 0.09 } )
	{
		test::Squeeze how;
		how.isSlot = true;
		how.gap = gap;
		how.elasticity = Elasticity::Implicit;
		how.seconds = 2.0;
		expectBounded( how );
	}
}

TEST( Squeezed, WithLevelsAndPlastic )
{
	test::Squeeze levels;
	levels.elasticity = Elasticity::Implicit;
	levels.coarseLevels = 1;
	levels.seconds = 2.0;
	expectBounded( levels );
	test::Squeeze plastic;
	plastic.elasticity = Elasticity::Implicit;
	plastic.yieldStrain = 0.05f;
	plastic.seconds = 2.0;
	expectBounded( plastic );
}

// Nine stiff sticks in three layers are crushed to less than half of their height, and released. Each step was linear in displacements of
// more than a cell: pieces of a plank under two hands reached 95 m/s, and these sticks 207 m/s, 122 at the end.
TEST( Squeezed, SticksThatAPlateCrushesComeToRest )
{
	test::TestWorld t;
	t.addPlane()->setFriction( btScalar( 0.6 ) );
	LatticeSettings settings;
	settings.cellSize = 0.02f;
	const auto stick = BodyTemplate::build( test::makeBox( { -0.1, -0.02, -0.02 }, { 0.1, 0.02, 0.02 } ).view(), settings ).value;
	Material wood;
	wood.youngsModulus = 2e7f;
	wood.density = 600.0f;
	wood.elasticity = Elasticity::Implicit;
	for ( int k = 0; k < 9; ++k )
	{
		const bool isAcross = k / 3 == 1;
		const btScalar aside = btScalar( 0.09 * ( k % 3 - 1 ) ), turn = btScalar( 0.05 * ( k % 5 ) + ( isAcross ? SIMD_HALF_PI : 0.0 ) );
		const btVector3 at( isAcross ? aside : 0, btScalar( 0.022 + 0.043 * ( k / 3 ) ), isAcross ? 0 : aside );
		t.addSoft( stick, btTransform( btQuaternion( btVector3( 0, 1, 0 ), turn ), at ), wood )->setFriction( btScalar( 0.6 ) );
	}
	constexpr double kPlate = 0.05; // m, half of its thickness
	double bottom = 0.18;
	btRigidBody* const plate = t.addBox(
		0, btVector3( btScalar( 0.3 ), btScalar( kPlate ), btScalar( 0.3 ) ), test::at( 0, btScalar( bottom + kPlate ), 0 ) );
	plate->setCollisionFlags( btCollisionObject::CF_KINEMATIC_OBJECT );
	plate->setActivationState( DISABLE_DEACTIVATION );
	double most = 0.0, now = 0.0;
	for ( int frame = 0; frame < 240; ++frame )
	{
		bottom = frame < 150 ? std::max( 0.06, bottom - 0.005 ) : bottom + 0.02;
		plate->setWorldTransform( test::at( 0, btScalar( bottom + kPlate ), 0 ) );
		t.run( 1 );
		now = 0.0;
		for ( const auto& body : t.soft )
		{
			EXPECT_TRUE( body->isHealthy() );
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				now = std::max( now, double( body->nodeVelocity( i ).length() ) );
			}
		}
		most = std::max( most, now );
	}
	EXPECT_LT( most, 40.0 ); // m/s; measured: 15, and 0 at the end
	EXPECT_LT( now, 1.0 );
}

} // namespace
} // namespace pliant
