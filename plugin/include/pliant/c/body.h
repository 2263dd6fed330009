#pragma once

// Soft bodies: making, motion, material, breaking, cuts, pins, attachments, skins. pliant/soft_body.h says more on each call. The world
// owns them: fragments that fade end by themselves, all others with pliant_object_destroy or with the world. In all calls `world` and
// `body` name a soft body; PLIANT_NO_SUCH_OBJECT where there is none, PLIANT_BAD_ARGUMENT where it is a rigid one.

#include "pliant/c/settings.h"
#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// How a soft body is made. What pointers refer to is read only during the call.
typedef struct pliant_body_settings
{
	uint32_t size;                       ///< of the structure, bytes
	int32_t group;                       ///< of Bullet's filters. Default 1, the default group.
	int32_t mask;                        ///< the groups that it collides with. Default -1: all.
	uint32_t reserved;                   ///< 0
	pliant_pose pose;                    ///< from mesh coordinates to the world. Default: at the origin, not turned.
	double friction;                     ///< 0 and above. Default 0.5.
	double restitution;                  ///< 0 to 1. Default 0.
	const pliant_material* material;     ///< null, the default: the default material
	const pliant_adaptivity* adaptivity; ///< null, the default: no levels of detail
	const pliant_fracture* fracture;     ///< null, the default: does not break, but can be cut
	/// Factor on the stiffness at a point (3 floats, mesh coordinates, m), (0, 1]; called once for each cell. Null: 1.
	float ( *stiffness )( const float* point, void* context );
	void* stiffness_context; ///< passed to `stiffness`
	/// Factor on the breaking strain of a link, by its middle and its direction (3 floats each, mesh coordinates), above 0. Null: 1.
	float ( *toughness )( const float* point, const float* direction, void* context );
	void* toughness_context;    ///< passed to `toughness`
	const float* shard_centres; ///< PLIANT_BREAK_SHARDS: centres, 3 floats each, mesh coordinates, m; null: by shard_pattern
	const int32_t* shards;      ///< the shard of each centre, 0 and above; null: each is one
	int32_t shard_centre_count; ///< 0, or 2 to 100 000
	int32_t reserved_too;       ///< 0
	uint64_t user_data;         ///< as pliant_object_set_user_data. Default 0.
} pliant_body_settings;

/// State of a soft body after a step, read by one call.
typedef struct pliant_body_state
{
	uint32_t size;                ///< of the structure, bytes
	int32_t nodes;                ///< at least 1; changes with levels and when the body breaks
	int32_t cells;                ///< finest cells
	int32_t links;                ///< unbroken ones between them
	double mass;                  ///< kg
	pliant_vec3 mass_centre;      ///< world, m
	pliant_vec3 linear_velocity;  ///< of the mass centre, m/s
	pliant_vec3 angular_velocity; ///< of the rigid part of the motion, rad/s
	pliant_vec3 angular_momentum; ///< about the mass centre, kg m^2/s
	pliant_pose pose;             ///< that fits the deformed body best; from mesh coordinates to the world
	uint32_t fracture_version;    ///< changes when links break, which renumbers nodes
	uint32_t level_version;       ///< changes when levels change, which renumbers nodes
	int32_t is_awake;             ///< flag
	int32_t is_healthy;           ///< flag: 0 after a number in the body was no longer finite, until pliant_body_reset
	int32_t is_rigid;             ///< flag: it does not deform now
	float fade_fraction;          ///< of a piece that fades: from 1 to 0; 1 for others
} pliant_body_state;

/// One node.
typedef struct pliant_node
{
	uint32_t size;        ///< of the structure, bytes
	int32_t level;        ///< of detail; 0: a finest cell
	pliant_vec3 position; ///< world, m
	pliant_vec3 velocity; ///< m/s
	double mass;          ///< kg
	double radius;        ///< of its collision sphere, m
	int32_t is_pinned;    ///< flag
	int32_t cell;         ///< the finest cell of the template that it stands for
} pliant_node;

