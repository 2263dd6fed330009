// Levels of detail where a body hits something.

#include "adaptive_bodies.h"

#include <cstdio>

namespace pliant {
namespace {

using test::block;
using test::levels;
using test::stiff;
using test::TestWorld;

/// A stiff block of big nodes fell on a corner and split when its balls had touched: the cells at the corners, which no ball had stood for, were
/// born inside the floor, and Bullet shot them out at depth erp / h, with fifteen substeps at metres a second. It flew up to five times as high
/// as it had come from.
TEST( AdaptiveImpact, WhatSplitsOnTheFloorIsNotShotUp )
{
	const btQuaternion onCorner( btVector3( 1, 0, -1 ).normalized(), btScalar( 0.9 ) );
	for ( const float modulus : { 1e7f, 1e8f } )
	{
		TestWorld test;
		test.addFloor();
		Adaptivity settings = levels( 2 );
		settings.refinesOnContact = true;
		SoftBody* soft = test.addSoft( block( 8, 8, 8, 0.1f ), btTransform( onCorner, btVector3( 0, btScalar( 1.2 ), 0 ) ), stiff( modulus ), settings );
		const btScalar start = soft->massCentre().y(), gravity = -test.world.getGravity().y();
		int splits = 0;
		btScalar highest = 0; // m, by what it has of energy
		for ( int frame = 0; frame < 90; ++frame )
		{
			test.run( 1 );
			splits += test.world.stepReport().splits;
			btScalar energy = 0;
			for ( int i = 0; i < soft->nodeCount(); ++i )
			{
				energy += soft->nodeMass( i ) * ( btScalar( 0.5 ) * soft->nodeVelocity( i ).length2() + gravity * soft->nodePosition( i ).y() );
			}
			highest = btMax( highest, energy / ( soft->mass() * gravity ) );
		}
		EXPECT_GT( splits, 0 );
		std::printf( "E %g: %.4f of the start\n", double( modulus ), double( highest / start ) );
		EXPECT_LT( highest, start * btScalar( 1.01 ) ) << "E " << modulus;
	}
}

} // namespace
} // namespace pliant
