// Laws that need a world: long steps, threads, memory.

#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/inverted_fraction.h"
#include "support/memory_in_use.h"
#include "support/test_world.h"
#include "world/bodies/soft_body_impl.h"

#include <gtest/gtest.h>

#include <cstring>

namespace pliant {
namespace {

TEST( LongStep, OfATenthOfASecondInvertsNothing )
{
	// stepSimulation( 0.1, 0 ): one step of Bullet's, one soft substep for a sixtieth of a second. The world adds the substeps that the
	// step's length requires.
	test::SoftWorld scene;
	scene.addFloor();
	scene.world.setSoftSubsteps( 1 );
	SoftBody* body = scene.add( test::cubeTemplate( 1.0f, 8 ), btVector3( 0, 1, 0 ) );
	float worst = 0.0f;
	for ( int k = 0; k < 100; ++k )
	{
		scene.world.stepSimulation( btScalar( 0.1 ), 0 );
		worst = std::max( worst, test::invertedFraction( *body->impl().body ) );
	}
	std::printf( "inverted cells at the end %.4f, at the worst of the impact %.4f, substeps %d, height of the mass centre %.3f m\n",
		double( test::invertedFraction( *body->impl().body ) ), double( worst ), scene.world.stepReport().substeps,
		double( body->massCentre().y() ) );
	EXPECT_EQ( test::invertedFraction( *body->impl().body ), 0.0f );
	EXPECT_LT( worst, 0.2f ); // the lowest layer may pass through itself in the impact, at this one substep
	EXPECT_GT( body->massCentre().y(), btScalar( 0.25 ) );
}

/// A heap of soft cubes and rigid boxes after two seconds, as bytes.
std::vector<float> heapAfter( int threads )
{
	test::SoftWorld scene;
	scene.addBoxFloor();
	scene.world.setThreadCount( threads );
	const auto cube = test::cubeTemplate( 0.8f, 12 );
	for ( int i = 0; i < 3; ++i )
	{
		scene.add( cube, btVector3( btScalar( 0.2 * i ), btScalar( 0.6 + 0.9 * i ), btScalar( 0.1 * i ) ) );
		scene.add( 20, new btBoxShape( btVector3( btScalar( 0.15 ), btScalar( 0.15 ), btScalar( 0.15 ) ) ),
			btVector3( btScalar( 0.1 * i ), btScalar( 3.5 + 0.5 * i ), 0 ) );
	}
	scene.step( 120 );
	std::vector<float> state;
	for ( const auto& body : scene.soft )
	{
		const NodeState& nodes = body->impl().body->nodes();
		for ( const AlignedArray<float>* array : { &nodes.x.x, &nodes.x.y, &nodes.x.z, &nodes.v.x, &nodes.v.y, &nodes.v.z } )
		{
			state.insert( state.end(), array->begin(), array->end() );
		}
	}
	return state;
}

TEST( Threads, OneTwoFourAndEightGiveTheSameBits )
{
	const std::vector<float> one = heapAfter( 1 );
	for ( int threads : { 2, 4, 8 } )
	{
		const std::vector<float> more = heapAfter( threads );
		ASSERT_EQ( one.size(), more.size() );
		EXPECT_EQ( std::memcmp( one.data(), more.data(), one.size() * sizeof( float ) ), 0 ) << threads << " threads";
	}
}

/// Bytes a node of a body by itself, its lattice and tables included.
double memoryOfBody( const Material& material )
{
	const std::size_t before = test::memoryInUse();
	const std::unique_ptr<Body> body = test::makeBlock( 13, 13, 13, 1.0f / 13.0f, material );
	for ( int k = 0; k < 10; ++k )
	{
		test::substep( *body, 1.0f / 240.0f, 0.5f );
	}
	return double( test::memoryInUse() - before ) / body->nodeCount();
}

TEST( Memory, StaysWithinItsBudgetANode )
{
	for ( int halfWidth : { 1, 2, 3 } )
	{
		Material material = test::explicitMaterial();
		material.regionHalfWidth = halfWidth;
		const double core = memoryOfBody( material );
		test::SoftWorld scene;
		scene.addFloor();
		const std::size_t before = test::memoryInUse();
		SoftBody* body = scene.add( test::cubeTemplate( 1.0f, 13 ), btVector3( 0, btScalar( 0.51 ), 0 ), material );
		scene.step( 60 );
		const std::size_t manifolds = std::size_t( scene.dispatcher.getNumManifolds() ) * sizeof( btPersistentManifold ); // from a pool
		const double all = double( test::memoryInUse() - before + manifolds ) / body->nodeCount();
		std::printf( "w = %d: core %.0f bytes a node; in a world, with template and contacts, %.0f\n", halfWidth, core, all );
		if ( halfWidth == 1 )
		{
			EXPECT_LE( core, 475.0 );
			EXPECT_LE( all, sizeof( btScalar ) == sizeof( float ) ? 1200.0 : 1600.0 );
		}
	}
}

} // namespace
} // namespace pliant
