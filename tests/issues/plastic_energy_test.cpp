// Plastic flow adds no energy, for any settings.

#include "support/explicit_material.h"
#include "support/plastic_scenes.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

Material clay( float limit )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = 2e4f;
	material.yieldStrain = 0.02f;
	material.plasticLimit = limit;
	return material;
}

// A plastic cube with the largest allowed change of rest shape, dropped from .3 m: it must stop flowing and come to rest.
TEST( PlasticEnergy, ADroppedCubeComesToRestAtAnyLimit )
{
	for ( const float limit : { 1.8f, 2.0f } )
	{
		for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
		{
			test::PlasticScene scene;
			scene.material = clay( limit );
			scene.material.elasticity = elasticity;
			const test::PlasticEnergy energy = test::run( scene, 6 );
			std::printf( "limit %.1f, %s: brought %.0f J, at most %.0f, in the last second %.2g\n", double( limit ),
				elasticity == Elasticity::Implicit ? "implicit" : "explicit", energy.brought, energy.most, energy.last );
			EXPECT_LT( energy.most, energy.brought );
			EXPECT_LT( energy.last, 1e-4 * energy.brought );
		}
	}
}

TEST( PlasticEnergy, RestsInSpaceAsItWasMade )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		test::PlasticScene scene;
		scene.material = clay( 2.0f );
		scene.material.elasticity = elasticity;
		scene.isDropped = false;
		scene.speed = 0.0;
		EXPECT_LT( test::run( scene, 5 ).most, 1e-6 );
	}
}

TEST( PlasticEnergy, CornersOfTheSettings )
{
	for ( unsigned seed = 0; seed < 8; ++seed )
	{
		const test::PlasticScene scene = test::plasticScene( seed );
		const test::PlasticEnergy energy = test::run( scene, 2 );
		EXPECT_TRUE( energy.isHealthy ) << seed;
		EXPECT_LT( energy.most, test::mostFraction( scene ) * energy.brought ) << seed;
	}
}

// Of four hundred corners these gained energy: a shaken cube .03 of it, whose vibrations after the blow were not damped; and a dropped one
// a thousand times it, crushed by its weight, with more damping than is stable there.
TEST( PlasticEnergy, ShakenAndCrushedCubesGainNone )
{
	for ( const unsigned seed : { 39u, 340u } )
	{
		const test::PlasticScene scene = test::plasticScene( seed );
		const test::PlasticEnergy energy = test::run( scene, 4 );
		EXPECT_TRUE( energy.isHealthy ) << seed;
		EXPECT_LT( energy.most, test::mostFraction( scene ) * energy.brought ) << seed;
	}
}

// An elastic cube at the largest stable alpha, with volume keeping and full wobble damping, gained two thousand times the energy of its
// fall at its first touch: the two together were beyond the limit of the explicit step (largestWobbleFraction).
TEST( PlasticEnergy, WobbleDampingIsStableBesideVolumeKeeping )
{
	for ( const float volumeKeeping : { 0.3f, 0.5f, 2.0f } )
	{
		for ( const float damping : { 0.0f, 1e3f } )
		{
			test::PlasticScene scene;
			scene.material.youngsModulus = 1e7f;
			scene.material.regionHalfWidth = 2;
			scene.material.volumeKeeping = volumeKeeping;
			scene.material.damping = damping;
			scene.material.wobbleDamping = 1.0f;
			const test::PlasticEnergy energy = test::run( scene, 2 );
			EXPECT_TRUE( energy.isHealthy );
			EXPECT_LT( energy.most, energy.brought );
			EXPECT_LT( energy.last, 1e-4 * energy.brought );
		}
	}
}

} // namespace
} // namespace pliant
