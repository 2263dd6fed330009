#pragma once

// Functions for renderers in addition to pliant_body_get_surface: skinning on the graphics card, sources of vertices, tangents, further
// meshes on a body. The headers of pliant/render/ describe them; docs/guide/rendering.md has the shader.

#include "pliant/c/body.h"
#include "pliant/c/template.h"
#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Ends a list, and marks a vertex without triangles.
#define PLIANT_SKIN_NONE 0xffffffffu
/// pliant_vertex_source::vertex[0] of a vertex of a crack face.
#define PLIANT_SOURCE_INSIDE 0xffffffffu

/// Entries `first` to `first + count - 1` of an array.
typedef struct pliant_skin_range
{
	uint32_t first; ///< index of the first entry
	uint32_t count; ///< above 0
} pliant_skin_range;

/// An array to be copied into a buffer of the GPU: pliant::SkinArray. A copy of version `changed_since` needs the entries of `changed`
/// only; a copy of any other version except `version` needs all entries.
typedef struct pliant_skin_array
{
	const void* data;                 ///< `count` entries of `stride` bytes; null for none
	int32_t count;                    ///< entries
	int32_t stride;                   ///< bytes from one entry to the next
	uint32_t version;                 ///< changes when an entry or the count does
	uint32_t changed_since;           ///< see above
	const pliant_skin_range* changed; ///< ascending
	int32_t changed_count;            ///< ranges in `changed`
	int32_t reserved;                 ///< 0
} pliant_skin_array;

/// A drawn vertex: pliant::SkinVertex. The library fills these records.
typedef struct pliant_skin_vertex
{
	float rest[3];         ///< position in the undeformed shape, m
	uint32_t first;        ///< its first influence; where `count` is 0 the index of its mix
	float rest_normal[3];  ///< the normal where its triangles have no area
	uint32_t count;        ///< number of its influences
	float normal_shift[3]; ///< difference of the drawn normal from the mean of the triangles', at rest
	uint32_t corner;       ///< the first corner of its triangles; PLIANT_SKIN_NONE: none
} pliant_skin_vertex;

/// One cell that moves a vertex.
typedef struct pliant_skin_influence
{
	uint32_t cell; ///< whose node moves the vertex
	float weight;  ///< 0 to 1
} pliant_skin_influence;

/// A vertex on the triangle of three others.
typedef struct pliant_skin_mix
{
	uint32_t vertex[3]; ///< the corners
	uint32_t reserved0; ///< 0
	float weight[3];    ///< of the corners; sums to 1
	float reserved1;    ///< 0
} pliant_skin_mix;

/// A corner of a triangle that counts for normals.
typedef struct pliant_skin_corner
{
	uint32_t vertex; ///< PLIANT_SKIN_NONE: the triangle is not in use
	uint32_t next;   ///< the next corner of the same normal; PLIANT_SKIN_NONE: none
} pliant_skin_corner;

/// The skin as tables and node transforms: pliant::GpuSurfaceView. Pointers are valid until the next step or the next call for the body.
typedef struct pliant_gpu_surface
{
	uint32_t size;                    ///< of the structure, bytes
	uint32_t frame;                   ///< changes when origin, node transforms or offset_turn do
	pliant_vec3 origin;               ///< that skinned positions are relative to, world, m
	const float* node_transforms;     ///< of each node 12 floats: a 3 x 4 matrix, row by row, to the world's axes relative to origin
	int32_t nodes;                    ///< transforms in node_transforms
	float offset_turn[9];             ///< 3 x 3, row by row; turns the offsets
	pliant_skin_array vertices;       ///< pliant_skin_vertex
	pliant_skin_array influences;     ///< pliant_skin_influence
	pliant_skin_array mixes;          ///< pliant_skin_mix; empty as long as nothing has broken
	pliant_skin_array corners;        ///< pliant_skin_corner
	pliant_skin_array indices;        ///< uint32_t, 3 per triangle
	pliant_skin_array node_of_cell;   ///< uint32_t; empty: cell i is node i
	pliant_skin_array offsets;        ///< 4 floats per vertex, the last one unused; empty: none
	const float* texture_coordinates; ///< 2 per vertex, as of pliant_surface
	const uint32_t* triangle_source;  ///< as of pliant_surface
	uint32_t topology_version;        ///< as of pliant_surface
	uint32_t reserved;                ///< 0
} pliant_gpu_surface;

