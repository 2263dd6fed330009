// Panes that break for a minute under a budget of debris: the number of pieces stays bounded, and all of them are reported.

#include "world/test_world.h"

#include <algorithm>
#include <cstdio>

namespace pliant {
namespace {

using test::block;
using test::stiff;
using test::TestWorld;

constexpr int kPanes = 200, kFramesAPane = 18, kStands = 60; // frames until the game removes the rest of a pane
constexpr int kMostPieces = 60, kMostNodes = 1500;

TEST( Debris, OfTwoHundredPanesStaysWithinItsBudget )
{
	TestWorld test;
	test.addFloor();
	DebrisBudget budget;
	budget.maxPieces = kMostPieces;
	budget.maxNodes = kMostNodes;
	budget.fadeTime = 0.25f;
	budget.piecesPerStep = 10;
	ASSERT_TRUE( test.world.setDebrisBudget( budget ).ok() );
	const auto shape = block( 10, 10, 1, 0.05f );
	Fracture glass;
	glass.rule = BreakRule::Shards;
	glass.breakStrain = 0.01f;
	glass.shardSize = 0.12f;
	int fragments = 0, removed = 0, faded = 0, mostBodies = 0, panes = 0, broken = 0;
	double early = 0.0, late = 0.0;
	for ( int frame = 0; frame < kPanes * kFramesAPane; ++frame )
	{
		if ( frame % kFramesAPane == 0 )
		{
			const btTransform where(
				btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.4 ) ), btVector3( btScalar( panes % 8 - 4 ), btScalar( 0.5 ), 0 ) );
			SoftBody* const pane = test.addSoft( shape, where, stiff( 1e6f ) );
			ASSERT_TRUE( pane->setFracture( glass ).ok() );
			ASSERT_TRUE( pane->setLinearVelocity( btVector3( 0, -9, 0 ) ).ok() );
			++panes;
		}
		if ( frame > kStands && ( frame - kStands ) % kFramesAPane == 0 )
		{
			broken += test.soft.front()->cellCount() < 100 ? 1 : 0;
			test.soft.erase( test.soft.begin() );
		}
		test.run( 1 );
		const StepReport& report = test.world.stepReport();
		fragments += report.fragments;
		removed += report.removedPieces;
		faded += report.debrisFading;
		mostBodies = std::max( mostBodies, report.softBodies );
		( frame < kPanes * kFramesAPane / 4 ? early : late ) += report.total;
	}
	std::printf( "%d panes, %d of which broke, %d fragments, %d removed; at most %d bodies; a step %.2f ms, then %.2f\n", panes, broken,
		fragments, removed, mostBodies, 1e3 * early / ( kPanes * kFramesAPane / 4 ), 1e3 * late / ( kPanes * kFramesAPane * 3 / 4 ) );
	EXPECT_GT( broken, kPanes * 3 / 4 );
	EXPECT_GT( fragments, 5 * kPanes );
	// Pieces over the budget fade for a quarter of a second, in which 15 steps may add pieces.
	EXPECT_LE( mostBodies, kMostPieces + 15 * 10 + 8 );
	EXPECT_EQ( test.world.fragmentCount(), fragments - removed );
	EXPECT_LE( removed, faded );
	test.run( 60 );
	EXPECT_LE( test.world.fragmentCount(), kMostPieces );
	EXPECT_LE( test.world.stepReport().debrisNodes, kMostNodes );
	EXPECT_LT( late / 3.0, 3.0 * early ); // steps do not become slower: a factor of three allows for other load on the machine
}

} // namespace
} // namespace pliant
