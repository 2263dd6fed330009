// Panes that break for a minute under a budget of debris: the number of pieces stays bounded, and all of them are reported.

#include "world/test_world.h"

#include <algorithm>
#include <cstdio>
#include <ctime>

namespace pliant {
namespace {

using test::block;
using test::stiff;
using test::TestWorld;

constexpr int kPanes = 200, kFramesAPane = 18, kStands = 60; // frames until the game removes the rest of a pane
constexpr int kQuarter = kPanes * kFramesAPane / 4;          // frames
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
	double quarters[4] = {}; // processor time, s: other work on the machine hardly prolongs it
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
		const std::clock_t begin = std::clock();
		test.run( 1 );
		quarters[frame / kQuarter] += double( std::clock() - begin ) / CLOCKS_PER_SEC;
		const StepReport& report = test.world.stepReport();
		fragments += report.fragments;
		removed += report.removedPieces;
		faded += report.debrisFading;
		mostBodies = std::max( mostBodies, report.softBodies );
	}
	std::printf(
		"%d panes, %d of which broke, %d fragments, %d removed; at most %d bodies; a step %.2f, %.2f, %.2f and %.2f ms by quarters\n",
		panes, broken, fragments, removed, mostBodies, 1e3 * quarters[0] / kQuarter, 1e3 * quarters[1] / kQuarter,
		1e3 * quarters[2] / kQuarter, 1e3 * quarters[3] / kQuarter );
	EXPECT_GT( broken, kPanes * 3 / 4 );
	EXPECT_GT( fragments, 5 * kPanes );
	// Pieces over the budget fade for a quarter of a second, in which 15 steps may add pieces.
	EXPECT_LE( mostBodies, kMostPieces + 15 * 10 + 8 );
	EXPECT_EQ( test.world.fragmentCount(), fragments - removed );
	EXPECT_LE( removed, faded );
	int calm = 0; // steps since a piece came off: those over the budget fade for 15
	for ( int frame = 0; frame < 600 && calm < 20; ++frame )
	{
		test.run( 1 );
		calm = test.world.stepReport().fragments > 0 ? 0 : calm + 1;
	}
	EXPECT_EQ( calm, 20 );
	EXPECT_LE( test.world.fragmentCount(), kMostPieces );
	EXPECT_LE( test.world.stepReport().debrisNodes, kMostNodes );
	EXPECT_LT( quarters[3], 1.5 * quarters[0] ); // steps do not become slower: processor time varies by a fifth beside other work
}

} // namespace
} // namespace pliant
