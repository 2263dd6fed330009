// Fracture: the cost of testing all links compared with the step, and the cost of an event by its parts. A block of side^3 cells.

#include "body/body.h"
#include "body/breaking.h"
#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/test_world.h"
#include "world/shape/node_shape.h"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace pliant {
namespace {

constexpr float kBreakStep = 1.0f / 240.0f;

std::vector<CellLink> linksAcross( const Lattice& lattice, float offset )
{
	std::vector<CellLink> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( i < j && ( lattice.restCentre[i].x() < offset ) != ( lattice.restCentre[j].x() < offset ) )
			{
				links.push_back( CellLink{ i, j } );
			}
		}
	}
	return links;
}

std::unique_ptr<Body> block( benchmark::State& state )
{
	const int side = int( state.range( 0 ) );
	std::unique_ptr<Body> body = test::makeBlock( side, side, side, 0.05f );
	state.counters["nodes"] = body->nodeCount();
	return body;
}

void fractureTest( benchmark::State& state )
{
	const std::unique_ptr<Body> body = block( state );
	Fracture fracture;
	fracture.rule = BreakRule::Distance;
	static_cast<void>( body->setFracture( fracture ) );
	for ( auto _ : state )
	{
		body->testLinks( kBreakStep );
	}
	state.counters["ns_per_node"] = benchmark::Counter(
		double( body->nodeCount() ) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
}

/// All of an event's work in the core, for a crack through the middle that separates the body in two, or one that does not.
void fractureApart( benchmark::State& state )
{
	const bool parts = state.range( 1 ) != 0;
	const std::unique_ptr<Body> first = block( state );
	std::vector<CellLink> links = linksAcross( first->lattice(), 0.01f );
	if ( !parts )
	{
		links.resize( links.size() / 2 );
	}
	for ( auto _ : state )
	{
		state.PauseTiming();
		std::unique_ptr<Body> body = block( state );
		body->breakLinks( links );
		BreakReport report;
		state.ResumeTiming();
		std::vector<BodyPiece> pieces = body->breakApart( report, 1000 );
		state.PauseTiming();
		benchmark::DoNotOptimize( pieces.data() );
		pieces.clear();
		body.reset();
		state.ResumeTiming();
	}
}

/// Bullet's shape for a new piece.
void fractureShape( benchmark::State& state )
{
	const std::unique_ptr<Body> body = block( state );
	for ( auto _ : state )
	{
		NodeShape shape( *body );
		shape.place( body->nodes(), Vec3::Zero() );
		benchmark::DoNotOptimize( shape.getNumChildShapes() );
	}
}

/// A block of 2 197 cells thrown at the floor at 20 m/s, an edge first (a flat impact is even, and breaks little), drawn in every frame; E
/// = 2 MPa. All fracture work: tests, changed links, regions, new bodies, and the faces, default or flat. At a strain of 0.007 there are
/// 134 pieces by distance, at 0.009 60: any strain that makes 50 or more is a fair case of a block that shatters. Each frame counts with
/// its shortest time of all runs, and the worst of these is reported.
void fractureThrown( benchmark::State& state )
{
	constexpr int kFrames = 60;
	std::vector<double> breaking( kFrames, 1e9 ), drawing( kFrames, 1e9 ), whole( kFrames, 1e9 );
	CrackSettings cracks;
	if ( state.range( 3 ) != 0 )
	{
		cracks.noiseAmplitude = 0.0f;
		cracks.subdivision = 1;
	}
	const auto cube = test::cubeTemplate( 0.05f * 13, 13, cracks );
	int pieces = 0, links = 0, vertices = 0;
	for ( auto _ : state )
	{
		test::SoftWorld scene;
		scene.world.setThreadCount( int( state.range( 2 ) ) );
		scene.addBoxFloor();
		Material material = state.range( 4 ) != 0 ? Material() : test::explicitMaterial();
		material.youngsModulus = 2e6f;
		material.rigidStrain = state.range( 4 ) != 0 ? 0.1f : 0.0f;
		SoftBody* const body = scene.add(
			cube, btVector3( 0, btScalar( 0.7 ), 0 ), material, btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.3 ) ) );
		Fracture fracture;
		fracture.rule = BreakRule( state.range( 0 ) );
		fracture.breakStrain = 1e-3f * float( state.range( 1 ) );
		fracture.shardSize = 0.14f;
		static_cast<void>( body->setFracture( fracture ) );
		static_cast<void>( body->setVelocities( btVector3( 1, -20, 0 ), btVector3( 1, 2, 1 ) ) );
		body->surface();
		links = 0;
		for ( int frame = 0; frame < kFrames; ++frame )
		{
			scene.step( 1 );
			const double before = scene.world.stepReport().fracture;
			for ( int k = 0; k < scene.world.softBodyCount(); ++k )
			{
				benchmark::DoNotOptimize( scene.world.softBody( k )->surface().positions );
			}
			breaking[std::size_t( frame )] = std::min( breaking[std::size_t( frame )], before );
			whole[std::size_t( frame )] = std::min( whole[std::size_t( frame )], scene.world.stepReport().total );
			drawing[std::size_t( frame )] = std::min( drawing[std::size_t( frame )], scene.world.stepReport().fracture - before );
			links += scene.world.stepReport().brokenLinks;
		}
		pieces = scene.world.softBodyCount();
		vertices = 0;
		for ( int k = 0; k < pieces; ++k )
		{
			vertices += int( scene.world.softBody( k )->surface().vertexCount );
		}
	}
	double worst = 0.0;
	for ( std::size_t frame = 0; frame < std::size_t( kFrames ); ++frame )
	{
		worst = std::max( worst, breaking[frame] + drawing[frame] );
	}
	state.counters["pieces"] = pieces;
	state.counters["links"] = links;
	state.counters["vertices"] = vertices;
	state.counters["worst_breaking_ms"] = 1e3 * *std::max_element( breaking.begin(), breaking.end() );
	state.counters["worst_faces_ms"] = 1e3 * *std::max_element( drawing.begin(), drawing.end() );
	state.counters["worst_frame_ms"] = 1e3 * worst;
	state.counters["worst_step_ms"] = 1e3 * *std::max_element( whole.begin(), whole.end() );
}

BENCHMARK( fractureThrown )
	->ArgNames( { "rule", "milli_strain", "threads", "flat", "implicit" } )
	->Args( { 1, 7, 1, 0, 0 } )
	->Args( { 1, 9, 1, 0, 0 } )
	->Args( { 2, 10, 1, 0, 0 } )
	->Args( { 3, 10, 1, 0, 0 } )
	->Args( { 1, 7, 2, 0, 0 } )
	->Args( { 2, 10, 2, 0, 0 } )
	->Args( { 1, 7, 1, 1, 0 } )
	->Args( { 2, 10, 1, 1, 0 } )
	->Args( { 3, 10, 1, 0, 1 } )
	->Iterations( 5 )
	->Unit( benchmark::kMillisecond );
BENCHMARK( fractureTest )->Arg( 6 )->Arg( 13 )->Arg( 27 )->Unit( benchmark::kMicrosecond );
BENCHMARK( fractureApart )->ArgsProduct( { { 4, 13, 27 }, { 0, 1 } } )->Unit( benchmark::kMicrosecond );
BENCHMARK( fractureShape )->Arg( 4 )->Arg( 13 )->Arg( 27 )->Unit( benchmark::kMicrosecond );

} // namespace
} // namespace pliant
