// Levels of detail where a body hits something.

#include "support/energy_of_motion.h"
#include "world/levels/adaptive_bodies.h"

#include "world/shape/penetration_allowance.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::energyOfMotion;
using test::levels;
using test::stiff;
using test::TestWorld;

/// A stiff block of big nodes falls on a corner. If it split only when its spheres touch, the cells at the corners would appear inside the
/// floor, and Bullet would push them out at depth erp / h, many metres a second in small substeps.
TEST( AdaptiveImpact, NodesSplitOnTheFloorAreNotShotUp )
{
	const btQuaternion onCorner( btVector3( 1, 0, -1 ).normalized(), btScalar( 0.9 ) );
	for ( const float modulus : { 1e7f, 1e8f } )
	{
		TestWorld test;
		test.addFloor();
		Adaptivity settings = levels( 2 );
		settings.refinesOnContact = true;
		SoftBody* soft = test.addSoft(
			block( 8, 8, 8, 0.1f ), btTransform( onCorner, btVector3( 0, btScalar( 1.2 ), 0 ) ), stiff( modulus ), settings );
		const btScalar start = soft->massCentre().y(), gravity = -test.world.getGravity().y();
		int splits = 0;
		btScalar highest = 0; // m, from its energy
		for ( int frame = 0; frame < 90; ++frame )
		{
			test.run( 1 );
			splits += test.world.stepReport().splits;
			btScalar energy = 0;
			for ( int i = 0; i < soft->nodeCount(); ++i )
			{
				energy += soft->nodeMass( i ) *
					( btScalar( 0.5 ) * soft->nodeVelocity( i ).length2() + gravity * soft->nodePosition( i ).y() );
			}
			highest = btMax( highest, energy / ( soft->mass() * gravity ) );
		}
		EXPECT_GT( splits, 0 );
		std::printf( "E %g: %.4f of the start\n", double( modulus ), double( highest / start ) );
		EXPECT_LT( highest, start * btScalar( 1.01 ) ) << "E " << modulus;
	}
}

enum class Ground : int
{
	Floor,
	Box,
	Soft,
	SoftWithLevels
};

struct Impact
{
	Ground ground;
	float modulus; // Pa
	int cells;     // along the block's edge: 6 leaves nodes of level 2 half empty
	bool byStrain; // nodes split by strain; otherwise near the ground
	Elasticity elasticity = Elasticity::Explicit;
	btScalar speed = btScalar( 1.2 ); // m/s
	int levels = 2;
};

/// Returns the maximum kinetic energy of all bodies as a ratio to the initial one: a rotated block without gravity and damping.
double mostEnergy( const Impact& impact, const btQuaternion& turn, int& splits )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	Material material = stiff( impact.modulus );
	material.damping = 0.0f;
	material.elasticity = impact.elasticity;
	Adaptivity settings = levels( impact.levels );
	settings.refinesOnContact = !impact.byStrain;
	settings.refineStrain = impact.byStrain ? 0.05f : 0.0f;
	const btTransform under = at( 0, btScalar( -0.2 ), 0 );
	btRigidBody* box = nullptr;
	switch ( impact.ground )
	{
		case Ground::Floor: test.addFloor(); break;
		case Ground::Box: box = test.addBox( 300, btVector3( btScalar( 0.5 ), btScalar( 0.2 ), btScalar( 0.5 ) ), under ); break;
		case Ground::Soft: test.addSoft( block( 10, 4, 10, 0.1f ), under, material ); break;
		case Ground::SoftWithLevels: test.addSoft( block( 12, 4, 12, 0.1f ), under, material, settings ); break;
	}
	SoftBody* const soft = test.addSoft( block( impact.cells, impact.cells, impact.cells, 0.1f ),
		btTransform( turn, btVector3( btScalar( 0.1 ), btScalar( 0.95 ), btScalar( 0.05 ) ) ), material, settings );
	EXPECT_TRUE( soft->setLinearVelocity( btVector3( 0, -impact.speed, 0 ) ).ok() );
	const double first = energyOfMotion( *soft );
	double most = 0.0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		test.run( 1 );
		splits += test.world.stepReport().splits;
		double now = 0.0;
		for ( const auto& body : test.soft )
		{
			now += energyOfMotion( *body );
		}
		if ( box )
		{
			now += energyOfMotion( *box );
		}
		most = std::max( most, now / first );
	}
	return most;
}

/// Arbitrary rotations.
btQuaternion rotationOf( int k )
{
	return btQuaternion(
		btVector3( std::cos( btScalar( k ) ), btScalar( 0.4 ), std::sin( btScalar( 2 * k ) ) ).normalized(), btScalar( 0.3 + 0.5 * k ) );
}

/// The spheres of big nodes leave out their cubes' corners, so nodes that appear there are inside the touched object. Pushed out within a
/// few substeps they would add many times the initial energy, most of all on soft bodies, whose nodes are not predicted.
TEST( AdaptiveImpact, AddsNoEnergy )
{
	const Impact impacts[] = { { Ground::Floor, 1e8f, 6, false }, { Ground::Floor, 3e6f, 8, true, Elasticity::Explicit, 4 },
		{ Ground::Box, 1e8f, 6, false }, { Ground::Soft, 1e7f, 8, false }, { Ground::Soft, 1e8f, 6, false },
		{ Ground::SoftWithLevels, 1e7f, 8, false }, { Ground::SoftWithLevels, 1e8f, 6, false },
		{ Ground::SoftWithLevels, 1e8f, 6, false, Elasticity::Implicit },
		{ Ground::Floor, 1e8f, 6, false, Elasticity::Implicit, btScalar( 1.9 ) } };
	for ( const Impact& impact : impacts )
	{
		double most = 0.0;
		int splits = 0;
		for ( int k = 0; k < 10; ++k )
		{
			most = std::max( most, mostEnergy( impact, rotationOf( k ), splits ) );
		}
		EXPECT_GT( splits, 0 );
		EXPECT_LT( most, 1.001 ) << "ground " << int( impact.ground ) << ", E " << impact.modulus
								 << ( impact.byStrain ? ", by strain" : "" );
		std::printf( "ground %d, E %g%s: at most %.4f of the energy\n", int( impact.ground ), double( impact.modulus ),
			impact.byStrain ? ", by strain" : "", most );
	}
}

