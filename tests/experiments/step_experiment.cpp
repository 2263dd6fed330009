// Ohta et al. 2009, table of the bunny: 2 248 nodes compared with 207, the step alone and the whole frame; the cost of a step for each node
// of a body with levels, from 2 000 to 20 000 nodes; and Steinemann et al. 2008, section 4.3: summation nodes a region.

#include "experiments/experiments.h"
#include "experiments/step_timing.h"
#include "support/explicit_material.h"

#include "adapt/constants.h"
#include "body/body.h"
#include "body/levels/levels.h"
#include "lattice/test_meshes.h"
#include "matching/reference/reference_matcher.h"
#include "support/block_body.h"
#include "support/shapes.h"
#include "support/test_world.h"
#ifdef PLIANT_HAS_MODELS
	#include "demos/shapes.h"
	#include "third_party_glue/assimp_mesh.h"
#endif

#include <cstdlib>
#include <string>

namespace pliant::experiment {

namespace {

constexpr int kPaperCells = 2248, kPaperNodes = 207;
constexpr char kBunnyFile[] = "models/data/meshes/bunny00.off"; ///< where demos/fetch_models.sh stores it, relative to the repository

// Limits of these figures.
constexpr double kLeastOverNaive[2] = { 10.0, 30.0 }; ///< w = 1, 2
constexpr double kLeastOverFast = 5.0;
constexpr double kMostPerNode = 100.0; ///< ns

struct Shape
{
	std::string name;
	std::shared_ptr<const BodyTemplate> bodyTemplate;
};

Shape makeBunny()
{
	LatticeSettings settings;
	settings.targetCells = kPaperCells;
#ifdef PLIANT_HAS_MODELS
	pliant_glue::ReadResult read = pliant_glue::readModel( kBunnyFile );
	const std::string name = read.ok() ? "Stanford bunny" : "shape like a bunny (no models/: demos/fetch_models.sh)";
	pliant_glue::ModelMesh mesh = read.ok() ? std::move( read.mesh ) : pliant_demos::makeBunnyLike();
	pliant_demos::fitHeight( mesh, 1.0f );
	const MeshView view{ mesh.positions.data(), mesh.positions.size() / 3, 3, mesh.indices.data(), mesh.indices.size() / 3 };
	return Shape{ name, BodyTemplate::build( view, settings ).value };
#else
	const test::Mesh mesh = test::makeGlob( 0.5, 40 );
	return Shape{ "Glob", BodyTemplate::build( mesh.view(), settings ).value };
#endif
}

/// Of all numbers of levels and values of keepMass, those whose first cut is nearest to the paper's.
Adaptivity nearestToPaper( const Lattice& lattice )
{
	Adaptivity best;
	int distance = lattice.cellCount();
	for ( int levels = 1; levels <= kMaxCoarseLevels; ++levels )
	{
		const Octree octree = buildOctree( lattice, levels );
		for ( int twentieths = 1; twentieths <= 20; ++twentieths )
		{
			Adaptivity settings;
			settings.coarseLevels = levels;
			settings.keepMass = 0.05f * float( twentieths );
			const int away = std::abs( firstCut( octree, settings ).count() - kPaperNodes );
			if ( away < distance )
			{
				distance = away;
				best = settings;
			}
		}
	}
	return best;
}

struct Timed
{
	int nodes = 0;
	double ms = 0.0;
};

Timed timeStep( const std::shared_ptr<const Lattice>& lattice, const Material& material, const Adaptivity& adaptivity )
{
	const std::unique_ptr<Body> body = std::move( Body::create( lattice, material, {}, nullptr, adaptivity ).value );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->nodes().v.set( i, 0.1f * body->nodes().x0.get( i ) );
	}
	const double seconds = processorSecondsOf( [&body] {
		body->accelerateTowardGoals( kTimedStep, 0.5f, nullptr );
		body->integrate( kTimedStep );
	} );
	return Timed{ body->nodeCount(), 1e3 * seconds };
}

/// A frame of 1/60 s of a body that lies on a plane, including its skin, ms.
double timeFrame( const std::shared_ptr<const BodyTemplate>& shape, Material material, const Adaptivity& adaptivity )
{
	test::SoftWorld scene;
	scene.addFloor();
	material.youngsModulus = 2e4f;
	SoftBodyResult made = SoftBody::create(
		shape, btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( 0.55 ), 0 ) ), material, adaptivity );
	scene.soft.push_back( std::move( made.value ) );
	SoftBody& body = *scene.soft.back();
	scene.world.addSoftBody( &body );
	body.setActivationState( DISABLE_DEACTIVATION );
	scene.step( 120 );
	return 1e3 * processorSecondsOf( [&] {
		scene.step( 1 );
		body.surface();
	} );
}

} // namespace

