// Crack surfaces: building a template's cell complex, opening cracks, settling what is bound, taking pieces.

#include "lattice/build_lattice.h"
#include "lattice/test_meshes.h"
#include "surface/cell_complex.h"
#include "surface/crack_surface.h"

#include <benchmark/benchmark.h>

namespace pliant {
namespace {

/// About the bunny's numbers: 5 000 triangles, 2 000 cells.
struct Broken
{
	test::Mesh mesh = test::makeBumpySphere( 1.0, 0.2, 40, 64 );
	LatticeSettings build;
	Result<LatticeBuild> built;
	SkinBinding skinning;
	CrackSettings settings;
	std::shared_ptr<const CellComplex> complex;
	std::vector<std::vector<std::uint32_t>> slabs; ///< eight, along x
	std::vector<std::uint32_t> faces;              ///< between them

	explicit Broken( bool isNoisy )
	{
		build.targetCells = 2000;
		built = buildLattice( mesh.view(), build );
		skinning = bindSkin( mesh.view(), lattice(), built.value.weldedVertex, Skinning::NearbyNodes );
		settings.noiseAmplitude = isNoisy ? 0.3f : 0.0f;
		settings.subdivision = isNoisy ? 2 : 1;
		makeComplex();
		slabs.resize( 8 );
		for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice().cellCount() ); ++cell )
		{
			slabs[slabOf( cell )].push_back( cell );
		}
		for ( std::uint32_t f = 0; f < complex->face.size(); ++f )
		{
			if ( slabOf( complex->face[f].cellA ) != slabOf( complex->face[f].cellB ) )
			{
				faces.push_back( f );
			}
		}
	}

	const Lattice& lattice() const { return built.value.lattice; }
	void makeComplex() { complex = CellComplex::build( mesh.view(), lattice(), skinning, build, settings ).value; }
	std::size_t slabOf( std::uint32_t cell ) const { return std::size_t( lattice().coordinate[cell].x() * 8 / lattice().extent.x() ); }
};

void buildCellComplex( benchmark::State& state )
{
	Broken body( state.range( 0 ) != 0 );
	for ( auto _ : state )
	{
		body.makeComplex();
	}
	state.counters["cells"] = double( body.complex->cellCount() );
	state.counters["MB"] = 1e-6 * double( body.complex->bytes() );
}
BENCHMARK( buildCellComplex )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMillisecond );

void openCracks( benchmark::State& state )
{
	const Broken body( state.range( 0 ) != 0 );
	for ( auto _ : state )
	{
		state.PauseTiming();
		CrackSurface surface( body.complex );
		state.ResumeTiming();
		surface.breakFaces( body.faces );
		benchmark::DoNotOptimize( surface.vertexCount() );
	}
	state.SetItemsProcessed( std::int64_t( body.faces.size() ) * state.iterations() ); // faces
}
BENCHMARK( openCracks )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

void settleCracks( benchmark::State& state )
{
	const Broken body( state.range( 0 ) != 0 );
	for ( auto _ : state )
	{
		state.PauseTiming();
		CrackSurface surface( body.complex );
		surface.breakFaces( body.faces );
		state.ResumeTiming();
		surface.settle();
		benchmark::DoNotOptimize( surface.vertexCount() );
	}
	state.SetItemsProcessed( std::int64_t( body.faces.size() ) * state.iterations() );
}
BENCHMARK( settleCracks )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

void takePieces( benchmark::State& state )
{
	const Broken body( state.range( 0 ) != 0 );
	CrackSurface surface( body.complex );
	surface.breakFaces( body.faces );
	for ( auto _ : state )
	{
		for ( const auto& slab : body.slabs )
		{
			benchmark::DoNotOptimize( surface.piece( slab ).vertexCount() );
		}
	}
}
BENCHMARK( takePieces )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

} // namespace
} // namespace pliant