/// The skinned render mesh: pliant::SurfaceView. Pointers are valid until the step after next.
typedef struct pliant_surface
{
	uint32_t size;                    ///< of the structure, bytes
	uint32_t topology_version;        ///< changes when indices or counts change
	pliant_vec3 origin;               ///< that positions are relative to, world, m
	const float* positions;           ///< 3 per vertex, m, along the world's axes
	const float* normals;             ///< 3 per vertex, unit length
	const uint32_t* indices;          ///< 3 per triangle
	const float* texture_coordinates; ///< 2 per vertex; null where the mesh had none and nothing has broken
	const uint32_t* triangle_source;  ///< the input's triangle; 0xffffffff for a crack face; null: triangle i is the input's
	int32_t vertices;                 ///< number of vertices; 0 for a body without a skin
	int32_t triangles;                ///< number of triangles
	uint32_t frame;                   ///< changes when positions change
} pliant_surface;

/// Fills settings with their defaults. `size`: sizeof( pliant_body_settings ).
PLIANT_API pliant_result pliant_body_settings_init( pliant_body_settings* settings, uint32_t size );

/// Makes a body at rest and adds it to the world. `settings`: may be null: the defaults. `made`: its identity. The template may be released
/// afterwards. Errors: those of pliant::SoftBody::create and setFracture.
PLIANT_API pliant_result pliant_body_create(
	pliant_world* world, const pliant_template* from, const pliant_body_settings* settings, pliant_id* made );

// --- what it is
/// Its state. `size`: sizeof( pliant_body_state ).
PLIANT_API pliant_result pliant_body_get_state( const pliant_world* world, pliant_id body, pliant_body_state* state, uint32_t size );
/// One node, 0 to nodes - 1. `size`: sizeof( pliant_node ).
PLIANT_API pliant_result pliant_body_get_node( const pliant_world* world, pliant_id body, int32_t node, pliant_node* out, uint32_t size );
/// Positions of all nodes, world, m: 3 doubles each, up to `capacity` nodes; `count` is their whole number. `positions` may be null where
/// capacity is 0.
PLIANT_API pliant_result pliant_body_get_positions(
	const pliant_world* world, pliant_id body, double* positions, uint64_t capacity, uint64_t* count );
/// Velocities of all nodes, m/s, in the same way.
PLIANT_API pliant_result pliant_body_get_velocities(
	const pliant_world* world, pliant_id body, double* velocities, uint64_t capacity, uint64_t* count );
/// The node nearest to a point, world, m.
PLIANT_API pliant_result pliant_body_get_nearest_node( const pliant_world* world, pliant_id body, pliant_vec3 point, int32_t* node );
/// The skin, computed if the body has moved. Not from two threads at a time for bodies of one world. `size`: sizeof( pliant_surface ).
PLIANT_API pliant_result pliant_body_get_surface( const pliant_world* world, pliant_id body, pliant_surface* surface, uint32_t size );

// --- motion: PLIANT_BAD_ARGUMENT also where a node would be faster than 1e5 m/s along an axis
/// Sets a rigid motion: velocity of the mass centre, m/s, and angular velocity, rad/s.
PLIANT_API pliant_result pliant_body_set_velocity( pliant_world* world, pliant_id body, pliant_vec3 linear, pliant_vec3 angular );
/// An impulse, N s, on a node, or with node -1 on all by mass.
PLIANT_API pliant_result pliant_body_apply_impulse( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 impulse );
/// A force, N, until the end of the step, on a node, or with node -1 on all by mass.
PLIANT_API pliant_result pliant_body_apply_force( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 force );
/// The node that holds a finest cell of the template; -1 for a cell that is not in this body.
PLIANT_API pliant_result pliant_body_get_node_of_cell( const pliant_world* world, pliant_id body, int32_t cell, int32_t* node );
/// Holds the body as a whole, or lets it step: PLIANT_RIGID_DYNAMIC (pliant/c/rigid.h), the default; PLIANT_RIGID_STATIC; or
/// PLIANT_RIGID_KINEMATIC, which is moved by pliant_body_teleport and pliant_body_drive.
PLIANT_API pliant_result pliant_body_set_kind( pliant_world* world, pliant_id body, int32_t kind );
/// Gives the body a gravity of its own, m/s^2; null: the world's again.
PLIANT_API pliant_result pliant_body_set_gravity( pliant_world* world, pliant_id body, const pliant_vec3* gravity );
/// Moves the body by a transform, with its deformation and velocities.
PLIANT_API pliant_result pliant_body_teleport( pliant_world* world, pliant_id body, const pliant_pose* by );
/// Returns the body to its rest shape, at rest, at a pose. Heals a body that is not healthy.
PLIANT_API pliant_result pliant_body_reset( pliant_world* world, pliant_id body, const pliant_pose* pose );
/// Grows or shrinks the body to a multiple of its template's size, 1e-3 to 1e3.
PLIANT_API pliant_result pliant_body_set_scale( pliant_world* world, pliant_id body, double scale );