void bunnyExperiment()
{
	const Shape shape = makeBunny();
	const auto lattice = std::make_shared<const Lattice>( shape.bodyTemplate->lattice() );
	const Adaptivity levels = nearestToPaper( *lattice );
	std::printf( "%s, %d cells; levels of detail: %d above the finest, a node from %.2f of its material. Processor time, one thread, ms; "
				 "frame: 1/60 s on a plane, skin made\n"
				 "  (in the paper, step alone: 2 248 nodes 59 ms, 207 nodes 3 ms)\n",
		shape.name.c_str(), lattice->cellCount(), levels.coarseLevels, double( levels.keepMass ) );
	for ( int w = 1; w <= 2; ++w )
	{
		Material material = test::explicitMaterial();
		material.regionHalfWidth = w;
		NodeState nodes = test::restNodes( *lattice );
		ReferenceMatcher reference( *lattice, material );
		const double naive = 1e3 * processorSecondsOf( [&] {
			reference.accelerate( nodes, MatchStep{ kTimedStep, 0.5f, 10.0f }, nullptr );
		} );
		const Timed fast = timeStep( lattice, material, Adaptivity{} ), adaptive = timeStep( lattice, material, levels );
		const double fastFrame = timeFrame( shape.bodyTemplate, material, Adaptivity{} ),
					 frame = timeFrame( shape.bodyTemplate, material, levels );
		std::printf( "w = %d   naive %d nodes: step %.3f | fast %d nodes: step %.4f, frame %.3f | with levels %d nodes: step %.4f, frame "
					 "%.3f (%.1f x less)\n",
			w, nodes.count, naive, fast.nodes, fast.ms, fastFrame, adaptive.nodes, adaptive.ms, frame, fastFrame / frame );
		printLimit( "step, naive / with levels", naive / adaptive.ms, "x", kLeastOverNaive[w - 1], true );
		printLimit( "step, our own fast LSM / with levels", fast.ms / adaptive.ms, "x", kLeastOverFast, true );
	}
}

void nodeExperiment()
{
	struct Blob
	{
		int cells, coarseLevels;
	};
	std::puts( "One step and its integration of a lumpy body with levels, processor time, one thread" );
	for ( int w = 1; w <= 2; ++w )
	{
		for ( const Blob& blob : { Blob{ 70, 2 }, Blob{ 70, 1 }, Blob{ 85, 1 }, Blob{ 105, 1 } } )
		{
			const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( blob.cells, 1.0f, 1 ) );
			Material material = test::explicitMaterial();
			material.regionHalfWidth = w;
			Adaptivity adaptivity;
			adaptivity.coarseLevels = blob.coarseLevels;
			const Timed timed = timeStep( lattice, material, adaptivity );
			char title[100];
			std::snprintf( title, sizeof( title ), "w = %d, %d cells, %d nodes: a node", w, lattice->cellCount(), timed.nodes );
			printLimit( title, 1e6 * timed.ms / timed.nodes, "ns", kMostPerNode, false );
		}
	}

	std::puts( "\nSummation nodes a region (in the paper 6 at eps 0.5), and members beside them\n"
			   "                                        eps 0              0.25               0.5                 1" );
	const auto palm = test::makeShapeLattice( { 32, 32, 56 }, 1.0f, []( int x, int y, int z ) {
		const bool isFinger = ( y == 15 || y == 16 ) && x % 6 >= 1 && x % 6 <= 2 && x < 30;
		return z < 32 || ( isFinger && z < 56 );
	} );
	const Lattice blob = test::makeBlobLattice( 34, 1.0f, 5 );
	for ( const auto& [name, lattice] :
		{ std::pair<const char*, const Lattice*>( "palm with thin fingers", &palm ), { "lumpy body", &blob } } )
	{
		for ( int w = 1; w <= 3; ++w )
		{
			std::printf( "  %-24s w = %d", name, w );
			for ( const float eps : { 0.0f, 0.25f, 0.5f, 1.0f } )
			{
				Material material = test::explicitMaterial();
				material.regionHalfWidth = w;
				Adaptivity adaptivity = steinemannAdaptivity( 3 );
				adaptivity.intervalSlack = eps;
				const std::shared_ptr<const LevelBase> base = buildLevelBase( *lattice, material, adaptivity );
				const Cut cut = firstCut( base->octree, adaptivity );
				const LevelRegions regions = buildLevelRegions( RegionInput{ *base, *lattice, material, adaptivity }, cut );
				std::printf( "   %7.2f of %6.1f", double( regions.plan->term.size() ) / cut.count(),
					double( regions.matrix->member.size() ) / cut.count() );
			}
			std::puts( "" );
		}
	}
}

} // namespace pliant::experiment
