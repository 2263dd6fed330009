// The core step on bodies that are not blocks: a Glob of metaballs, and the Stanford bunny if PLIANT_BUNNY names its OFF file
// (demos/fetch_models.sh downloads it: models/data/meshes/bunny00.off).

#include "lattice/test_meshes.h"
#include "matching/step/lattice_matcher.h"
#include "pliant/body_template.h"
#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/memory_in_use.h"

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace pliant {
namespace {

struct Triangles
{
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;
};

/// A plain OFF file of triangles without comments, as the bunny's is; empty for any other file.
Triangles readPlainOff( const char* path )
{
	Triangles mesh;
	std::ifstream file( path );
	std::string magic;
	std::size_t vertices = 0, faces = 0, edges = 0;
	if ( !( file >> magic >> vertices >> faces >> edges ) || magic != "OFF" )
	{
		return {};
	}
	for ( std::size_t i = 0; i < 3 * vertices; ++i )
	{
		float value = 0.0f;
		file >> value;
		mesh.positions.push_back( value );
	}
	for ( std::size_t i = 0; i < faces; ++i )
	{
		std::size_t corners = 0;
		std::uint32_t a = 0, b = 0, c = 0;
		file >> corners >> a >> b >> c;
		if ( !file || corners != 3 )
		{
			return {};
		}
		mesh.indices.insert( mesh.indices.end(), { a, b, c } );
	}
	return mesh;
}

std::shared_ptr<const BodyTemplate> build( const Triangles& mesh )
{
	MeshView view;
	view.positions = mesh.positions.data();
	view.vertexCount = mesh.positions.size() / 3;
	view.indices = mesh.indices.data();
	view.triangleCount = mesh.indices.size() / 3;
	LatticeSettings settings;
	settings.targetCells = 2248; // the bunny of Ohta et al. 2009
	settings.skinning = Skinning::None;
	return BodyTemplate::build( view, settings ).value;
}

void stepBody( benchmark::State& state, const BodyTemplate& body, int halfWidth )
{
	Material material = test::explicitMaterial();
	material.regionHalfWidth = halfWidth;
	NodeState nodes = test::restNodes( body.lattice() );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.v.set( i, Vec3( 0, 0, 1 ).cross( nodes.x0.get( i ) ) );
		nodes.x.set( i, nodes.x0.get( i ) * 1.02f );
	}
	const std::size_t memoryBefore = test::memoryInUse();
	LatticeMatcher matcher( body.lattice(), material );
	const float h = 1.0f / 240.0f;
	for ( auto _ : state )
	{
		matcher.accelerate( nodes, MatchStep{ h, 0.5f, 10.0f, 1.0f, 0.0f }, nullptr );
		for ( int i = 0; i < nodes.padded; ++i )
		{
			nodes.x.x[i] += h * nodes.v.x[i];
			nodes.x.y[i] += h * nodes.v.y[i];
			nodes.x.z[i] += h * nodes.v.z[i];
		}
	}
	state.SetLabel( matcher.usesBoxSums() ? "box sums" : "table" );
	state.counters["nodes"] = nodes.count;
	state.counters["ns_per_node"] = benchmark::Counter(
		double( nodes.count ) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert );
	state.counters["bytes_per_node"] = double( test::memoryInUse() - memoryBefore ) / nodes.count;
}

void globStep( benchmark::State& state )
{
	const test::Mesh mesh = test::makeGlob( 0.5, 40 );
	Triangles triangles;
	triangles.positions = mesh.positions;
	triangles.indices = mesh.indices;
	stepBody( state, *build( triangles ), int( state.range( 0 ) ) );
}
BENCHMARK( globStep )->ArgName( "w" )->DenseRange( 1, 3 );

void bunnyStep( benchmark::State& state )
{
	const char* const path = std::getenv( "PLIANT_BUNNY" );
	const Triangles triangles = path ? readPlainOff( path ) : Triangles{};
	if ( triangles.indices.empty() )
	{
		state.SkipWithError( "PLIANT_BUNNY does not name a triangle OFF file" );
		return;
	}
	stepBody( state, *build( triangles ), int( state.range( 0 ) ) );
}
BENCHMARK( bunnyStep )->ArgName( "w" )->DenseRange( 1, 3 );

} // namespace
} // namespace pliant
