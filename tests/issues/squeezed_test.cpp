// A body squeezed flatter than the width of its nodes returns no more energy than was put in.

#include "support/squeezes.h"
#include "test_meshes.h"
#include "twin_worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

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

/// Motion of what a plate crushes and releases, m/s.
struct Crushed
{
	double most = 0.0, last = 0.0; ///< of the fastest node, ever and at the end
};

/// Nine sticks in three layers, crushed to less than half of their height by a plate that moves at .3 m/s, and released after 2.5 s.
Crushed crushSticks( const Material& material )
{
	test::TestWorld t;
	t.addPlane()->setFriction( btScalar( 0.6 ) );
	LatticeSettings settings;
	settings.cellSize = 0.02f;
	const auto stick = BodyTemplate::build( test::makeBox( { -0.1, -0.02, -0.02 }, { 0.1, 0.02, 0.02 } ).view(), settings ).value;
	for ( int k = 0; k < 9; ++k )
	{
		const bool isAcross = k / 3 == 1;
		const btScalar aside = btScalar( 0.09 * ( k % 3 - 1 ) ), turn = btScalar( 0.05 * ( k % 5 ) + ( isAcross ? SIMD_HALF_PI : 0.0 ) );
		const btVector3 at( isAcross ? aside : 0, btScalar( 0.022 + 0.043 * ( k / 3 ) ), isAcross ? 0 : aside );
		t.addSoft( stick, btTransform( btQuaternion( btVector3( 0, 1, 0 ), turn ), at ), material )->setFriction( btScalar( 0.6 ) );
	}
	constexpr double kPlate = 0.05; // m, half of its thickness
	double bottom = 0.18;
	btRigidBody* const plate = t.addBox(
		0, btVector3( btScalar( 0.3 ), btScalar( kPlate ), btScalar( 0.3 ) ), test::at( 0, btScalar( bottom + kPlate ), 0 ) );
	plate->setCollisionFlags( btCollisionObject::CF_KINEMATIC_OBJECT );
	plate->setActivationState( DISABLE_DEACTIVATION );
	Crushed crushed;
	for ( int frame = 0; frame < 300; ++frame )
	{
		bottom = frame < 150 ? std::max( 0.06, bottom - 0.005 ) : bottom + 0.02;
		plate->setWorldTransform( test::at( 0, btScalar( bottom + kPlate ), 0 ) );
		t.run( 1 );
		crushed.last = 0.0;
		for ( const auto& body : t.soft )
		{
			EXPECT_TRUE( body->isHealthy() );
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				crushed.last = std::max( crushed.last, double( body->nodeVelocity( i ).length() ) );
			}
		}
		crushed.most = std::max( crushed.most, crushed.last );
	}
	return crushed;
}

// Each step was linear in displacements of more than a cell: pieces of a plank under two hands reached 95 m/s, and these sticks of 2e7 Pa
// 207 m/s, 122 at the end, and without numerical damping 87 km/s.
TEST( Squeezed, SticksThatAPlateCrushesComeToRest )
{
	for ( const float youngsModulus : { 2e5f, 2e7f } )
	{
		for ( const float numericalDamping : { 1.0f, 0.0f } )
		{
			Material material;
			material.youngsModulus = youngsModulus;
			material.density = 600.0f;
			material.elasticity = Elasticity::Implicit;
			material.numericalDamping = numericalDamping;
			const Crushed crushed = crushSticks( material );
			std::printf( "sticks of %.0e Pa, numerical damping %.0f: up to %.1f m/s, %.2f at the end\n", double( youngsModulus ),
				double( numericalDamping ), crushed.most, crushed.last );
			EXPECT_LT( crushed.most, 40.0 );
			EXPECT_LT( crushed.last, 1.0 );
		}
	}
}

} // namespace
} // namespace pliant
