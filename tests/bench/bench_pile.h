#pragma once

// A heap of soft and rigid bodies for benchmarks.

#include "support/explicit_material.h"
#include "support/test_world.h"

namespace pliant::test {

/// Twenty soft cubes of 216 nodes and fifty rigid boxes in a heap.
inline void fillPile( SoftWorld& scene, Elasticity elasticity )
{
	scene.addBoxFloor();
	const auto cube = cubeTemplate( 0.6f, 6 );
	Material material = test::explicitMaterial();
	material.youngsModulus = 3e4f;
	material.elasticity = elasticity;
	for ( int i = 0; i < 20; ++i )
	{
		scene.add( cube, btVector3( btScalar( 0.35 * ( i % 3 ) ), btScalar( 0.5 + 0.7 * i ), btScalar( 0.3 * ( i % 4 ) ) ), material );
	}
	for ( int i = 0; i < 50; ++i )
	{
		const btScalar half = btScalar( 0.12 );
		scene.add( 10, new btBoxShape( btVector3( half, half, half ) ),
			btVector3( btScalar( 0.3 * ( i % 5 ) - 0.4 ), btScalar( 1 + 0.3 * i ), btScalar( 0.2 * ( i % 7 ) - 0.4 ) ) );
	}
	scene.step( 150 );
}

} // namespace pliant::test
