#pragma once

#include "support/test_world.h"

namespace pliant::test {

/// Stacks `count` boxes of `edge` x `height` x `edge`, m, on the plane y = 0, from the lowest to the highest.
inline std::vector<SoftBody*> addStack(
	SoftWorld& world, int count, float edge, float height, float cell, const Material& material, const Adaptivity& adaptivity = {} )
{
	const auto shape = boxTemplate( { edge, height, edge }, cell );
	std::vector<SoftBody*> boxes;
	for ( int k = 0; k < count; ++k )
	{
		const btVector3 centre( 0, btScalar( height ) * ( btScalar( k ) + btScalar( 0.5 ) ), 0 );
		boxes.push_back( world.add( shape, centre, material, btQuaternion::getIdentity(), adaptivity ) );
	}
	return boxes;
}

} // namespace pliant::test
