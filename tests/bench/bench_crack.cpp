// Crack surfaces: building a template's cell complex, opening cracks, drawing them, pieces from their own faces, skins and whole frames.

#include "lattice/build/build_lattice.h"
#include "lattice/test_meshes.h"
#include "support/block_body.h"
#include "support/drawn_cracks.h"
#include "support/explicit_material.h"
#include "support/test_world.h"
#include "surface/crack_complex/cell_complex.h"
#include "surface/crack_mesh/crack_view.h"

#include <benchmark/benchmark.h>

#include <pliant/render/gpu_surface.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace pliant {
namespace {

/// As large as the bunny: 5 000 triangles, 2 000 cells.
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

	explicit Broken( bool isNoisy, int cells = 2000 )
	{
		build.targetCells = cells;
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
}
BENCHMARK( buildCellComplex )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMillisecond );

/// Both the sides of the cracks and what they follow.
void openCracks( benchmark::State& state )
{
	const Broken body( state.range( 0 ) != 0 );
	const auto patches = CrackPatches::make( body.complex, nullptr );
	for ( auto _ : state )
	{
		state.PauseTiming();
		CrackSides sides( patches );
		state.ResumeTiming();
		sides.breakFaces( body.faces );
		benchmark::DoNotOptimize( sides.sideOf( 0 ) );
	}
	state.SetItemsProcessed( std::int64_t( body.faces.size() ) * state.iterations() ); // faces
}
BENCHMARK( openCracks )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

/// The whole body, once its eight slabs are separated by cracks.
void drawCracks( benchmark::State& state )
{
	const Broken body( state.range( 0 ) != 0 );
	CrackSides sides( CrackPatches::make( body.complex, nullptr ) );
	sides.breakFaces( body.faces );
	std::vector<std::uint32_t> all( body.complex->cellCount() );
	std::iota( all.begin(), all.end(), 0u );
	CrackGatherer gatherer;
	CrackView view;
	for ( auto _ : state )
	{
		gatherer.gather( sides, all, Vec3::Zero(), view );
		benchmark::DoNotOptimize( view.triangles.data() );
	}
}
BENCHMARK( drawCracks )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

/// Each slab from its own faces.
void takePieces( benchmark::State& state )
{
	const Broken body( state.range( 0 ) != 0 );
	const auto patches = CrackPatches::make( body.complex, nullptr );
	std::vector<std::vector<std::uint32_t>> faces( body.slabs.size() );
	for ( const std::uint32_t f : body.faces )
	{
		faces[body.slabOf( body.complex->face[f].cellA )].push_back( f );
		faces[body.slabOf( body.complex->face[f].cellB )].push_back( f );
	}
	for ( auto _ : state )
	{
		for ( std::size_t k = 0; k < faces.size(); ++k )
		{
			CrackSides sides( patches );
			sides.breakFaces( faces[k] );
			CrackView view;
			CrackGatherer().gather( sides, body.slabs[k], Vec3::Zero(), view );
			benchmark::DoNotOptimize( view.triangles.data() );
		}
	}
}
BENCHMARK( takePieces )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

enum class Shown : int
{
	Whole,   ///< no crack yet: the input's vertices
	Placed,  ///< cracked across the middle, all cuts interpolated that no crack divides
	Blended, ///< the same with every vertex blended from its cells
	AsOne    ///< the same as Placed, panels as in the input
};

