// Brittle bodies that break by impacts in their rigid state, and the pieces that part.

#include "support/momentum.h"
#include "support/test_world.h"
#include "world/bodies/soft_body_impl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

namespace pliant {
namespace {

constexpr float kEdge = 0.32f; // m
constexpr int kCells = 8;      // along an edge

Material stiff( float youngsModulus, float rigidStrain )
{
	Material material;
	material.youngsModulus = youngsModulus;
	material.elasticity = Elasticity::Implicit;
	material.rigidStrain = rigidStrain;
	return material;
}

Fracture brittle( BreakRule rule, float strain )
{
	Fracture fracture;
	fracture.rule = rule;
	fracture.breakStrain = strain;
	fracture.shardSize = 0.1f;
	return fracture;
}

struct Outcome
{
	int links = 0, bodies = 1;
	int mostProducts = 0;       ///< of the implicit step
	double leastDistance = 1.0; ///< of neighbouring cells of two pieces, over their distance at rest
};

/// Over all bodies: the least distance of cells of different bodies that were neighbours, over the size of a cell.
double leastDistanceBetween( SoftBodyWorld& world, double cell )
{
	struct Node
	{
		int body;
		btVector3 at;
	};
	std::map<std::array<int, 3>, Node> nodes;
	for ( int k = 0; k < world.softBodyCount(); ++k )
	{
		SoftBody& body = *world.softBody( k );
		const Lattice& lattice = body.impl().body->lattice();
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			const auto& at = lattice.coordinate[std::size_t( i )];
			nodes[{ int( at[0] ), int( at[1] ), int( at[2] ) }] = Node{ k, body.nodePosition( i ) };
		}
	}
	double least = 1.0;
	for ( const auto& [at, node] : nodes )
	{
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			std::array<int, 3> beside = at;
			++beside[axis];
			const auto other = nodes.find( beside );
			if ( other != nodes.end() && other->second.body != node.body )
			{
				least = std::min( least, double( ( other->second.at - node.at ).length() ) / cell );
			}
		}
	}
	return least;
}

/// A cube that meets the floor with an edge or a corner.
Outcome outcomeOf( bool isEdge, const Material& material, const Fracture& fracture, double velocity, double higher, int steps )
{
	test::SoftWorld world;
	world.addBoxFloor();
	world.world.setGravity( btVector3( 0, 0, 0 ) );
	const btQuaternion turn = isEdge ? btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.7 ) )
									 : btQuaternion( btVector3( 1, btScalar( 0.2 ), btScalar( 0.9 ) ).normalized(), btScalar( 0.8 ) );
	SoftBody* const body = world.add(
		test::cubeTemplate( kEdge, kCells ), btVector3( 0, btScalar( higher + ( isEdge ? 0.24 : 0.28 ) ), 0 ), material, turn );
	EXPECT_TRUE( body->setFracture( fracture ).ok() );
	EXPECT_TRUE( body->setVelocities( btVector3( 0, -btScalar( velocity ), 0 ), btVector3( 0, 0, 0 ) ).ok() );
	Outcome outcome;
	int sinceBreak = 0;
	for ( int i = 0; i < steps; ++i )
	{
		world.step( 1 );
		const StepReport& report = world.world.stepReport();
		outcome.links += report.brokenLinks;
		outcome.mostProducts = i < 4 ? 0 : std::max( outcome.mostProducts, report.implicitProducts );
		sinceBreak += outcome.links > 0 ? 1 : 0;
		if ( sinceBreak > 0 && sinceBreak <= 3 )
		{
			outcome.leastDistance = std::min( outcome.leastDistance, leastDistanceBetween( world.world, double( kEdge ) / kCells ) );
		}
	}
	outcome.bodies = world.world.softBodyCount();
	return outcome;
}