/// After the first corner has touched and split, the neighbouring corners come near the floor at the turning point, where the block stores
/// all of its energy. Splitting their nodes there would add up to 13 %.
TEST( AdaptiveImpact, CompressedNodesAreNotSplit )
{
	const btQuaternion onCorner( btVector3( 1, 0, -1 ).normalized(), btScalar( 0.9 ) );
	for ( const float modulus : { 3e6f, 1e7f } )
	{
		for ( const int count : { 1, 2 } )
		{
			int splits = 0;
			const double most = mostEnergy( Impact{ Ground::Floor, modulus, 8, false, Elasticity::Explicit, 2, count }, onCorner, splits );
			std::printf( "E %g, %d levels: at most %.4f of the energy\n", double( modulus ), count, most );
			EXPECT_GT( splits, 0 );
			EXPECT_LT( most, 1.001 );
		}
	}
}

/// A node with an allowance must come out eventually: otherwise the body would rest sunk into the floor, or be kept awake by it.
TEST( AdaptiveImpact, NodesCreatedInTheFloorComeOut )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( int k = 0; k < 4; ++k )
		{
			TestWorld test;
			test.addFloor();
			Material material = stiff( 1e6f );
			material.elasticity = elasticity;
			Adaptivity settings = levels( 2 );
			settings.refinesOnContact = k % 2 == 1;
			settings.refineStrain = k % 2 == 1 ? 0.0f : 0.03f;
			SoftBody* const soft = test.addSoft(
				block( 6, 6, 6, 0.1f ), btTransform( rotationOf( k ), btVector3( 0, 1, 0 ) ), material, settings );
			btScalar deepest = 0; // m
			const auto depth = [soft] {
				btScalar most = 0;
				for ( int i = 0; i < soft->nodeCount(); ++i )
				{
					most = btMax( most, soft->nodeRadius( i ) - soft->nodePosition( i ).y() );
				}
				return most;
			};
			for ( int frame = 0; frame < 720; ++frame )
			{
				test.run( 1 );
				deepest = btMax( deepest, depth() );
			}
			std::printf( "%s, %s: %.1f mm deep at most, %.3f at the end\n", elasticity == Elasticity::Explicit ? "explicit" : "implicit",
				k % 2 == 1 ? "near the floor" : "by strain", 1e3 * double( deepest ), 1e3 * double( depth() ) );
			EXPECT_LT( depth(), btScalar( 0.002 ) );
			EXPECT_FALSE( soft->isActive() );
		}
	}
}

TEST( PenetrationAllowance, IsTheInitialDepthAndNeverGrows )
{
	const std::uint32_t gone = std::numeric_limits<std::uint32_t>::max();
	PenetrationAllowance allowance;
	EXPECT_FALSE( allowance.isAny() );
	EXPECT_EQ( allowance.allowedDepth( 0, 1.0 ), 0.0 );
	// Of three nodes the middle one was split into two.
	allowance.follow( { 0, gone, 3 }, 4 );
	ASSERT_TRUE( allowance.isAny() );
	EXPECT_EQ( allowance.allowedDepth( 0, 0.5 ), 0.0 ); // existing nodes have no allowance
	EXPECT_EQ( allowance.allowedDepth( 1, 0.25 ), 0.25 );
	EXPECT_EQ( allowance.allowedDepth( 1, 0.5 ), 0.5 ); // the deepest of its penetrations
	allowance.endPhase( 0.0 );
	EXPECT_EQ( allowance.allowedDepth( 2, 0.5 ), 0.0 ) << "was never inside";
	EXPECT_EQ( allowance.allowedDepth( 1, 2.0 ), 0.5 ) << "no deeper";
	allowance.endPhase( 0.0 );
	EXPECT_EQ( allowance.allowedDepth( 1, 0.25 ), 0.25 ) << "coming out";
	allowance.endPhase( 0.0 );
	EXPECT_EQ( allowance.allowedDepth( 1, 0.5 ), 0.25 ) << "not back in";
	allowance.endPhase( 0.125 );
	EXPECT_EQ( allowance.allowedDepth( 1, 0.5 ), 0.125 ) << "reduced over time";

	// Renumbered by a change of levels and by fracture.
	allowance.follow( { gone, 0, gone, gone }, 2 );
	EXPECT_EQ( allowance.allowedDepth( 0, 0.5 ), 0.125 );
	EXPECT_EQ( allowance.allowedDepth( 1, 0.5 ), 0.5 ) << "new";
	allowance.endPhase( 0.0 );
	PenetrationAllowance piece = PenetrationAllowance::of( allowance, { 1 } );
	EXPECT_EQ( piece.allowedDepth( 0, 1.0 ), 0.5 );
	piece.endPhase( 1.0 );
	EXPECT_FALSE( piece.isAny() ) << "has come out";
	EXPECT_FALSE( PenetrationAllowance::of( piece, { 0 } ).isAny() );
}

} // namespace
} // namespace pliant