/// A drawn vertex as a weighted mean of vertices of the input mesh: pliant::VertexSource.
typedef struct pliant_vertex_source
{
	uint32_t vertex[3]; ///< of the input mesh; PLIANT_SOURCE_INSIDE first for a vertex of a crack face
	float weight[3];    ///< sums to 1; 0 for a vertex of a crack face
} pliant_vertex_source;

/// One of these for each vertex of a surface.
typedef struct pliant_vertex_sources
{
	uint32_t size;                       ///< of the structure, bytes
	uint32_t topology_version;           ///< as of pliant_surface
	const pliant_vertex_source* sources; ///< null: vertex i is the input's vertex i
	int32_t vertices;                    ///< as of pliant_surface
	int32_t reserved;                    ///< 0
} pliant_vertex_sources;

/// Tangents: pliant::TangentView.
typedef struct pliant_tangents
{
	uint32_t size;             ///< of the structure, bytes
	uint32_t topology_version; ///< as of pliant_surface
	const float* tangents;     ///< 4 per vertex: unit length, and the handedness; null without texture coordinates and tangents
	int32_t vertices;          ///< as of pliant_surface
	uint32_t frame;            ///< as of pliant_surface; 0 for tangents at rest
} pliant_tangents;

/// A further mesh bound to the cells of a template, and its drawing on one body. Destroy it by pliant_skin_destroy.
typedef struct pliant_skin pliant_skin;

/// The skin for the GPU. `size`: sizeof( pliant_gpu_surface ).
PLIANT_API pliant_result pliant_body_get_gpu_surface(
	const pliant_world* world, pliant_id body, pliant_gpu_surface* surface, uint32_t size );
/// The sources of the vertices of the body's surface. Valid until the next call after the body breaks. `size`:
/// sizeof( pliant_vertex_sources ).
PLIANT_API pliant_result pliant_body_get_vertex_sources(
	const pliant_world* world, pliant_id body, pliant_vertex_sources* sources, uint32_t size );
/// Tangents of the surface as it is drawn. Valid until the next step or call for the body. `size`: sizeof( pliant_tangents ).
PLIANT_API pliant_result pliant_body_get_tangents( const pliant_world* world, pliant_id body, pliant_tangents* tangents, uint32_t size );
/// Tangents of the undeformed surface. `size`: sizeof( pliant_tangents ).
PLIANT_API pliant_result pliant_body_get_rest_tangents(
	const pliant_world* world, pliant_id body, pliant_tangents* tangents, uint32_t size );

/// Binds a mesh in the coordinates of the template's own mesh, and makes a skin of it for one body. `made`: to be destroyed by the caller.
PLIANT_API pliant_result pliant_skin_create( const pliant_template* of, const pliant_mesh* mesh, pliant_skin** made );
/// Another skin of the same mesh, for another body: for example a fragment. Both share the binding.
PLIANT_API pliant_result pliant_skin_copy( const pliant_skin* of, pliant_skin** made );
/// Destroys a skin. Null is ignored.
PLIANT_API void pliant_skin_destroy( pliant_skin* skin );
/// The skin on a body, as pliant_body_get_surface; empty for a body of another template. Valid until the call after the next. Use one
/// skin for one body only. `size`: sizeof( pliant_surface ).
PLIANT_API pliant_result pliant_skin_get_surface(
	pliant_skin* skin, const pliant_world* world, pliant_id body, pliant_surface* surface, uint32_t size );
/// The same for the GPU. `size`: sizeof( pliant_gpu_surface ).
PLIANT_API pliant_result pliant_skin_get_gpu_surface(
	pliant_skin* skin, const pliant_world* world, pliant_id body, pliant_gpu_surface* surface, uint32_t size );
/// The sources of its vertices in the skin's mesh. `size`: sizeof( pliant_vertex_sources ).
PLIANT_API pliant_result pliant_skin_get_vertex_sources(
	pliant_skin* skin, const pliant_world* world, pliant_id body, pliant_vertex_sources* sources, uint32_t size );

#ifdef __cplusplus
}
#endif
