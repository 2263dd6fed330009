// Skinning: the cost of a frame's surface, one thread, and of the binding, which is computed once.

#include "lattice/build/build_lattice.h"
#include "lattice/test_meshes.h"
#include "support/block_body.h"
#include "surface/skin/skinning.h"

#include <benchmark/benchmark.h>

#include <cmath>

namespace pliant {
namespace {

/// A bumpy sphere of about 20 000 vertices in about 2 000 cells, bent and rotated.
struct SkinCase
{
	test::Mesh mesh = test::makeBumpySphere( 0.5, 0.1, 101, 200 );
	LatticeBuild built;
	NodeState nodes;
	std::vector<float> rotations;

	SkinCase()
	{
		LatticeSettings settings;
		settings.targetCells = 2000;
		built = buildLattice( mesh.view(), settings ).value;
		nodes = test::restNodes( built.lattice );
		rotations.resize( 4 * std::size_t( nodes.count ) );
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Eigen::Quaternionf turn( Eigen::AngleAxisf( nodes.x0.z[i], Vec3::UnitZ() ) );
			nodes.x.set( i, turn * nodes.x0.get( i ) );
			Eigen::Map<Eigen::Vector4f>( rotations.data() + 4 * i ) = turn.coeffs();
		}
	}
	SkinTriangles triangles() const { return { mesh.indices.data(), int( mesh.triangleCount() ) }; }
};

/// kind: 0 nearby nodes, 1 trilinear.
void skinning( benchmark::State& state )
{
	const SkinCase it;
	const Skinning kind = state.range( 0 ) == 0 ? Skinning::NearbyNodes : Skinning::Trilinear;
	const SkinBinding binding = bindSkin( it.mesh.view(), it.built.lattice, it.built.weldedVertex, kind );
	const SkinTriangles triangles = it.triangles();
	SkinScratch scratch;
	std::vector<float> positions( it.mesh.positions.size() ), normals( it.mesh.positions.size() );
	for ( auto _ : state )
	{
		skin( binding, it.nodes, SkinPose{ .rotations = it.rotations.data() }, triangles, scratch, positions.data(), normals.data() );
		benchmark::DoNotOptimize( normals.data() );
		benchmark::ClobberMemory();
	}
	state.counters["vertices"] = double( it.mesh.vertexCount() );
	state.counters["cells"] = it.nodes.count;
	state.counters["nodes_per_vertex"] = double( binding.node.size() ) / double( it.mesh.vertexCount() );
}
BENCHMARK( skinning )->ArgName( "kind" )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

void bindingSkin( benchmark::State& state )
{
	const SkinCase it;
	for ( auto _ : state )
	{
		benchmark::DoNotOptimize( bindSkin( it.mesh.view(), it.built.lattice, it.built.weldedVertex, Skinning::NearbyNodes ) );
	}
	state.counters["vertices"] = double( it.mesh.vertexCount() );
}
BENCHMARK( bindingSkin )->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