/// The skin of a body of 500 cells that is rotated and slightly bent.
void crackedSkin( benchmark::State& state )
{
	const Shown shown = Shown( state.range( 0 ) );
	const Broken body( true, 500 );
	test::DrawnCracks surface( shown == Shown::AsOne ? body.complex : test::withAllCuts( body.complex ) );
	std::vector<std::uint32_t> across;
	std::copy_if( body.faces.begin(), body.faces.end(), std::back_inserter( across ), [&body]( std::uint32_t f ) {
		return body.slabOf( body.complex->face[f].cellA ) / 4 != body.slabOf( body.complex->face[f].cellB ) / 4;
	} );
	surface.breakFaces( across );
	SkinBinding binding = shown == Shown::Whole ? body.skinning : surface.binding();
	if ( shown == Shown::Blended )
	{
		binding.placed.clear();
		binding.blended.clear();
		binding.shading.clear();
		binding.shadedTriangles = 0;
	}
	NodeState nodes = test::restNodes( body.lattice() );
	std::vector<float> rotations( 4 * std::size_t( nodes.count ) );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Quaternionf turn( Eigen::AngleAxisf( 0.2f * nodes.x0.z[i], Vec3::UnitZ() ) );
		nodes.x.set( i, turn * nodes.x0.get( i ) );
		Eigen::Map<Eigen::Vector4f>( rotations.data() + 4 * i ) = turn.coeffs();
	}
	const SkinTriangles triangles = shown == Shown::Whole ? SkinTriangles{ body.mesh.indices.data(), int( body.mesh.triangleCount() ) }
														  : surface.view().shown();
	SkinScratch scratch;
	std::vector<float> positions( 3 * binding.restPosition.size() ), normals( positions.size() );
	for ( auto _ : state )
	{
		skin( binding, nodes, SkinPose{ .rotations = rotations.data() }, triangles, scratch, positions.data(), normals.data() );
		benchmark::DoNotOptimize( normals.data() );
		benchmark::ClobberMemory();
	}
	state.counters["vertices"] = double( binding.restPosition.size() );
	state.counters["placed"] = double( binding.placed.size() );
	state.counters["triangles"] = triangles.count;
}
BENCHMARK( crackedSkin )->ArgName( "shown" )->DenseRange( 0, 3 )->Unit( benchmark::kMicrosecond );

/// A frame of a body of 2 000 cells that turns, stays in one piece and gets a cut of a radius in mm in each frame. `gpu`: its tables are
/// read.
void crackingFrame( benchmark::State& state )
{
	constexpr int kFrames = 24; // then a new body
	const test::Mesh mesh = test::makeBumpySphere( 1.0, 0.2, 40, 64 );
	LatticeSettings settings;
	settings.targetCells = 2000;
	const auto shape = BodyTemplate::build( mesh.view(), settings ).value;
	std::unique_ptr<test::SoftWorld> scene;
	SoftBody* body = nullptr;
	int frame = kFrames, links = 0, frames = 0;
	double cracks = 0.0, skins = 0.0;
	for ( auto _ : state )
	{
		if ( frame == kFrames )
		{
			state.PauseTiming();
			scene = std::make_unique<test::SoftWorld>();
			scene->world.setGravity( btVector3( 0, 0, 0 ) );
			body = scene->add( shape, btVector3( 0, 0, 0 ), test::explicitMaterial() );
			static_cast<void>( body->prepareCracks() );
			static_cast<void>( body->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, 2, 0 ) ) );
			scene->step( 1 );
			body->surface();
			frame = 0;
			state.ResumeTiming();
		}
		const btScalar height = btScalar( 0.06 ) * btScalar( frame - kFrames / 2 );
		const btVector3 to( btScalar( std::cos( 2.4 * frame ) ), 0, btScalar( std::sin( 2.4 * frame ) ) );
		const btVector3 at = body->massCentre() + btVector3( 0, height, 0 ) + btScalar( 0.6 ) * to;
		links += body->cutPlane( at, btVector3( 0, 1, 0 ), btScalar( 0.001 ) * btScalar( state.range( 1 ) ) ); // 0: none
		scene->step( 1 );
		state.range( 0 ) != 0 ? benchmark::DoNotOptimize( body->gpuSurface().frame ) : benchmark::DoNotOptimize( body->surface().frame );
		cracks += scene->world.stepReport().fracture;
		skins += scene->world.stepReport().skinning;
		++frame;
		++frames;
	}
	state.counters["links"] = double( links ) / frames;
	state.counters["cracks_us"] = 1e6 * cracks / frames;
	state.counters["skins_us"] = 1e6 * skins / frames;
	state.counters["bodies"] = scene->world.softBodyCount();
}
BENCHMARK( crackingFrame )
	->ArgNames( { "gpu", "cut" } )
	->ArgsProduct( { { 0, 1 }, { 0, 80, 250 } } )
	->Iterations( 240 )
	->Unit( benchmark::kMicrosecond );

} // namespace
} // namespace pliant