// --- settings that can change at any time
/// Changes the material. Errors: PLIANT_BAD_MATERIAL, PLIANT_BAD_ARGUMENT.
PLIANT_API pliant_result pliant_body_set_material( pliant_world* world, pliant_id body, const pliant_material* material );
/// The material. `size`: sizeof( pliant_material ).
PLIANT_API pliant_result pliant_body_get_material( const pliant_world* world, pliant_id body, pliant_material* material, uint32_t size );
/// Changes whether and how the body breaks; toughness and shards are as without fields. Errors: PLIANT_BAD_SETTINGS.
PLIANT_API pliant_result pliant_body_set_fracture( pliant_world* world, pliant_id body, const pliant_fracture* fracture );
/// How it breaks. `size`: sizeof( pliant_fracture ).
PLIANT_API pliant_result pliant_body_get_fracture( const pliant_world* world, pliant_id body, pliant_fracture* fracture, uint32_t size );
/// Makes ahead of time what the first crack needs.
PLIANT_API pliant_result pliant_body_prepare_cracks( pliant_world* world, pliant_id body );
/// The settings of its levels of detail. `size`: sizeof( pliant_adaptivity ).
PLIANT_API pliant_result pliant_body_get_adaptivity(
	const pliant_world* world, pliant_id body, pliant_adaptivity* adaptivity, uint32_t size );
/// Splits all nodes in a box, world, m, down to the finest level; to be called as long as the detail is needed.
PLIANT_API pliant_result pliant_body_request_refinement( pliant_world* world, pliant_id body, pliant_vec3 low, pliant_vec3 high );
/// Sets the finest level in use, 0 to pliant_adaptivity::coarse_levels.
PLIANT_API pliant_result pliant_body_set_finest_level( pliant_world* world, pliant_id body, int32_t level );
/// Whether the body's own parts collide: flag, default 0.
PLIANT_API pliant_result pliant_body_set_self_collision( pliant_world* world, pliant_id body, int32_t is_on );
/// Whether the world collects contact events of it: flag, default 0.
PLIANT_API pliant_result pliant_body_set_contact_events( pliant_world* world, pliant_id body, int32_t is_on );
/// Largest error of a skin that is used again, finest cells, 0 and above. Default 0.01.
PLIANT_API pliant_result pliant_body_set_surface_tolerance( pliant_world* world, pliant_id body, double cells );
/// Whether its skin lies between the last two steps: flag, default 0.
PLIANT_API pliant_result pliant_body_set_interpolation( pliant_world* world, pliant_id body, int32_t is_on );
/// Whether the debris budget leaves it alone: flag, default 0.
PLIANT_API pliant_result pliant_body_set_kept( pliant_world* world, pliant_id body, int32_t is_kept );

// --- cuts; parts separate in the next step. `links`: newly cut ones; may be null
/// Cuts by a plane, `normal` of any length but 0, or by a disc of `radius` m about `point`; infinity: the whole plane.
PLIANT_API pliant_result pliant_body_cut_plane(
	pliant_world* world, pliant_id body, pliant_vec3 point, pliant_vec3 normal, double radius, int32_t* links );
/// Cuts by the surface of a sphere; radius in m, above 0.
PLIANT_API pliant_result pliant_body_cut_sphere( pliant_world* world, pliant_id body, pliant_vec3 centre, double radius, int32_t* links );
/// Cuts by a blade whose edge moves from p0 p1 to q0 q1. `corners`: 4 points, p0, p1, q0, q1, world, m.
PLIANT_API pliant_result pliant_body_cut_sweep( pliant_world* world, pliant_id body, const pliant_vec3* corners, int32_t* links );
/// Restores links of cells at most `reach` times their rest distance apart, above 0. `links`: restored ones.
PLIANT_API pliant_result pliant_body_heal( pliant_world* world, pliant_id body, double reach, int32_t* links );

