// Bodies whose parts collide with each other: sides of a cut, arms that swing together. Steinemann et al. 2008, section 7.

#include "world/levels/adaptive_bodies.h"
#include "world/self/all_pairs.h"

#include "lattice/inside/inside_distance.h"
#include "support/block_lattice.h"
#include "support/inverted_fraction.h"
#include "support/shapes.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::stiff;
using test::TestWorld;

constexpr float kCell = 0.05f;               // m
constexpr float kBack = -4.0f * kCell;       // the cut ends here
constexpr btScalar kSwing = btScalar( 0.8 ); // m/s of the arms' ends, towards each other

/// speed of the arms' ends towards each other, m/s
SoftBody* addSlitBlock( TestWorld& test, const Adaptivity& adaptivity = {} )
{
	SoftBody* soft = test.addSoft( block( 16, 8, 4, kCell ), at( 0, 0, 0 ), stiff( 2e4f ), adaptivity );
	const btScalar far = 1;
	EXPECT_GT(
		soft->cutSweep( btVector3( kBack, 0, -far ), btVector3( kBack, 0, far ), btVector3( far, 0, -far ), btVector3( far, 0, far ) ), 0 );
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	test.run( 1 );
	return soft;
}

bool isUpper( const SoftBody& soft, int node )
{
	return soft.impl().body->nodes().x0.y[node] > 0.0f;
}

void swingTogether( SoftBody& soft )
{
	NodeState& nodes = soft.impl().body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const float fraction = std::max( 0.0f, ( nodes.x0.x[i] - kBack ) / ( 12.0f * kCell ) );
		nodes.v.set( i, Vec3( 0, ( isUpper( soft, i ) ? -fraction : fraction ) * float( kSwing ), 0 ) );
	}
}

/// Returns the least distance between nodes of the two arms, as a ratio to their distance at rest or to the sum of their radii, whichever
/// is less.
double closest( const SoftBody& soft )
{
	const NodeState& nodes = soft.impl().body->nodes();
	double least = 1e30;
	for ( int a = 0; a < nodes.count; ++a )
	{
		for ( int b = 0; b < nodes.count; ++b )
		{
			const bool isPair = isUpper( soft, a ) && !isUpper( soft, b ) && std::min( nodes.x0.x[a], nodes.x0.x[b] ) > kBack + 2 * kCell;
			if ( isPair )
			{
				const double radii = double( soft.nodeRadius( a ) + soft.nodeRadius( b ) );
				const double wanted = std::min( radii, double( ( nodes.x0.get( a ) - nodes.x0.get( b ) ).norm() ) );
				least = std::min( least, double( ( nodes.x.get( a ) - nodes.x.get( b ) ).norm() ) / wanted );
			}
		}
	}
	return least;
}

/// Returns the mean height of the upper arm's end above the lower's, m.
double gap( const SoftBody& soft )
{
	const NodeState& nodes = soft.impl().body->nodes();
	double height[2] = { 0, 0 }, mass[2] = { 0, 0 };
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( nodes.x0.x[i] > 6.0f * kCell )
		{
			height[isUpper( soft, i )] += double( nodes.mass[i] * nodes.x.y[i] );
			mass[isUpper( soft, i )] += double( nodes.mass[i] );
		}
	}
	return height[1] / mass[1] - height[0] / mass[0];
}

struct Swing
{
	double closest = 1e30, lowestGap = 1e30;
	int contacts = 0;
};

Swing swing( TestWorld& test, const SoftBody& soft )
{
	Swing seen;
	for ( int frame = 0; frame < 60; ++frame )
	{
		test.run( 1 );
		seen.closest = std::min( seen.closest, closest( soft ) );
		seen.lowestGap = std::min( seen.lowestGap, gap( soft ) );
		seen.contacts = std::max( seen.contacts, test.world.stepReport().selfContacts );
	}
	return seen;
}

