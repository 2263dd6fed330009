#include "c/constants.h"
#include "c/handles.h"
#include "c/settings.h"
#include "pliant/io/snapshot.h"
#include "pliant/task_runner.h"

namespace pliant::c {

namespace {

Status giveTemplate( const Result<std::shared_ptr<const BodyTemplate>>& result, pliant_template** made )
{
	if ( result.ok() )
	{
		*made = new pliant_template{ result.value };
	}
	return result.status;
}

struct Progress
{
	std::int32_t ( *function )( float fraction, void* context );
	void* context;
};

bool reportProgress( float fraction, void* context )
{
	const Progress& progress = *static_cast<const Progress*>( context );
	return progress.function( fraction, progress.context ) != 0;
}

pliant_template_info inC( const BodyTemplate& from )
{
	const BuildReport& report = from.report();
	pliant_template_info full{};
	full.cells = from.cellCount();
	full.links = from.linkCount();
	full.cell_size = from.cellSize();
	full.vertices = from.vertexCount();
	full.triangles = from.triangleCount();
	full.welded_vertices = report.weldedVertices;
	full.flipped_triangles = report.flippedTriangles;
	full.dropped_triangles = report.droppedTriangles;
	full.open_edges = report.openEdges;
	full.non_manifold_edges = report.nonManifoldEdges;
	full.shells = report.shells;
	full.shell_cells = report.shellCells;
	full.components = report.components;
	full.volume = report.volume;
	for ( int k = 0; k < 3; ++k )
	{
		full.mass_centre[k] = from.massCentre()[k];
	}
	return full;
}

} // namespace

MeshView takeMesh( const pliant_mesh* mesh )
{
	requirePointers( mesh );
	pliant_mesh full{};
	readSized( mesh, full );
	MeshView view;
	view.positions = full.positions;
	view.vertexCount = std::size_t( full.vertex_count );
	view.positionStride = full.position_stride;
	view.indices = full.indices;
	view.triangleCount = std::size_t( full.triangle_count );
	view.textureCoordinates = full.texture_coordinates;
	view.submeshOfTriangle = full.submesh_of_triangle;
	view.tangents = full.tangents;
	return view;
}

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_mesh_init( pliant_mesh* mesh, uint32_t size )
{
	pliant_mesh empty{};
	empty.position_stride = 3;
	return initSized( empty, mesh, size );
}

pliant_result pliant_template_build( const pliant_mesh* mesh, const pliant_lattice_settings* settings, pliant_template** made )
{
	return call( [&]() {
		const MeshView view = takeMesh( mesh );
		pliant_lattice_settings full = defaultLattice();
		auto lattice = take<LatticeSettings>( settings, full );
		requirePointers( made );
		rejectIf(
			full.threads < 1 || full.threads > kMostThreads, PLIANT_BAD_SETTINGS, "pliant_lattice_settings::threads must lie in 1 to 64." );
		std::unique_ptr<TaskRunner> runner;
		if ( full.threads > 1 )
		{
			runner = createThreadPool( full.threads );
			lattice.runner = runner.get();
		}
		Progress progress{ full.progress, full.progress_context };
		if ( full.progress )
		{
			lattice.progress = &reportProgress;
			lattice.progressContext = &progress;
		}
		return giveTemplate( BodyTemplate::build( view, lattice ), made );
	} );
}

pliant_result pliant_template_scaled( const pliant_template* of, float factor, pliant_template** made )
{
	return call( [&]() {
		requirePointers( of, made );
		return giveTemplate( of->shared->scaled( factor ), made );
	} );
}

void pliant_template_release( pliant_template* released )
{
	delete released;
}

pliant_result pliant_template_get_info( const pliant_template* of, pliant_template_info* info, uint32_t size )
{
	return call( [&]() {
		requirePointers( of );
		writeSized( inC( *of->shared ), info, size );
	} );
}

pliant_result pliant_template_save( const pliant_template* saved, pliant_buffer* bytes )
{
	return call( [&]() {
		requirePointers( saved, bytes );
		return offer( saveTemplate( *saved->shared ), &bytes->bytes );
	} );
}

pliant_result pliant_template_load( const void* data, uint64_t byte_count, pliant_template** made )
{
	return call( [&]() {
		requirePointers( data, made );
		return giveTemplate( loadTemplate( BytesView( static_cast<const std::byte*>( data ), std::size_t( byte_count ) ) ), made );
	} );
}
