// The cost of "refine everything now" and of a touch in a running world, frame by frame: the change itself, the contact proxies, the tree
// and the skin. Steinemann et al. 2008, section 5.2 and Fig. 6: the levels change where a flower is touched.

#include "experiments/experiments.h"
#include "experiments/step_timing.h"
#include "support/explicit_material.h"
#include "support/test_world.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

namespace pliant::experiment {

namespace {

constexpr float kCell = 0.02f;    ///< m
constexpr int kSteadyFrames = 20; ///< before and after the change
constexpr int kChangeFrames = 20;
constexpr int kRuns = 7; ///< the simulation repeats to the bit: the shortest time of each frame over all runs counts

constexpr float kEverything = 10.0f, kTouch = 5.2f * kCell; ///< m

// Limits of these figures, with regions of half-width 1.
constexpr double kMostOver = 2.0; ///< ms over the steady state of as many nodes
constexpr int kMostFrames = 10;
constexpr double kFewestRebuilds = 100000.0; ///< a second and core

struct Scene
{
	const char* name;
	int cells[3];
	int coarseLevels;
	int finestLevel; ///< after the change
	int nodesPerStep;
	float reach; ///< m: nodes nearer to the body's corner than this are refined
	int halfWidth;
	bool hasSkin;
};

std::shared_ptr<const BodyTemplate> blockTemplate( const Scene& scene )
{
	// A grid of quads on each side, so that the skin has a vertex a cell.
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;
	for ( int side = 0; side < 6; ++side )
	{
		const int axis = side / 2, u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3, nu = scene.cells[u], nv = scene.cells[v];
		const std::uint32_t first = std::uint32_t( positions.size() / 3 );
		for ( int j = 0; j <= nv; ++j )
		{
			for ( int i = 0; i <= nu; ++i )
			{
				float at[3];
				at[axis] = kCell * float( scene.cells[axis] ) * ( side % 2 == 0 ? 0.0f : 1.0f );
				at[u] = kCell * float( i );
				at[v] = kCell * float( j );
				for ( int k = 0; k < 3; ++k )
				{
					positions.push_back( at[k] - 0.5f * kCell * float( scene.cells[k] ) );
				}
			}
		}
		for ( int j = 0; j < nv; ++j )
		{
			for ( int i = 0; i < nu; ++i )
			{
				const std::uint32_t a = first + std::uint32_t( j * ( nu + 1 ) + i ), b = a + 1, c = a + std::uint32_t( nu ) + 1, d = c + 1;
				const std::uint32_t out[6] = { a, b, d, a, d, c }, in[6] = { a, d, b, a, c, d };
				indices.insert( indices.end(), side % 2 != 0 ? out : in, ( side % 2 != 0 ? out : in ) + 6 );
			}
		}
	}
	LatticeSettings settings;
	settings.cellSize = kCell;
	return BodyTemplate::build( MeshView{ positions.data(), positions.size() / 3, 3, indices.data(), indices.size() / 3 }, settings ).value;
}

struct Frame
{
	double ms = 1e9, levels = 1e9;
	int nodes = 0, splits = 0;
};

struct Outcome
{
	double over = 0.0;      ///< ms
	double rebuilds = 1e30; ///< a second: regions of new nodes over the additional time of their frame, the smallest value of any change
	int frames = 0;         ///< until no change waits
	int before = 0, after = 0;
};

/// Touches the body after the first frames, and continues.
void runOnce( const Scene& scene, const std::shared_ptr<const BodyTemplate>& bodyTemplate, std::vector<Frame>& frames )
{
	test::SoftWorld place;
	place.world.setGravity( btVector3( 0, 0, 0 ) );
	Material material = test::explicitMaterial();
	material.regionHalfWidth = scene.halfWidth;
	Adaptivity adaptivity;
	adaptivity.coarseLevels = scene.coarseLevels;
	adaptivity.nodesPerStep = scene.nodesPerStep;
	adaptivity.mergeDelay = 60.0f;
	const btTransform at( btQuaternion( btVector3( 1, 2, 3 ).normalized(), btScalar( 0.4 ) ), btVector3( 0, 0, 0 ) );
	SoftBodyResult made = SoftBody::create( bodyTemplate, at, material, adaptivity );
	SoftBody* const body = made.value.get();
	place.soft.push_back( std::move( made.value ) );
	place.world.addSoftBody( body );
	body->setActivationState( DISABLE_DEACTIVATION );
	body->setFinestLevel( scene.finestLevel );
	for ( std::size_t f = 0; f < frames.size(); ++f )
	{
		if ( f == std::size_t( kSteadyFrames ) )
		{
			const btVector3 reach( btScalar( scene.reach ), btScalar( scene.reach ), btScalar( scene.reach ) ),
				corner = body->nodePosition( 0 );
			body->requestRefinement( corner - reach, corner + reach );
		}
		const std::clock_t begin = std::clock(); // one thread: processor time, which excludes other load on the machine
		place.step( 1 );
		if ( scene.hasSkin )
		{
			body->surface();
		}
		const double ms = 1e3 * double( std::clock() - begin ) / CLOCKS_PER_SEC;
		frames[f].ms = std::min( frames[f].ms, ms );
		frames[f].levels = std::min( frames[f].levels, place.world.stepReport().levels * 1e3 );
		frames[f].nodes = body->nodeCount();
		frames[f].splits = place.world.stepReport().splits;
	}
}

double medianMs( const std::vector<Frame>& frames, int first, int last )
{
	std::vector<double> ms;
	for ( int f = first; f < last; ++f )
	{
		ms.push_back( frames[std::size_t( f )].ms );
	}
	std::nth_element( ms.begin(), ms.begin() + std::ptrdiff_t( ms.size() / 2 ), ms.end() );
	return ms[ms.size() / 2];
}

Outcome runScene( const Scene& scene )
{
	Outcome outcome;
	const auto bodyTemplate = blockTemplate( scene );
	if ( !bodyTemplate )
	{
		std::printf( "%s: no template\n", scene.name );
		return outcome;
	}
	std::vector<Frame> frames( std::size_t( 2 * kSteadyFrames + kChangeFrames ) );
	for ( int run = 0; run < kRuns; ++run )
	{
		runOnce( scene, bodyTemplate, frames );
	}
	const int end = int( frames.size() ), touched = kSteadyFrames;
	const double before = medianMs( frames, touched / 2, touched ), after = medianMs( frames, end - kSteadyFrames, end );
	outcome.before = frames[std::size_t( touched - 1 )].nodes;
	outcome.after = frames.back().nodes;
	double worst = 0.0, worstLevels = 0.0;
	for ( int f = touched; f < end - kSteadyFrames; ++f )
	{
		const Frame& frame = frames[std::size_t( f )];
		worst = std::max( worst, frame.ms );
		worstLevels = std::max( worstLevels, frame.levels );
		// The steady state is proportional to the number of nodes: interpolated to the number after this frame.
		const double grown = double( frame.nodes - outcome.before ), whole = double( outcome.after - outcome.before );
		const double over = frame.ms - ( before + ( after - before ) * ( whole > 0.0 ? grown / whole : 0.0 ) );
		outcome.over = std::max( outcome.over, over );
		if ( frame.splits > 0 )
		{
			outcome.frames = f - touched + 1;
			const int brought = frame.nodes - frames[std::size_t( f - 1 )].nodes + frame.splits;
			outcome.rebuilds = std::min( outcome.rebuilds, 1e3 * brought / over );
		}
	}
	std::printf( "%-28s %d  %6d %6d  %5d  %7.2f %7.2f  %7.2f %7.2f %7.2f  %4d %9.0f\n", scene.name, scene.halfWidth, outcome.before,
		outcome.after, scene.nodesPerStep, before, after, worst, outcome.over, worstLevels, outcome.frames, outcome.rebuilds );
	return outcome;
}

} // namespace

void refineExperiment()
{
	std::puts( "Processor time in ms, one thread, each frame the shortest of 7 runs. over: worst frame over the steady state of as many "
			   "nodes; levels: the change alone, wall clock;\n"
			   "rebuilds: regions of new nodes in a second of what a frame takes over the steady state, the slowest change.\n"
			   "                             w   nodes  after   a step   steady before, after    worst    over  levels  frames  rebuilds" );
	const Scene touch{ "touch, +6 %", { 40, 36, 32 }, 1, 0, 1000, kTouch, 1, false };
	const Scene all{ "everything, level 2 to 1", { 40, 36, 28 }, 2, 1, 520, kEverything, 1, false };
	const Scene allFinest{ "everything, level 1 to 0", { 18, 18, 16 }, 1, 0, 520, kEverything, 1, false };
	const auto with = []( Scene scene, int halfWidth, bool hasSkin ) {
		scene.halfWidth = halfWidth;
		scene.hasSkin = hasSkin;
		scene.name = hasSkin ? "the same with its skin" : scene.name;
		return runScene( scene );
	};
	const Outcome asked[3] = { with( all, 1, false ), with( allFinest, 1, false ), with( allFinest, 1, true ) };
	const Outcome flower[2] = { with( touch, 1, false ), with( touch, 1, true ) };
	with( all, 2, false );
	with( allFinest, 2, false );
	with( allFinest, 2, true );
	with( touch, 2, false );
	with( touch, 2, true );

	std::puts( "\nOne thread, w = 1" );
	double rebuilds = 1e30;
	int frames = 0;
	for ( const Outcome& outcome : asked )
	{
		frames = std::max( frames, outcome.frames );
		rebuilds = std::min( rebuilds, outcome.rebuilds );
	}
	char title[120];
	printLimit( "regions rebuilt for new nodes, the slowest change of all that was refined", rebuilds, "a second", kFewestRebuilds, true );
	for ( const Outcome& outcome : flower )
	{
		const int more = outcome.after - outcome.before;
		std::snprintf( title, sizeof( title ), "a touch, %d new nodes (+%.1f %%)%s: worst frame over steady state", more,
			100.0 * more / outcome.before, &outcome == flower ? "" : ", with the skin" );
		printLimit( title, outcome.over, "ms", kMostOver, false );
	}
	std::snprintf(
		title, sizeof( title ), "%d and %d nodes asked for at once: worst frame over steady state", asked[0].after, asked[1].after );
	printLimit( title, std::max( asked[0].over, asked[1].over ), "ms", kMostOver, false );
	printLimit( "  with the skin", asked[2].over, "ms", kMostOver, false );
	printLimit( "  nothing waits any more after", frames, "frames", kMostFrames, false );
}

} // namespace pliant::experiment
