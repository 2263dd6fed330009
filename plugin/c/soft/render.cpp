// Skins for renderers: tables for the GPU, sources and tangents of vertices, further meshes.

#include "pliant/c/render.h"
#include "c/handles.h"
#include "c/numbers.h"
#include "c/settings.h"
#include "pliant/render/gpu_surface.h"
#include "pliant/render/render_mesh.h"
#include "pliant/render/vertex_attributes.h"

#include <cstddef>

struct pliant_skin
{
	std::shared_ptr<const pliant::RenderMesh> mesh;
	std::unique_ptr<pliant::RenderSkin> skin;
};

namespace pliant::c {

namespace {

// The C records have the layout of the C++ records, whose arrays are passed to the caller.
static_assert( sizeof( pliant_skin_range ) == sizeof( SkinRange ) && sizeof( pliant_skin_influence ) == sizeof( SkinInfluence ) );
static_assert(
	sizeof( pliant_skin_corner ) == sizeof( SkinCorner ) && offsetof( pliant_skin_corner, next ) == offsetof( SkinCorner, next ) );
static_assert(
	sizeof( pliant_skin_vertex ) == sizeof( SkinVertex ) && offsetof( pliant_skin_vertex, first ) == offsetof( SkinVertex, first ) );
static_assert( offsetof( pliant_skin_vertex, rest_normal ) == offsetof( SkinVertex, restNormal ) );
static_assert( offsetof( pliant_skin_vertex, count ) == offsetof( SkinVertex, count ) );
static_assert( offsetof( pliant_skin_vertex, normal_shift ) == offsetof( SkinVertex, normalShift ) );
static_assert( offsetof( pliant_skin_vertex, corner ) == offsetof( SkinVertex, corner ) );
static_assert( sizeof( pliant_skin_mix ) == sizeof( SkinMix ) && offsetof( pliant_skin_mix, weight ) == offsetof( SkinMix, weight ) );
static_assert( sizeof( SkinOffset ) == 4 * sizeof( float ) );
static_assert( sizeof( pliant_vertex_source ) == sizeof( VertexSource ) );
static_assert( offsetof( pliant_vertex_source, weight ) == offsetof( VertexSource, weight ) );
static_assert( kSkinNone == PLIANT_SKIN_NONE && VertexSource::kInside == PLIANT_SOURCE_INSIDE );

using c::inC; // of surfaces

template <class T>
pliant_skin_array inC( const SkinArray<T>& array )
{
	return pliant_skin_array{ array.data, array.count, std::int32_t( sizeof( T ) ), array.version, array.changedSince,
		reinterpret_cast<const pliant_skin_range*>( array.changed ), array.changedCount, 0 };
}

pliant_gpu_surface inC( const GpuSurfaceView& view )
{
	pliant_gpu_surface c{};
	c.frame = view.frame;
	c.origin = vectorOf( view.origin );
	c.node_transforms = view.nodeTransforms;
	c.nodes = view.nodeCount;
	std::memcpy( c.offset_turn, view.offsetTurn, sizeof c.offset_turn );
	c.vertices = inC( view.vertices );
	c.influences = inC( view.influences );
	c.mixes = inC( view.mixes );
	c.corners = inC( view.corners );
	c.indices = inC( view.indices );
	c.node_of_cell = inC( view.nodeOfCell );
	c.offsets = inC( view.offsets );
	c.texture_coordinates = view.textureCoordinates;
	c.triangle_source = view.triangleSource;
	c.topology_version = view.topologyVersion;
	return c;
}

pliant_vertex_sources inC( const VertexSourceView& view )
{
	pliant_vertex_sources c{};
	c.topology_version = view.topologyVersion;
	c.sources = reinterpret_cast<const pliant_vertex_source*>( view.sources );
	c.vertices = view.vertexCount;
	return c;
}

pliant_tangents inC( const TangentView& view )
{
	pliant_tangents c{};
	c.topology_version = view.topologyVersion;
	c.tangents = view.tangents;
	c.vertices = view.vertexCount;
	c.frame = view.frame;
	return c;
}

/// Writes a view of a body. The view is computed only if it can be written.
template <class C, class F>
pliant_result view( const pliant_world* world, pliant_id body, C* out, std::uint32_t size, F&& viewOf )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requireSized( out, size );
		writeSized( inC( viewOf( soft ) ), out, size );
	} );
}

/// The same for a skin.
template <class C, class F>
pliant_result viewSkin( pliant_skin* skin, const pliant_world* world, pliant_id body, C* out, std::uint32_t size, F&& viewOf )
{
	return call( [&]() {
		requirePointers( skin );
		return view( world, body, out, size, [&]( const SoftBody& soft ) { return viewOf( *skin->skin, soft ); } );
	} );
}

/// Makes a skin of a mesh.
Status makeSkin( std::shared_ptr<const RenderMesh> mesh, pliant_skin** made )
{
	auto skin = RenderSkin::create( mesh );
	if ( skin.ok() )
	{
		*made = new pliant_skin{ std::move( mesh ), std::move( skin.value ) };
	}
	return skin.status;
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_body_get_gpu_surface( const pliant_world* world, pliant_id body, pliant_gpu_surface* surface, uint32_t size )
{
	return view( world, body, surface, size, []( const SoftBody& soft ) { return soft.gpuSurface(); } );
}

pliant_result pliant_body_get_vertex_sources( const pliant_world* world, pliant_id body, pliant_vertex_sources* sources, uint32_t size )
{
	return view( world, body, sources, size, []( const SoftBody& soft ) { return vertexSources( soft ); } );
}

pliant_result pliant_body_get_tangents( const pliant_world* world, pliant_id body, pliant_tangents* out, uint32_t size )
{
	return view( world, body, out, size, []( const SoftBody& soft ) { return tangents( soft ); } );
}

pliant_result pliant_body_get_rest_tangents( const pliant_world* world, pliant_id body, pliant_tangents* out, uint32_t size )
{
	return view( world, body, out, size, []( const SoftBody& soft ) { return restTangents( soft ); } );
}

pliant_result pliant_skin_create( const pliant_template* of, const pliant_mesh* mesh, pliant_skin** made )
{
	return call( [&]() {
		requirePointers( of, made );
		auto bound = RenderMesh::bind( of->shared, takeMesh( mesh ) );
		return bound.ok() ? makeSkin( std::move( bound.value ), made ) : bound.status;
	} );
}

pliant_result pliant_skin_copy( const pliant_skin* of, pliant_skin** made )
{
	return call( [&]() {
		requirePointers( of, made );
		return makeSkin( of->mesh, made );
	} );
}

void pliant_skin_destroy( pliant_skin* skin )
{
	delete skin;
}

pliant_result pliant_skin_get_surface(
	pliant_skin* skin, const pliant_world* world, pliant_id body, pliant_surface* surface, uint32_t size )
{
	return viewSkin( skin, world, body, surface, size, []( RenderSkin& of, const SoftBody& soft ) { return of.surface( soft ); } );
}

pliant_result pliant_skin_get_gpu_surface(
	pliant_skin* skin, const pliant_world* world, pliant_id body, pliant_gpu_surface* surface, uint32_t size )
{
	return viewSkin( skin, world, body, surface, size, []( RenderSkin& of, const SoftBody& soft ) { return of.gpuSurface( soft ); } );
}

pliant_result pliant_skin_get_vertex_sources(
	pliant_skin* skin, const pliant_world* world, pliant_id body, pliant_vertex_sources* sources, uint32_t size )
{
	return viewSkin( skin, world, body, sources, size, []( RenderSkin& of, const SoftBody& soft ) { return of.vertexSources( soft ); } );
}