// An impact deformed them for half a second, in which each step solved the contacts of a hundred nearly rigid pieces: 100 to 350 ms in
// place of 20 to 50 for a block of 2 197 cells.
TEST( RigidImpacts, BreakAsDeformableBodiesDo )
{
	constexpr float kStrain = 1.5e-3f; // .06 v / c
	for ( const bool isEdge : { true, false } )
	{
		for ( const BreakRule rule : { BreakRule::Distance, BreakRule::Plane, BreakRule::Shards } )
		{
			int links = 0, softLinks = 0, bodies = 0, softBodies = 0, most = 0; // single impacts differ by up to three times
			for ( const double velocity : { 7.0, 8.0, 9.0 } )
			{
				const Outcome rigid = outcomeOf( isEdge, stiff( 1e8f, 0.1f ), brittle( rule, kStrain ), velocity, 0.7, 24 );
				const Outcome soft = outcomeOf( isEdge, stiff( 1e8f, 0.0f ), brittle( rule, kStrain ), velocity, 0.7, 24 );
				links += rigid.links;
				softLinks += soft.links;
				bodies += rigid.bodies;
				softBodies += soft.bodies;
				most = std::max( most, rigid.mostProducts );
				EXPECT_GT( rigid.links, 200 );
			}
			std::printf( "%s, rule %d: %d links and %d bodies, deformable %d and %d\n", isEdge ? "edge" : "corner", int( rule ), links,
				bodies, softLinks, softBodies );
			EXPECT_GT( links, 0.5 * softLinks ) << isEdge << int( rule );
			EXPECT_LT( links, 2.5 * softLinks ) << isEdge << int( rule );
			EXPECT_EQ( most, 0 ) << "some body deformed";
			EXPECT_LT( outcomeOf( isEdge, stiff( 1e8f, 0.1f ), brittle( rule, 5.0f * kStrain ), 8.0, 0.7, 24 ).links, 10 );
		}
	}
}

TEST( RigidImpacts, BreakFromTheSameVelocityOn )
{
	const auto onset = [&]( float rigidStrain ) {
		double low = 0.3, high = 30.0;
		for ( int k = 0; k < 6; ++k )
		{
			const double velocity = std::sqrt( low * high );
			const int links = outcomeOf(
				false, stiff( 1e8f, rigidStrain ), brittle( BreakRule::Plane, 1e-3f ), velocity, velocity / 60.0 * 5.5, 12 )
								  .links;
			( links > 0 ? high : low ) = velocity;
		}
		return high;
	};
	const double rigid = onset( 0.1f ), soft = onset( 0.0f );
	std::printf( "breaks from %.2f m/s on, a deformable one from %.2f\n", rigid, soft );
	EXPECT_GT( rigid, 0.7 * soft );
	EXPECT_LT( rigid, 1.4 * soft );
}

// Pieces had no contacts with each other in the step after an event. Where the floor stopped some of them in it, others moved into these
// by up to a cell, and were crushed as they were pushed out.
TEST( RigidImpacts, PiecesDoNotEnterEachOther )
{
	for ( const float rigidStrain : { 0.0f, 0.1f } )
	{
		const Outcome outcome = outcomeOf( false, stiff( 1e8f, rigidStrain ), brittle( BreakRule::Shards, 8e-4f ), 14.0, 0.0, 8 );
		std::printf(
			"rigidStrain %.1f: %d bodies, least distance %.2f cells\n", double( rigidStrain ), outcome.bodies, outcome.leastDistance );
		EXPECT_GT( outcome.bodies, 5 );
		EXPECT_GT( outcome.leastDistance, 0.5 ) << rigidStrain; // without those contacts .36
	}
}

