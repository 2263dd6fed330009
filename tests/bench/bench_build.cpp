// From a mesh of about 50 000 triangles to about 20 000 cells: the time that building adds to loading.

#include "lattice/build/build_lattice.h"
#include "lattice/hostile_meshes.h"
#include "pliant/task_runner.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

namespace {

struct BumpySphere
{
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;

	/// rings x segments quads, poles as rings at one position: welding closes them.
	BumpySphere( int rings, int segments, bool isOpen )
	{
		constexpr double kPi = std::numbers::pi;
		for ( int i = 0; i <= rings; ++i )
		{
			for ( int j = 0; j < segments; ++j )
			{
				const double polar = kPi * i / rings;
				const double around = 2.0 * kPi * j / segments;
				const double r = 1.0 + 0.2 * std::sin( polar ) * std::sin( polar ) * std::sin( 5.0 * polar ) * std::cos( 7.0 * around );
				const double flat = i == 0 || i == rings ? 0.0 : std::sin( polar );
				positions.insert( positions.end(),
					{ float( r * flat * std::cos( around ) ), float( r * flat * std::sin( around ) ), float( r * std::cos( polar ) ) } );
			}
		}
		for ( int i = isOpen ? 2 : 0; i < rings; ++i )
		{
			for ( int j = 0; j < segments; ++j )
			{
				const std::uint32_t a = std::uint32_t( i * segments + j );
				const std::uint32_t b = std::uint32_t( i * segments + ( j + 1 ) % segments );
				const std::uint32_t down = std::uint32_t( segments );
				indices.insert( indices.end(), { a, a + down, b + down, a, b + down, b } );
			}
		}
	}
};

void buildBumpySphere( benchmark::State& state )
{
	const BumpySphere mesh( 159, 160, state.range( 1 ) != 0 );
	pliant::MeshView view;
	view.positions = mesh.positions.data();
	view.vertexCount = mesh.positions.size() / 3;
	view.indices = mesh.indices.data();
	view.triangleCount = mesh.indices.size() / 3;
	const std::unique_ptr<pliant::TaskRunner> pool = pliant::createThreadPool( int( state.range( 0 ) ) );
	pliant::LatticeSettings settings;
	settings.targetCells = 20000;
	settings.runner = pool.get();
	int cells = 0;
	for ( auto _ : state )
	{
		const auto built = pliant::buildLattice( view, settings );
		cells = built.value.lattice.cellCount();
		if ( !built.ok() )
		{
			state.SkipWithError( built.status.sentence.c_str() );
		}
	}
	state.counters["triangles"] = double( view.triangleCount );
	state.counters["cells"] = cells;
}

BENCHMARK( buildBumpySphere )
	->ArgNames( { "threads", "open" } )
	->Args( { 1, 0 } )
	->Args( { 2, 0 } )
	->Args( { 2, 1 } )
	->Unit( benchmark::kMillisecond )
	->UseRealTime();

// Each malformed mesh of the tests, with any result.
void buildHostileMesh( benchmark::State& state, const pliant::test::HostileMesh& hostile )
{
	const pliant::test::Mesh mesh = hostile.make();
	pliant::LatticeSettings settings;
	settings.cellSize = hostile.cellSize;
	settings.shell = hostile.shell;
	for ( auto _ : state )
	{
		benchmark::DoNotOptimize( pliant::buildLattice( mesh.view(), settings ) );
	}
	state.SetLabel( hostile.name );
}

[[maybe_unused]] const bool kHostileAreRegistered = [] {
	for ( const pliant::test::HostileMesh& hostile : pliant::test::hostileMeshes() )
	{
		benchmark::RegisterBenchmark( ( "buildHostileMesh/" + hostile.name ).c_str(), [hostile]( benchmark::State& state ) {
			buildHostileMesh( state, hostile );
		} )->Unit( benchmark::kMillisecond );
	}
	return true;
}();

} // namespace
