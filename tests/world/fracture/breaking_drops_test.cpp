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

// Cells near a big node, and cells that have just been split, must be allowed to break within the short time of an impact. Otherwise two
// levels would break a quarter of the links of the uniform lattice at a strain of .1, and a fourteenth at .2.
TEST( BreakingDrops, LevelsHardlyReduceBreaking )
{
	for ( const float strain : { 0.1f, 0.2f } )
	{
		const test::Drop drop{ Elasticity::Explicit, BreakRule::Plane, strain };
		const int uniform = linksOnLevels( drop, 0 );
		EXPECT_GT( uniform, 5000 );
		EXPECT_GT( linksOnLevels( drop, 1 ), 0.65 * uniform ) << strain;
		EXPECT_GT( linksOnLevels( drop, 2 ), ( strain < 0.15f ? 0.65 : 0.25 ) * uniform ) << strain;
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