TEST( RigidImpacts, KeepMomentumAndSpin )
{
	test::SoftWorld world;
	world.world.setGravity( btVector3( 0, 0, 0 ) );
	for ( int k = 0; k < 2; ++k )
	{
		SoftBody* const body = world.add( test::cubeTemplate( kEdge, kCells ),
			btVector3( btScalar( k == 0 ? -1.5 : 1.5 ), btScalar( 0.1 * k ), 0 ), stiff( 1e9f, 0.1f ),
			btQuaternion( btVector3( 1, btScalar( 0.3 ), btScalar( 0.2 * k ) ).normalized(), btScalar( 0.6 ) ) );
		EXPECT_TRUE( body->setFracture( brittle( BreakRule::Plane, 5e-4f ) ).ok() );
		EXPECT_TRUE( body->setVelocities( btVector3( btScalar( k == 0 ? 12 : -12 ), 0, 0 ), btVector3( 0, 0, btScalar( k ) ) ).ok() );
	}
	const auto sum = [&] {
		test::Momentum all;
		for ( int k = 0; k < world.world.softBodyCount(); ++k )
		{
			all += test::momentumOf( *world.world.softBody( k ) );
		}
		return all;
	};
	const test::Momentum before = sum();
	int links = 0;
	for ( int frame = 0; frame < 40; ++frame )
	{
		world.step( 1 );
		links += world.world.stepReport().brokenLinks;
	}
	const test::Momentum after = sum();
	EXPECT_GT( links, 500 );
	const double mass = 2000.0 * std::pow( double( kEdge ), 3.0 );
	EXPECT_LT( double( ( after.linear - before.linear ).length() ), 1e-5 * mass * 12.0 );
	// Bullet's solver applies friction at each side's own point of a contact: by J times a gap.
	EXPECT_LT( double( ( after.angular - before.angular ).length() ), 5e-3 * mass * 12.0 );
}

// It ran twice as fast in steps in which an impact was tested.
TEST( RigidImpacts, CoolDownRunsWithTheClock )
{
	test::SoftWorld world;
	world.addBoxFloor();
	SoftBody* const body = world.add( test::cubeTemplate( kEdge, kCells ), btVector3( 0, btScalar( 0.28 ), 0 ), stiff( 1e8f, 0.1f ),
		btQuaternion( btVector3( 1, btScalar( 0.2 ), btScalar( 0.9 ) ).normalized(), btScalar( 0.8 ) ) );
	Fracture fracture = brittle( BreakRule::Plane, 1.5e-3f ); // whose cracks grow on meanwhile
	fracture.coolDown = 1.0f;
	EXPECT_TRUE( body->setFracture( fracture ).ok() );
	EXPECT_TRUE( body->setVelocities( btVector3( 0, -8, 0 ), btVector3( 0, 0, 0 ) ).ok() );
	float before = 0.0f;
	int cooling = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		world.step( 1 );
		const float now = body->impl().body->breaking()->coolDown;
		if ( before > 0.0f && now < before )
		{
			EXPECT_NEAR( before - now, 1.0f / 60.0f, 1e-4f ) << frame;
			++cooling;
		}
		before = now;
	}
	EXPECT_GT( cooling, 30 );
}

// What tumbled on the floor was stretched by ( h w )^2 / 2 along its tangents in each step, never became rigid, and took 13 ms a step.
TEST( RigidImpacts, WhatTumblesKeepsItsShape )
{
	test::SoftWorld world;
	world.addBoxFloor();
	SoftBody* const body = world.add( test::cubeTemplate( kEdge, kCells ), btVector3( 0, btScalar( 0.24 ), 0 ), stiff( 1e10f, 0.0f ),
		btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.7 ) ) );
	body->setFriction( btScalar( 0.8 ) );
	EXPECT_TRUE( body->setFracture( brittle( BreakRule::Plane, 0.02f ) ).ok() );
	EXPECT_TRUE( body->setVelocities( btVector3( btScalar( 1.5 ), 0, 0 ), btVector3( 0, 0, -8 ) ).ok() );
	const auto breadth = [&] { return double( ( body->nodePosition( body->nodeCount() - 1 ) - body->nodePosition( 0 ) ).length() ); };
	const double rest = breadth();
	double stretched = 0.0, fastest = 0.0;
	for ( int frame = 0; frame < 40; ++frame )
	{
		world.step( 1 );
		fastest = std::max( fastest, double( body->angularVelocity().length() ) );
		stretched = std::max( stretched, std::abs( breadth() / rest - 1.0 ) );
	}
	std::printf( "at up to %.1f rad/s stretched by %.5f\n", fastest, stretched );
	EXPECT_GT( fastest, 4.0 );
	EXPECT_LT( stretched, 1.5e-3 ); // along tangents .0024
}

} // namespace
} // namespace pliant
