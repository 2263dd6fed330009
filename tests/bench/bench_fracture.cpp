// Fracture: what the test of all links costs beside the step, and what an event costs by its parts. A block of side^3 cells.

#include "body/body.h"
#include "body/breaking.h"
#include "support/block_body.h"
#include "support/test_world.h"
#include "world/node_shape.h"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace pliant {
namespace {

constexpr float kStep = 1.0f / 240.0f;

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
	body->setFracture( fracture );
	for ( auto _ : state )
	{
		body->testLinks( kStep );
	}
	state.counters["ns_per_node"] =
		benchmark::Counter( double( body->nodeCount() ) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
}

/// All of an event's work in the core, for a crack through the middle that parts the body in two, or one that does not.
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
		shape.update( body->nodes(), Vec3::Zero() );
		benchmark::DoNotOptimize( shape.getNumChildShapes() );
	}
}

BENCHMARK( fractureTest )->Arg( 6 )->Arg( 13 )->Arg( 27 )->Unit( benchmark::kMicrosecond );
BENCHMARK( fractureApart )->ArgsProduct( { { 4, 13, 27 }, { 0, 1 } } )->Unit( benchmark::kMicrosecond );
BENCHMARK( fractureShape )->Arg( 4 )->Arg( 13 )->Arg( 27 )->Unit( benchmark::kMicrosecond );

} // namespace
} // namespace pliant
