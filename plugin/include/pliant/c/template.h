#pragma once

// Templates: meshes converted into cells. pliant/body_template.h says more.

#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// A triangle mesh of the caller's; the arrays are read only during the call. Any mesh is accepted: see pliant::MeshView.
typedef struct pliant_mesh
{
	uint32_t size;                       ///< of the structure, bytes
	uint32_t position_stride;            ///< floats from one vertex to the next, at least 3. Default 3.
	const float* positions;              ///< 3 floats per vertex, m
	const uint32_t* indices;             ///< 3 per triangle, counter-clockwise seen from outside
	uint64_t vertex_count;               ///< above 0
	uint64_t triangle_count;             ///< above 0
	const float* texture_coordinates;    ///< 2 floats per vertex; may be null
	const uint32_t* submesh_of_triangle; ///< one per triangle; may be null
	const float* tangents;               ///< 4 floats per vertex: x, y, z and handedness; may be null
} pliant_mesh;

/// pliant_lattice_settings::skinning.
enum
{
	PLIANT_SKINNING_NEARBY_NODES = 0, ///< by nearby nodes. Default.
	PLIANT_SKINNING_TRILINEAR,        ///< by the cell that a vertex is in
	PLIANT_SKINNING_NONE              ///< no render mesh
};

/// pliant_lattice_settings::shell.
enum
{
	PLIANT_SHELL_WHERE_NEEDED = 0, ///< where there is no inside, and where parts are thin. Default.
	PLIANT_SHELL_NEVER,            ///< a mesh without an inside is refused
	PLIANT_SHELL_ALWAYS            ///< the surface and only the surface
};

/// How a mesh is converted: pliant::LatticeSettings, and pliant::CrackSettings.
typedef struct pliant_lattice_settings
{
	uint32_t size;            ///< of the structure, bytes
	float cell_size;          ///< m; 0, the default: by target_cells
	int32_t target_cells;     ///< 1 to max_cells. Default 1000.
	int32_t max_cells;        ///< 1 to 10 000 000. Default 200 000.
	int32_t max_triangles;    ///< 1 to 100 000 000. Default 5 000 000.
	int32_t samples_per_edge; ///< 1 to 8. Default 4.
	float weld_tolerance;     ///< fraction of the bounding box's diagonal, [0, 0.01]. Default 1e-6.
	float minimum_fill;       ///< [0, 0.5]. Default 0.03.
	int32_t shell;            ///< PLIANT_SHELL_...
	float shell_thickness;    ///< m, 0 to 1e7; 0, the default: a cell
	int32_t skinning;         ///< PLIANT_SKINNING_...
	int32_t contact_surface;  ///< flag: all objects collide with the drawn surface. Default 0: as in C++.
	int32_t crack_faces;      ///< 0: exact, the default; 1: marching squares; 2: bricks
	float noise_amplitude;    ///< of crack faces, cells, 0 to 0.35. Default 0.3.
	float noise_wavelength;   ///< cells, 1 to 100. Default 1.6.
	uint32_t noise_seed;      ///< any number. Default 1.
	int32_t subdivision;      ///< segments per edge of a crack face, 1 to 8. Default 2.
	float bend_tolerance;     ///< cells, 0 to 0.5. Default 0.05.
	float texture_tile;       ///< m, above 0. Default 1.
	int32_t threads;          ///< for the build, 1 to 64. Default 1. The result does not depend on it.
	/// Called from the calling thread from time to time with the fraction done, [0, 1]; returns 0 to cancel. May be null.
	int32_t ( *progress )( float fraction_done, void* context );
	void* progress_context; ///< passed to `progress`
} pliant_lattice_settings;

/// What a template consists of, and what its build found and changed (pliant::BuildReport).
typedef struct pliant_template_info
{
	uint32_t size;              ///< of the structure, bytes
	int32_t cells;              ///< finest cells
	int32_t links;              ///< between cells, each counted once
	float cell_size;            ///< m
	int32_t vertices;           ///< of the render mesh, as in the input; 0 with PLIANT_SKINNING_NONE
	int32_t triangles;          ///< the same
	int32_t welded_vertices;    ///< merged into another
	int32_t flipped_triangles;  ///< whose orientation was reversed
	int32_t dropped_triangles;  ///< without an area, or there twice
	int32_t open_edges;         ///< with one triangle
	int32_t non_manifold_edges; ///< with three or more
	int32_t shells;             ///< connected parts of the mesh
	int32_t shell_cells;        ///< cells that contain surface and no inside
	int32_t components;         ///< connected parts of the lattice
	double volume;              ///< of the material, m^3
	double mass_centre[3];      ///< mesh coordinates, m
} pliant_template_info;

/// Fills an empty mesh. `size`: sizeof( pliant_mesh ).
PLIANT_API pliant_result pliant_mesh_init( pliant_mesh* mesh, uint32_t size );
/// Fills settings with their defaults. `size`: sizeof( pliant_lattice_settings ).
PLIANT_API pliant_result pliant_lattice_settings_init( pliant_lattice_settings* settings, uint32_t size );

/// Converts a mesh. `settings`: may be null: the defaults. `made`: the caller's to release. Errors: all codes up to PLIANT_TOO_FOLDED.
PLIANT_API pliant_result pliant_template_build( const pliant_mesh* mesh, const pliant_lattice_settings* settings, pliant_template** made );
/// The same template, `factor` times as large along each axis. Errors: PLIANT_BAD_ARGUMENT for a factor not within 1e-6 to 1e6.
PLIANT_API pliant_result pliant_template_scaled( const pliant_template* of, float factor, pliant_template** made );
/// Ends the caller's hold on a template. Null is ignored.
PLIANT_API void pliant_template_release( pliant_template* released );

/// What it consists of. `size`: sizeof( pliant_template_info ).
PLIANT_API pliant_result pliant_template_get_info( const pliant_template* of, pliant_template_info* info, uint32_t size );

/// Writes a template as bytes; a game may ship them instead of the mesh. What the buffer held is replaced.
PLIANT_API pliant_result pliant_template_save( const pliant_template* saved, pliant_buffer* bytes );
/// Reads them. `made`: the caller's to release. Errors: PLIANT_BAD_SNAPSHOT.
PLIANT_API pliant_result pliant_template_load( const void* data, uint64_t byte_count, pliant_template** made );

#ifdef __cplusplus
}
#endif