TEST( InsideDistance, IsTheShortestPathAlongLinksToTheSurface )
{
	for ( const unsigned seed : { 1u, 2u, 3u } )
	{
		const Lattice lattice = test::makeBlobLattice( 14, 0.1f, seed );
		const std::vector<std::uint32_t> depth = floodInside( lattice );
		std::uint32_t deepest = 0;
		for ( std::uint32_t i = 0; i < depth.size(); ++i )
		{
			// Zero at the surface; elsewhere one link more than the least of its neighbours. The function is unique.
			std::uint32_t least = lattice.isSurface[i] ? 0 : 0xffffffffu;
			for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1] && !lattice.isSurface[i]; ++k )
			{
				const std::uint32_t j = lattice.linkTo[k];
				least = std::min(
					least, depth[j] + kLinkTenths[( lattice.coordinate[i] - lattice.coordinate[j] ).cast<int>().cwiseAbs().sum()] );
			}
			ASSERT_EQ( depth[i], least );
			deepest = std::max( deepest, depth[i] );
		}
		EXPECT_GE( deepest, 14u );
	}
	const Lattice lattice = makeBlockLattice( 5, 5, 5, 0.1f );
	const std::vector<std::uint32_t> depth = floodInside( lattice );
	EXPECT_EQ( depth[62], 20u ); // the middle
	EXPECT_TRUE( outwardOf( lattice, depth, 62 ).isZero( 1e-5f ) );
	EXPECT_TRUE( outwardOf( lattice, depth, 60 ).normalized().isApprox( -Vec3::UnitX(), 1e-5f ) );
	EXPECT_TRUE( outwardOf( lattice, depth, 61 ).normalized().isApprox( -Vec3::UnitX(), 1e-5f ) ); // one below the surface
}

TEST( SelfCollision, ArmsThatSwingTogetherDoNotGoThroughEachOther )
{
	for ( const int coarse : { 0, 1 } )
	{
		TestWorld with, without;
		SoftBody* const held = addSlitBlock( with, test::levels( coarse ) );
		SoftBody* const free = addSlitBlock( without, test::levels( coarse ) );
		EXPECT_TRUE( held->setSelfCollision( true ).ok() );
		swingTogether( *held );
		swingTogether( *free );
		const BodySums before = held->impl().body->sums();
		const Swing seen = swing( with, *held ), ghost = swing( without, *free );
		std::printf( "levels %d: closest %.2f of their radii, gap %.3f m, %d contacts; without: %.2f, %.3f m\n", coarse, seen.closest,
			seen.lowestGap, seen.contacts, ghost.closest, ghost.lowestGap );
		EXPECT_GT( seen.contacts, 4 );
		EXPECT_GT( seen.closest, 0.5 );                     // half a node
		EXPECT_GT( seen.lowestGap, 3.0 * double( kCell ) ); // four at rest
		EXPECT_LT( ghost.lowestGap, 1.0 * double( kCell ) );
		EXPECT_EQ( without.world.stepReport().selfContacts, 0 );

		const BodySums after = held->impl().body->sums();
		const double scale = before.mass * double( kSwing );
		EXPECT_LT( ( after.momentum - before.momentum ).norm(), 1e-5 * scale );
		EXPECT_LT( ( after.spin - before.spin ).norm(), 1e-4 * scale * 0.4 );
		EXPECT_LT( after.kineticEnergy, before.kineticEnergy );
	}
}

// Too deep for the spheres to tell the side; the outward direction of the material does.
TEST( SelfCollision, ArmsThatHavePassedThroughEachOtherComeBack )
{
	TestWorld test;
	SoftBody* const soft = addSlitBlock( test );
	swingTogether( *soft );
	for ( int frame = 0; frame < 60 && gap( *soft ) > 1.5 * double( kCell ); ++frame )
	{
		test.run( 1 );
	}
	ASSERT_LT( gap( *soft ), 1.5 * double( kCell ) ); // they overlap by two and a half cells of four
	ASSERT_TRUE( soft->setLinearVelocity( btVector3( 0, 0, 0 ) ).ok() );
	EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
	const double energy = soft->impl().body->sums().kineticEnergy;
	EXPECT_EQ( energy, 0.0 );
	test.run( 360 );
	EXPECT_GT( gap( *soft ), 3.9 * double( kCell ) );
	EXPECT_GT( closest( *soft ), 0.95 );
	EXPECT_LT( soft->impl().body->sums().kineticEnergy, 1e-3 );
}

// Reference implementation: all pairs of spheres, in every frame.
TEST( SelfCollision, EqualsTheTestOfAllPairs )
{
	for ( const int coarse : { 0, 1 } )
	{
		TestWorld test;
		SoftBody* const soft = addSlitBlock( test, test::levels( coarse ) );
		EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
		swingTogether( *soft );
		SelfSearch search;
		int touching = 0;
		for ( int frame = 0; frame < 40; ++frame )
		{
			test.run( 1 );
			touching += test::expectAllPairs( *soft, search );
		}
		EXPECT_GT( touching, 100 );
	}
}

