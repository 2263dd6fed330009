// Bars that strike the floor break about as much with coarse levels as without.

#include "support/breaking_drops.h"
#include "world/test_world.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr unsigned kDrops = 2;

int linksOnLevels( const test::Drop& drop, int levels )
{
	test::Drop onLevels = drop;
	onLevels.coarseLevels = levels;
	int links = 0;
	for ( unsigned seed = 0; seed < kDrops; ++seed )
	{
		links += test::linksBrokenBy( onLevels, seed );
	}
	return links;
}

// Coarse nodes notice strain after the wave has passed: bodies on two levels broke .06 to .97 of the links of the uniform lattice in
// explicit steps, until nodes were split before an impact that may break them. An event of a uniform body discarded what the implicit step
// needs to keep its vibrations for the rest of the game step, so that bodies on levels broke up to ten times as much.
TEST( BreakingDrops, BreakAlikeOnLevels )
{
	const test::Drop drops[] = { { Elasticity::Explicit, BreakRule::Plane, 0.1f }, { Elasticity::Explicit, BreakRule::Plane, 0.2f },
		{ Elasticity::Explicit, BreakRule::Distance, 0.2f }, { Elasticity::Implicit, BreakRule::Plane, 0.2f },
		{ Elasticity::Implicit, BreakRule::Distance, 0.2f } };
	for ( const test::Drop& drop : drops )
	{
		const int uniform = linksOnLevels( drop, 0 );
		EXPECT_GT( uniform, 5000 );
		for ( const int levels : { 1, 2 } )
		{
			EXPECT_NEAR( linksOnLevels( drop, levels ), uniform, 0.25 * uniform )
				<< int( drop.elasticity ) << int( drop.rule ) << drop.breakStrain << levels;
		}
	}
}

/// Nothing breaks by itself; what is cut off with up to eight cells is rigid.
Fracture rigidCrumbs()
{
	Fracture fracture;
	fracture.smallCells = 8;
	fracture.smallPieces = SmallPieces::Rigid;
	return fracture;
}

/// A bar on so many levels in the middle of an impact in implicit steps: the energy of its motion against its centre of mass, J.
double energyInImpact( int coarseLevels, bool isCut )
{
	test::SoftWorld world;
	world.addBoxFloor();
	Material material;
	material.density = 300.0f;
	material.youngsModulus = 3e4f;
	material.elasticity = Elasticity::Implicit;
	Adaptivity levels;
	levels.coarseLevels = coarseLevels;
	SoftBody* const body = world.add( test::fallingBar(), btVector3( 0, btScalar( 0.45 ), 0 ), material,
		btQuaternion( btVector3( 1, 2, 3 ).normalized(), btScalar( 0.7 ) ), levels );
	EXPECT_TRUE( body->setFracture( rigidCrumbs() ).ok() );
	EXPECT_TRUE( body->setVelocities( btVector3( 0, -8, 0 ), btVector3( 0, 0, 0 ) ).ok() );
	for ( int frame = 0; frame < 5; ++frame )
	{
		if ( isCut && frame == 3 )
		{
			EXPECT_GT( body->cutSphere( body->nodePosition( body->nodeCount() - 1 ), btScalar( 0.02 ) ), 0 );
		}
		world.step( 1 );
	}
	double energy = 0.0;
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		energy += 0.5 * double( body->nodeMass( i ) * ( body->nodeVelocity( i ) - body->linearVelocity() ).length2() );
	}
	return energy;
}

// Of 100 J, 77 were left after a single link of a uniform body had broken in the middle of its impact.
TEST( BreakingDrops, CrumbsOfImplicitBodiesLeaveTheRestItsVibrations )
{
	for ( const int coarseLevels : { 0, 2 } )
	{
		const double whole = energyInImpact( coarseLevels, false );
		EXPECT_GT( whole, 20.0 ); // J
		EXPECT_NEAR( energyInImpact( coarseLevels, true ), whole, 0.03 * whole ) << coarseLevels;
	}
}

// The pieces stepped explicitly with the implicit body's unbounded alpha until the next step, and flew apart at 1e5 m/s.
TEST( BreakingDrops, SmallRigidPiecesOfImplicitBodiesComeOffAtRest )
{
	test::TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = test.addSoft( test::block( 4, 4, 4, 0.1f ), test::at( 0, 0, 0 ), test::implicit( 1e8f ) );
	ASSERT_TRUE( body->setFracture( rigidCrumbs() ).ok() );
	test.run( 5 );
	ASSERT_TRUE( body->applyCentralImpulse( body->mass() * btVector3( 1, 0, 0 ) ).ok() );
	ASSERT_TRUE( body->applyImpulse( btVector3( 0, 1, 0 ), 0 ).ok() ); // strains the corner
	test.run( 1 );
	ASSERT_GT( body->cutPlane( btVector3( -0.1f, -0.1f, -0.1f ), btVector3( 1, 1, 1 ) ), 0 );
	for ( int frame = 0; frame < 10; ++frame )
	{
		test.run( 1 );
		ASSERT_EQ( test.world.stepReport().quarantined, 0 );
	}
	ASSERT_GT( test.world.softBodyCount(), 1 );
	for ( int i = 0; i < test.world.softBodyCount(); ++i )
	{
		EXPECT_LT( test.world.softBody( i )->linearVelocity().length(), 3 );
	}
}

// They stepped explicitly in four substeps, and their whole island with them: a vase that broke took up to three times as long.
TEST( BreakingDrops, SmallRigidPiecesOfImplicitBodiesNeedNoSubsteps )
{
	for ( const bool isFloor : { false, true } )
	{
		test::TestWorld test;
		if ( isFloor )
		{
			test.addPlane()->setFriction( btScalar( 0.6 ) );
		}
		else
		{
			test.world.setGravity( btVector3( 0, 0, 0 ) );
		}
		SoftBody* const body = test.addSoft( test::block( 6, 2, 2, 0.1f ), test::at( 0, 1, 0 ), test::implicit( 1e8f ) );
		ASSERT_TRUE( body->setFracture( rigidCrumbs() ).ok() );
		ASSERT_TRUE( body->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, 3, 9 ) ).ok() );
		ASSERT_GT( body->cutPlane( btVector3( btScalar( 0.1 ), 1, 0 ), btVector3( 1, 0, 0 ) ), 0 );
		test.run( 1 );
		ASSERT_EQ( test.world.softBodyCount(), 2 );
		const SoftBody* const piece = test.world.softBody( 1 );
		ASSERT_EQ( piece->material().method, Method::SingleCluster );
		const btScalar spin = piece->angularVelocity().length();
		for ( int frame = 0; frame < 300; ++frame )
		{
			test.run( 1 );
			ASSERT_EQ( test.world.stepReport().substeps, 1 );
			ASSERT_TRUE( piece->isHealthy() );
			if ( !isFloor && frame == 60 )
			{
				EXPECT_NEAR( piece->angularVelocity().length(), spin, 0.03 * spin );
			}
		}
		if ( isFloor )
		{
			EXPECT_NEAR( piece->massCentre().y(), 0.1, 0.02 ); // on one of its faces
			EXPECT_FALSE( piece->isActive() );
		}
	}
}

} // namespace
} // namespace pliant
