// Nothing sinks into a soft body, thanks to the second layer of spheres (docs/design/contacts.md). With the outermost layer alone each of
// these tests fails.

#include "bench/bench_pile.h"
#include "support/explicit_material.h"

#include "world/bodies/soft_body_impl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

namespace pliant::test {
namespace {

/// Counts the nodes of `a` whose centre is within half of the summed radii of one of `b`.
int nodesInside( const SoftBody& a, const SoftBody& b )
{
	int inside = 0;
	for ( int i = 0; i < a.nodeCount(); ++i )
	{
		bool isIn = false;
		for ( int k = 0; !isIn && k < b.nodeCount(); ++k )
		{
			isIn = a.nodePosition( i ).distance( b.nodePosition( k ) ) < btScalar( 0.5 ) * ( a.nodeRadius( i ) + b.nodeRadius( k ) );
		}
		inside += isIn ? 1 : 0;
	}
	return inside;
}

/// Counts the nodes whose centre lies in a box.
int nodesInside( const SoftBody& soft, const btRigidBody& box )
{
	const btVector3 half = static_cast<const btBoxShape*>( box.getCollisionShape() )->getHalfExtentsWithMargin();
	int inside = 0;
	for ( int i = 0; i < soft.nodeCount(); ++i )
	{
		const btVector3 p = box.getWorldTransform().inverse() * soft.nodePosition( i );
		inside += btFabs( p.x() ) < half.x() && btFabs( p.y() ) < half.y() && btFabs( p.z() ) < half.z() ? 1 : 0;
	}
	return inside;
}

// 20 soft cubes of 3e4 Pa and 50 boxes, 2.4 cells wide, dropped in a heap. With one layer 194 nodes would be in other bodies and 99 in
// boxes.
TEST( Sinking, NothingSinksInAHeap )
{
	SoftWorld scene;
	fillPile( scene, Elasticity::Explicit );
	int inBodies = 0, inBoxes = 0;
	for ( int a = 0; a < scene.world.softBodyCount(); ++a )
	{
		const SoftBody& soft = *scene.world.softBody( a );
		for ( int b = 0; b < scene.world.softBodyCount(); ++b )
		{
			inBodies += a == b ? 0 : nodesInside( soft, *scene.world.softBody( b ) );
		}
		for ( int k = 0; k < scene.world.getNumCollisionObjects(); ++k )
		{
			const btRigidBody* const box = btRigidBody::upcast( scene.world.getCollisionObjectArray()[k] );
			inBoxes += box && box->getInvMass() > 0 ? nodesInside( soft, *box ) : 0;
		}
	}
	std::printf( "nodes in other bodies %d, in boxes %d\n", inBodies, inBoxes );
	EXPECT_EQ( inBodies, 0 );
	EXPECT_LE( inBoxes, 4 ) << "of 4 320";
}

// A box of ten times the mass falls on soft foam and presses it flat. With one layer 16 and 20 nodes would be in it afterwards.
TEST( Sinking, AHeavyBoxDoesNotSink )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		SoftWorld scene;
		scene.addBoxFloor();
		Material material = test::explicitMaterial();
		material.youngsModulus = 3e4f;
		material.elasticity = elasticity;
		SoftBody* const foam = scene.add( cubeTemplate( 0.6f, 6 ), btVector3( 0, btScalar( 0.3 ), 0 ), material );
		const btVector3 half( btScalar( 0.15 ), btScalar( 0.15 ), btScalar( 0.15 ) );
		const btRigidBody* const box = scene.add(
			btScalar( 10 * foam->impl().mass ), new btBoxShape( half ), btVector3( 0, btScalar( 1.2 ), 0 ) );
		scene.step( 240 );
		EXPECT_EQ( nodesInside( *foam, *box ), 0 );
	}
}

// Cubes of 1e5 Pa shot at each other at up to 60 m/s; most separate. With one layer up to 54 nodes of one would stay in the other.
TEST( Sinking, TwoFastBodiesDoNotSink )
{
	std::mt19937 random( 3 );
	int worst = 0;
	for ( int shot = 0; shot < 16; ++shot )
	{
		SoftWorld scene;
		scene.world.setGravity( btVector3( 0, 0, 0 ) );
		Material material = test::explicitMaterial();
		material.youngsModulus = 1e5f;
		const auto cube = cubeTemplate( 0.6f, 6 );
		SoftBody* const one = scene.add( cube, btVector3( -1, 0, 0 ), material );
		SoftBody* const other = scene.add( cube, btVector3( 1, btScalar( random() % 100 ) * btScalar( 0.002 ), 0 ), material );
		const btScalar speed = btScalar( 5 + 55.0 * shot / 15 );
		EXPECT_TRUE( one->setLinearVelocity( btVector3( speed / 2, 0, 0 ) ).ok() );
		EXPECT_TRUE( other->setLinearVelocity( btVector3( -speed / 2, 0, 0 ) ).ok() );
		scene.step( 60 );
		worst = std::max( worst, nodesInside( *one, *other ) );
	}
	std::printf( "most nodes of one in the other: %d\n", worst );
	EXPECT_EQ( worst, 0 );
}

} // namespace
} // namespace pliant::test