TEST( SelfCollision, ABodyInOnePieceMovesAsIfItWereOff )
{
	TestWorld with, without;
	for ( TestWorld* test : { &with, &without } )
	{
		test->addFloor();
		SoftBody* const soft = test->addSoft( block( 6, 6, 6, kCell ), at( 0, btScalar( 0.4 ), 0 ), stiff( 1e5f ) );
		EXPECT_TRUE( soft->setSelfCollision( test == &with ).ok() );
		EXPECT_TRUE( soft->setVelocities( btVector3( 0, -2, 0 ), btVector3( 1, 2, 3 ) ).ok() );
		test->run( 60 );
	}
	const NodeState& a = with.soft[0]->impl().body->nodes();
	const NodeState& b = without.soft[0]->impl().body->nodes();
	EXPECT_EQ( std::memcmp( a.x.x.data(), b.x.x.data(), std::size_t( a.count ) * sizeof( float ) ), 0 );
	EXPECT_EQ( with.world.stepReport().selfContacts, 0 );
	EXPECT_TRUE( with.soft[0]->selfCollision() );
	EXPECT_FALSE( without.soft[0]->selfCollision() );
}

// Top and bottom of a slab approach each other through the material, not around it.
TEST( SelfCollision, ACrushedSlabUnfoldsAgain )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const soft = test.addSoft( block( 8, 5, 8, kCell ), at( 0, 0, 0 ), stiff( 2e4f ) );
	EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
	NodeState& nodes = soft->impl().body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, nodes.x.get( i ).cwiseProduct( Vec3( 1, 0.1f, 1 ) ) );
	}
	test.run( 300 );
	EXPECT_EQ( test::invertedFraction( *soft->impl().body ), 0.0f );
	const btTransform fit = soft->bestFitTransform();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 rest = nodes.x0.get( i );
		const btVector3 wanted = fit * btVector3( rest.x(), rest.y(), rest.z() );
		EXPECT_LT( ( soft->nodePosition( i ) - wanted ).length(), btScalar( 0.05 ) * btScalar( kCell ) );
	}
}

TEST( SelfCollision, PiecesInheritItAndTheWorldReleasesIt )
{
	TestWorld test;
	SoftBody* const soft = addSlitBlock( test );
	EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
	const auto mostContacts = [&test, soft] {
		int most = 0;
		for ( int frame = 0; frame < 40; ++frame )
		{
			swingTogether( *soft );
			test.run( 1 );
			most = std::max( most, test.world.stepReport().selfContacts );
		}
		return most;
	};
	EXPECT_GT( mostContacts(), 4 );
	EXPECT_GT( soft->cutPlane( btVector3( btScalar( kBack ) - btScalar( kCell ), 0, 0 ), btVector3( 1, 0, 0 ) ), 0 ); // the back comes off
	test.run( 1 );
	ASSERT_EQ( test.world.fragmentCount(), 1 );
	EXPECT_TRUE( test.world.softBody( 1 )->selfCollision() );
	EXPECT_GT( mostContacts(), 4 );
	const int manifolds = test.world.getDispatcher()->getNumManifolds();
	EXPECT_GT( manifolds, 0 );
	EXPECT_TRUE( soft->setSelfCollision( false ).ok() );
	EXPECT_LT( test.world.getDispatcher()->getNumManifolds(), manifolds );
	EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
	test.run( 1 );
	test.world.removeSoftBody( soft );
	test.run( 1 );
	EXPECT_EQ( test.world.stepReport().selfContacts, 0 );
}

TEST( SelfCollision, IsTheSameForAnyNumberOfThreads )
{
	std::vector<float> first;
	for ( const int threads : { 1, 2, 4 } )
	{
		TestWorld test;
		test.world.setThreadCount( threads );
		SoftBody* const soft = addSlitBlock( test );
		EXPECT_TRUE( soft->setSelfCollision( true ).ok() );
		swingTogether( *soft );
		test.run( 40 );
		const NodeState& nodes = soft->impl().body->nodes();
		std::vector<float> now;
		for ( int i = 0; i < nodes.count; ++i )
		{
			now.insert( now.end(), { nodes.x.x[i], nodes.x.y[i], nodes.x.z[i], nodes.v.x[i], nodes.v.y[i], nodes.v.z[i] } );
		}
		first = first.empty() ? now : first;
		EXPECT_EQ( std::memcmp( now.data(), first.data(), now.size() * sizeof( float ) ), 0 );
	}
}

} // namespace
} // namespace pliant
