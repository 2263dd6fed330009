#include "c/constants.h"
#include "c/handles.h"
#include "c/settings.h"
#include "pliant/io/snapshot.h"
#include "pliant/task_runner.h"

namespace pliant::c {

namespace {

pliant_result give( const Result<std::shared_ptr<const BodyTemplate>>& result, pliant_template** made )
{
	if ( result.ok() )
	{
		*made = new pliant_template{ result.value };
	}
	return resultOf( result.status );
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

} // namespace

pliant_result takeMesh( const pliant_mesh* mesh, MeshView& view )
{
	if ( !mesh )
	{
		return refuseNull();
	}
	pliant_mesh full{};
	if ( const pliant_result code = readSized( mesh, full ); code != PLIANT_OK )
	{
		return code;
	}
	view.positions = full.positions;
	view.vertexCount = std::size_t( full.vertex_count );
	view.positionStride = full.position_stride;
	view.indices = full.indices;
	view.triangleCount = std::size_t( full.triangle_count );
	view.textureCoordinates = full.texture_coordinates;
	view.submeshOfTriangle = full.submesh_of_triangle;
	view.tangents = full.tangents;
	return PLIANT_OK;
}

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_mesh_init( pliant_mesh* mesh, uint32_t size )
{
	pliant_mesh empty{};
	empty.position_stride = 3;
	return writeSized( empty, mesh, size );
}

pliant_result pliant_template_build( const pliant_mesh* mesh, const pliant_lattice_settings* settings, pliant_template** made )
{
	return call( [&]() -> pliant_result {
		MeshView view;
		LatticeSettings lattice;
		pliant_lattice_settings full;
		if ( pliant_result code = takeMesh( mesh, view ); code != PLIANT_OK || ( code = take( settings, lattice, full ) ) != PLIANT_OK )
		{
			return code;
		}
		if ( !made )
		{
			return refuseNull();
		}
		if ( full.threads < 1 || full.threads > kMostThreads )
		{
			return refuse( PLIANT_BAD_SETTINGS, "pliant_lattice_settings::threads must lie in 1 to 64." );
		}
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
		return give( BodyTemplate::build( view, lattice ), made );
	} );
}

pliant_result pliant_template_scaled( const pliant_template* of, float factor, pliant_template** made )
{
	return call( [&]() -> pliant_result { return of && made ? give( of->shared->scaled( factor ), made ) : refuseNull(); } );
}

void pliant_template_release( pliant_template* released )
{
	delete released;
}

pliant_result pliant_template_get_info( const pliant_template* of, pliant_template_info* info, uint32_t size )
{
	if ( !of )
	{
		return refuseNull();
	}
	const BodyTemplate& from = *of->shared;
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
	return writeSized( full, info, size );
}

pliant_result pliant_template_save( const pliant_template* saved, pliant_buffer* bytes )
{
	return call( [&]() -> pliant_result {
		if ( !saved || !bytes )
		{
			return refuseNull();
		}
		auto written = saveTemplate( *saved->shared );
		if ( written.ok() )
		{
			bytes->bytes.swap( written.value );
		}
		return resultOf( written.status );
	} );
}

pliant_result pliant_template_load( const void* data, uint64_t byte_count, pliant_template** made )
{
	return call( [&]() -> pliant_result {
		if ( !data || !made )
		{
			return refuseNull();
		}
		return give( loadTemplate( BytesView( static_cast<const std::byte*>( data ), std::size_t( byte_count ) ) ), made );
	} );
}
