// The rows of Steinemann et al. 2008, section 7: one step of a palm with thin fingers by each method, and the time of its parts. Shortest
// of several runs.

#include "body/body.h"
#include "body/levels/levels.h"
#include "experiments/experiments.h"
#include "matching/reference/reference_matcher.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/shapes.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <numeric>

namespace pliant::experiment {

namespace {

constexpr float kSplitStep = 1.0f / 240.0f;
constexpr int kRounds = 7;
constexpr double kRoundSeconds = 0.05;

/// Seconds of one call: the shortest mean of several rounds.
double secondsOf( const std::function<void()>& call )
{
	using Clock = std::chrono::steady_clock;
	double best = 1e30;
	for ( int round = 0; round < kRounds; ++round )
	{
		const Clock::time_point begin = Clock::now();
		double seconds = 0.0;
		int calls = 0;
		for ( ; calls == 0 || seconds < kRoundSeconds; ++calls )
		{
			call();
			seconds = std::chrono::duration<double>( Clock::now() - begin ).count();
		}
		best = std::min( best, seconds / calls );
	}
	return best;
}

/// A palm of 32^3 cells and five fingers of 2 x 2 x 24, which cross the borders of blocks so that they stay finest.
std::shared_ptr<const Lattice> makePalm()
{
	return std::make_shared<const Lattice>( test::makeShapeLattice( { 32, 32, 56 }, 1.0f, []( int x, int y, int z ) {
		const bool isFinger = ( y == 15 || y == 16 ) && x % 6 >= 1 && x % 6 <= 2 && x < 30;
		return z < 32 || ( isFinger && z < 56 );
	} ) );
}

std::unique_ptr<Body> makeSplittingBody( std::shared_ptr<const Lattice> lattice, const Adaptivity& adaptivity )
{
	std::unique_ptr<Body> body = std::move( Body::create( std::move( lattice ), test::explicitMaterial(), {}, nullptr, adaptivity ).value );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->nodes().v.set( i, 0.1f * body->nodes().x0.get( i ) );
	}
	return body;
}

double secondsOfStep( Body& body )
{
	return secondsOf( [&body] {
		body.accelerateTowardGoals( kSplitStep, 0.5f, nullptr );
		body.integrate( kSplitStep );
	} );
}

void printRoad( const char* name, const char* paper, int nodes, double seconds, double naive )
{
	std::printf( "  %-46s %8d %11.3f %10.0f %9.1f   %s\n", name, nodes, 1e3 * seconds, 1.0 / seconds, naive / seconds, paper );
}

/// S60 to S63.
void roadsOfThePalm( const std::shared_ptr<const Lattice>& palm )
{
	std::printf( "Palm with thin fingers, one step, w = 1\n  %-46s %8s %11s %10s %9s   %s\n", "", "nodes", "ms", "steps/s", "x naive",
		"in the paper" );
	NodeState nodes = test::restNodes( *palm );
	ReferenceMatcher reference( *palm, Material{} );
	const double naive = secondsOf( [&] { reference.accelerate( nodes, MatchStep{ kSplitStep, 0.5f, 10.0f }, nullptr ); } );
	printRoad( "LSM, each region summed anew (naive)", "35 000 nodes, 2.5/s", nodes.count, naive, naive );

	constexpr int kLevels = 3;
	Adaptivity octree = steinemannAdaptivity( kLevels );
	octree.keepMass = 2.0f; // never: all nodes stay finest
	const std::unique_ptr<Body> regular = makeSplittingBody( palm, octree );
	printRoad( "octree code on the same lattice, no adaptivity", "4.6/s, 1.8 x", regular->nodeCount(), secondsOfStep( *regular ), naive );
	const std::unique_ptr<Body> fast = makeSplittingBody( palm, {} );
	printRoad( "LSM, fast sums, all that our code can", "about 10/s, 4 x", fast->nodeCount(), secondsOfStep( *fast ), naive );
	const std::unique_ptr<Body> theirs = makeSplittingBody( palm, steinemannAdaptivity( kLevels ) );
	printRoad( "levels, Steinemann's method", "661 nodes, 222/s, 88 x", theirs->nodeCount(), secondsOfStep( *theirs ), naive );
	Adaptivity mine;
	mine.coarseLevels = kLevels;
	const std::unique_ptr<Body> ours = makeSplittingBody( palm, mine );
	printRoad( "levels, ours", "", ours->nodeCount(), secondsOfStep( *ours ), naive );
}

struct Split
{
	double sums, rotation, goals, rest;
};

/// Rotation and goal transform of a region are in one kernel with the gathering of its members' sums. They are separated by running the
/// same kernel on a table where each region has one member. Measured at rest, where each rotation takes equally many iterations of Newton's
/// method in both.
double secondsOfRotation( const MatchView& full, int padded )
{
	std::vector<std::uint32_t> one( std::size_t( padded ) + 1 ), open( static_cast<std::size_t>( padded ) );
	std::iota( one.begin(), one.end(), 0u );
	MatchView view = full;
	view.start = view.member = one.data();
	view.addOwner = false;
	view.gridX = view.gridY = view.gridZ = 0;
	view.slot = nullptr;
	return secondsOf( [&] { bestKernels().fitRegions( view, 0, padded, open.data() ); } );
}

Split splitOf( Body& body )
{
	body.place( {} );
	NodeState& nodes = body.nodes();
	const Kernels& kernels = bestKernels();
	LatticeMatcher matcher( body.lattice(), Material{}, body.levels()->tables(), kernels );
	matcher.reset( nodes, Eigen::Quaterniond::Identity() );
	MatchView view = matcher.view( nodes );
	view.frameRotation[0] = view.frameRotation[4] = view.frameRotation[8] = 1.0f;
	kernels.nodeRecords( view, 0, nodes.padded );
	const SumPlan* plan = matcher.tables().plan.get();
	std::vector<std::uint32_t> open( static_cast<std::size_t>( nodes.padded ) );
	float sums[kImpulseSums] = {};
	const double records = secondsOf( [&] {
		kernels.frameSums( view, 0, nodes.padded, sums );
		kernels.nodeRecords( view, 0, nodes.padded );
		if ( plan )
		{
			depthSum( *plan, view.nodeRecord );
		}
	} );
	const double fit = secondsOf( [&] { kernels.fitRegions( view, 0, nodes.padded, open.data() ); } );
	const double rotation = std::min( fit, secondsOfRotation( view, nodes.padded ) );
	const double goals = secondsOf( [&] { kernels.scatter( view, 0, nodes.padded, sums ); } );
	const double whole = secondsOfStep( body );
	return Split{ records + fit - rotation, rotation, goals, std::max( 0.0, whole - records - fit - goals ) };
}

/// S64.
void printSplits( const std::shared_ptr<const Lattice>& palm )
{
	std::printf(
		"\nWhere the time of a step with levels goes, %%   (in the paper: sums and matching, polar decomposition, damping: a third each)\n"
		"  %-22s %18s %22s %24s %12s\n",
		"", "sums to regions", "rotation, goal matrix", "sums to nodes, damping", "the rest" );
	Adaptivity ours;
	ours.coarseLevels = 3;
	for ( const auto& [name, adaptivity] :
		{ std::pair<const char*, Adaptivity>( "Steinemann's method", steinemannAdaptivity( 3 ) ), { "ours", ours } } )
	{
		const std::unique_ptr<Body> body = makeSplittingBody( palm, adaptivity );
		const Split split = splitOf( *body );
		const double all = ( split.sums + split.rotation + split.goals + split.rest ) / 100.0;
		std::printf(
			"  %-22s %18.0f %22.0f %24.0f %12.0f\n", name, split.sums / all, split.rotation / all, split.goals / all, split.rest / all );
	}
	std::puts( "  (damping is no pass of its own here: it is the change of goal - position, which the sums to nodes have at hand)" );
}

} // namespace

void splitsExperiment()
{
	const std::shared_ptr<const Lattice> palm = makePalm();
	roadsOfThePalm( palm );
	printSplits( palm );
}

} // namespace pliant::experiment