// --- pins: nodes that forces do not move
/// Holds a node where it is.
PLIANT_API pliant_result pliant_body_pin( pliant_world* world, pliant_id body, int32_t node );
/// Makes a node follow a rigid body, which feels no force from it.
PLIANT_API pliant_result pliant_body_pin_to( pliant_world* world, pliant_id body, int32_t node, pliant_id rigid );
/// Moves a node to a position, world, m, at the end of the next step, and holds it.
PLIANT_API pliant_result pliant_body_drive( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 position );
/// Releases a node; one that is not pinned stays as it is.
PLIANT_API pliant_result pliant_body_release( pliant_world* world, pliant_id body, int32_t node );
/// Pins every node in a box, world, m. `pinned`: their number; may be null.
PLIANT_API pliant_result pliant_body_pin_inside( pliant_world* world, pliant_id body, pliant_vec3 low, pliant_vec3 high, int32_t* pinned );

// --- attachments: two bodies that pull on each other. `settings`: may be null; `made`: the attachment's number
/// Attaches a node, where it is, to a rigid body.
PLIANT_API pliant_result pliant_attach_node(
	pliant_world* world, pliant_id body, int32_t node, pliant_id rigid, const pliant_attachment_settings* settings, int32_t* made );
/// Attaches a point in or near the body, world, m, to a soft or a rigid body.
PLIANT_API pliant_result pliant_attach_point(
	pliant_world* world, pliant_id body, pliant_vec3 point, pliant_id to, const pliant_attachment_settings* settings, int32_t* made );
/// Attaches each node within `distance`, m, of a node of another soft body. `made`: the number of attachments; may be null.
PLIANT_API pliant_result pliant_weld(
	pliant_world* world, pliant_id body, pliant_id to, double distance, const pliant_attachment_settings* settings, int32_t* made );
/// Removes an attachment. Errors: PLIANT_NO_SUCH_OBJECT for one that is not there.
PLIANT_API pliant_result pliant_detach( pliant_world* world, int32_t attachment );
/// Number of attachments in the world.
PLIANT_API pliant_result pliant_world_get_attachment_count( const pliant_world* world, int32_t* count );
/// The force of an attachment on its first body, N, the mean over the last step; zero for one that is not there.
PLIANT_API pliant_result pliant_attachment_get_force( const pliant_world* world, int32_t attachment, pliant_vec3* force );
/// Makes a frame: a rigid body without collisions that moves with the nodes within `radius`, m, of a point, world, m, and through which
/// forces on rigid bodies and Bullet's joints act on them. `made`: its identity. Errors: PLIANT_BAD_ARGUMENT, also where fewer than three
/// nodes, or nodes on a line, are within the radius.
PLIANT_API pliant_result pliant_frame_create( pliant_world* world, pliant_id body, pliant_vec3 point, double radius, pliant_id* made );
/// Destroys a frame. Errors: PLIANT_BAD_ARGUMENT for another rigid body.
PLIANT_API pliant_result pliant_frame_destroy( pliant_world* world, pliant_id frame );
/// The soft body of a frame; 0 if that has been destroyed, and for other rigid bodies.
PLIANT_API pliant_result pliant_frame_get_body( const pliant_world* world, pliant_id frame, pliant_id* body );

// --- single bodies as bytes
/// Saves a body with its state, but without contacts and attachments: PLIANT_SAVE_ALL or PLIANT_SAVE_STATE_ONLY (pliant/c/world.h) in
/// `flags`. Replaces the content of the buffer.
PLIANT_API pliant_result pliant_body_save( const pliant_world* world, pliant_id body, uint32_t flags, pliant_buffer* bytes );
/// Creates a body from such bytes and adds it to the world. `settings`: its group, mask and user data are used, the rest is in the bytes;
/// may be null. `templates`: as of pliant_world_restore. `made`: its identity. Errors: PLIANT_BAD_SNAPSHOT.
PLIANT_API pliant_result pliant_body_load( pliant_world* world, const void* data, uint64_t byte_count,
	const pliant_template* const* templates, uint64_t template_count, const pliant_body_settings* settings, pliant_id* made );

#ifdef __cplusplus
}
#endif
