// Impacts of `pliant_experiments impacts`, each of which could add energy by a mechanism of its own.

#include "support/random_impacts.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace pliant::test {
namespace {

void expectNoGain( Ground ground, Elasticity elasticity, unsigned seed, float strain = 0.0f )
{
	const double most = strike( ground, elasticity, seed, strain );
	std::printf( "%s, seed %u: at most %.4f of the energy\n", kGroundNames[int( ground )], seed, most );
	EXPECT_LT( most, 1.001 ) << kGroundNames[int( ground )] << ", seed " << seed;
}

/// Friction acts at the centres of big nodes, half a body away from the contact, and angular momentum is restored by a rotation of the
/// bodies: a friction that did not see that rotation would accelerate it and add up to 7 % of the energy.
TEST( RandomImpacts, FrictionSeesTheRotationOfBodies )
{
	for ( const unsigned seed : { 142u, 469u, 599u, 755u } )
	{
		expectNoGain( Ground::Soft, Elasticity::Explicit, seed );
	}
}

/// Nodes of a compressed body are not split on contact, because their children may store more energy. This holds for a corner without
/// contact yet, for a body at its turning point, which must not pass for one at rest, and for impacts on soft bodies, whose nodes are not
/// predicted.
TEST( RandomImpacts, CompressedNodesAreNotSplit )
{
	expectNoGain( Ground::Box, Elasticity::Explicit, 880 );
	expectNoGain( Ground::Floor, Elasticity::Explicit, 3068 );
	expectNoGain( Ground::Soft, Elasticity::Explicit, 3146 );
}

/// Nodes that split by strain cannot wait until they are unstrained. The energy that their regions gain, up to 18 % of the initial one, and
/// the energy of children that are kept out of the floor (seed 2086) is subtracted.
TEST( RandomImpacts, SplitsByStrainAddNoEnergy )
{
	for ( const unsigned seed : { 30u, 203u, 280u, 2086u } )
	{
		expectNoGain( Ground::Floor, Elasticity::Explicit, seed, 0.02f );
	}
	expectNoGain( Ground::Box, Elasticity::Explicit, 48, 0.02f );
}

/// Cracks release the energy of links and split big nodes first; neither may add kinetic energy. A nearly collinear fragment must not be
/// spun about its axis (RigidMotionProxy).
TEST( RandomImpacts, BreakingAddsNoEnergy )
{
	const double crumbs = shatter( Ground::Soft, Elasticity::Explicit, BreakRule::Plane, 2, 69 ).most;
	std::printf( "soft cube, seed 69: at most %.4f of the energy\n", crumbs );
	EXPECT_LT( crumbs, 1.001 );
	int broken = 0;
	for ( const Ground ground : { Ground::Floor, Ground::Box, Ground::SoftWithLevels } )
	{
		for ( const BreakRule rule : { BreakRule::Distance, BreakRule::Plane, BreakRule::Shards } )
		{
			for ( unsigned seed = 0; seed < 12; ++seed )
			{
				const Shattered shattered = shatter(
					ground, seed % 4 == 3 ? Elasticity::Implicit : Elasticity::Explicit, rule, int( seed % 3 ), seed );
				EXPECT_LT( shattered.most, 1.001 ) << kGroundNames[int( ground )] << ", seed " << seed;
				broken += shattered.hasBroken ? 1 : 0;
			}
		}
	}
	std::printf( "%d of 108 have broken\n", broken );
	EXPECT_GT( broken, 12 );
}

/// Five contacts of one stiff spinning body, each of which would bounce off its initial velocity: together they would add more than the
/// body's energy, and half of their impulses still would.
TEST( RandomImpacts, BouncesThatAddEnergyAreReduced )
{
	expectNoGain( Ground::Box, Elasticity::Implicit, 275 );
}

} // namespace
} // namespace pliant::test
