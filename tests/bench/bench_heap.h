#pragma once

// A heap of rigid boxes for benchmarks of soft bodies in company, and the time of a frame.

#include "support/test_world.h"

#include <chrono>

namespace pliant::test {

/// Boxes of 8 kg and .4 m that fall as a block, `wide` by `deep` of them in a layer, each layer a little aside.
template <class World>
void addBoxes( World& scene, int count, int wide, int deep )
{
	const btScalar half = btScalar( 0.2 );
	for ( int k = 0; k < count; ++k )
	{
		const int x = k % wide, z = k / wide % deep, y = k / ( wide * deep );
		scene.add( 8, new btBoxShape( btVector3( half, half, half ) ),
			btVector3( btScalar( 0.42 * x + 0.03 * ( y % 3 ) ), btScalar( 0.25 + 0.45 * y ), btScalar( 0.42 * z + 0.02 * ( y % 2 ) ) ) );
	}
}

/// Steps a frame; returns the time it took, ms.
template <class World>
double timeOfFrame( World& scene )
{
	const auto begin = std::chrono::steady_clock::now();
	scene.step( 1 );
	return std::chrono::duration<double, std::milli>( std::chrono::steady_clock::now() - begin ).count();
}

} // namespace pliant::test
