// Heaps of nearly incompressible bodies.

#include "pliant/soft_body_world.h"
#include "support/test_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

namespace pliant {
namespace {

constexpr float kMostVolumeKeeping = 24.5f; // Poisson's ratio 0.49

// Six cubes fall on each other, hit by a ball of 500 kg; of the default modulus, soft, and stiffer than the explicit step reaches.
TEST( ImplicitRubber, InAHeapComesToRest )
{
	for ( const Elasticity elasticity : { Elasticity::Automatic, Elasticity::Explicit } )
	{
		for ( const float modulus : { 0.0f, 2e4f, 1e8f } )
		{
			test::SoftWorld scene;
			scene.addBoxFloor();
			Material material;
			material.volumeKeeping = kMostVolumeKeeping;
			material.youngsModulus = modulus;
			material.elasticity = elasticity;
			const auto cube = test::cubeTemplate( 0.5f, 6 );
			for ( int i = 0; i < 6; ++i )
			{
				const btQuaternion turn( btVector3( 1, btScalar( 0.3 ), 0 ).normalized(), btScalar( 0.4 * i ) );
				ASSERT_TRUE( scene.add( cube,
					btVector3( btScalar( 0.05 * ( i % 2 ) ), btScalar( 0.6 + 0.6 * i ), btScalar( 0.04 * ( i % 3 ) ) ), material, turn ) );
			}
			scene.add( 500, new btSphereShape( btScalar( 0.3 ) ), btVector3( -4, btScalar( 0.6 ), 0 ) )
				->setLinearVelocity( btVector3( 6, 0, 0 ) );
			double fastest = 0.0;
			for ( int frame = 0; frame < 900; ++frame )
			{
				scene.step( 1 );
				for ( const auto& body : scene.soft )
				{
					for ( int i = 0; i < body->nodeCount(); ++i )
					{
						fastest = std::max( fastest, double( body->nodeVelocity( i ).length() ) );
					}
				}
			}
			const auto isAwake = []( const auto& body ) { return body->isActive(); };
			const auto awake = std::count_if( scene.soft.begin(), scene.soft.end(), isAwake );
			std::printf( "%s, %.0e Pa: %.1f m/s at most, %d awake after 15 s\n",
				elasticity == Elasticity::Explicit ? "explicit" : "automatic", double( modulus ), fastest, int( awake ) );
			EXPECT_LT( fastest, 15.0 ); // they fall at 8 m/s
			EXPECT_EQ( awake, 0 );
		}
	}
}

} // namespace
} // namespace pliant
