#pragma once

// Worlds: stepping, what is in them, what happened in the last step, rays, saving. pliant/soft_body_host.h says more.

#include "pliant/c/settings.h"
#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// How a world is made.
typedef struct pliant_world_settings
{
	uint32_t size;             ///< of the structure, bytes
	int32_t threads;           ///< 1 to 64. Default 1. Results do not depend on it.
	pliant_vec3 gravity;       ///< m/s^2. Default ( 0, -9.81, 0 ).
	int32_t soft_substeps;     ///< per step of 1/60 s, 1 to 64. Default 4.
	int32_t max_soft_substeps; ///< that stiff materials may raise it to, 1 to 64; of 16 and more: in steps to 1/15 s. Default 16.
} pliant_world_settings;

/// Times and counts of one step: pliant::StepReport.
typedef struct pliant_step_report
{
	uint32_t size;                 ///< of the structure, bytes
	int32_t substeps;              ///< soft substeps of the last step
	double milliseconds;           ///< the whole step, rigid bodies included, skins not
	double forces_ms;              ///< forces and gravity, ms
	double matching_ms;            ///< shape matching, the implicit step and the contacts of deformable bodies, ms
	double collision_ms;           ///< search for contacts, ms
	double solve_ms;               ///< Bullet's solver: joints, and contacts without a deformable body, ms
	double integrate_ms;           ///< positions from velocities, ms
	double skinning_ms;            ///< skins since the step before, ms
	double levels_ms;              ///< changes of levels of detail, ms
	double fracture_ms;            ///< links tested and broken, pieces made, ms
	int32_t soft_bodies;           ///< in the world
	int32_t awake_soft_bodies;     ///< those that are awake
	int32_t rigid_state_bodies;    ///< soft bodies that move as rigid ones now
	int32_t implicit_bodies;       ///< that took the implicit step
	int32_t nodes;                 ///< in all soft bodies
	int32_t soft_contacts;         ///< contact points of nodes
	int32_t level_changes;         ///< changes of bodies' levels
	int32_t broken_links;          ///< between finest cells
	int32_t fragments;             ///< bodies that came off others
	int32_t removed_pieces;        ///< small pieces that were not made, or have faded
	int32_t debris_pieces;         ///< pieces that count for the budget
	int32_t debris_nodes;          ///< their nodes
	int32_t settled_pieces;        ///< pieces that became scenery
	int32_t quarantined;           ///< bodies that stand still because a number in them was no longer finite
	int32_t unreachable_stiffness; ///< bodies whose stiffness was out of reach
} pliant_step_report;

/// A body that broke in the last step: pliant::FractureEvent.
typedef struct pliant_fracture_event
{
	uint32_t size;           ///< of the structure, bytes
	int32_t links;           ///< broken, between finest cells
	pliant_id body;          ///< that broke; its heaviest part keeps this identity. 0 where it has been destroyed since
	uint64_t fragments;      ///< number of new bodies (pliant_world_get_fragments); 0 where the body cracked and holds together
	double area;             ///< of the crack, one side, m^2
	double energy;           ///< that the broken links held, J
	pliant_vec3 point;       ///< middle of the crack, world, m
	pliant_vec3 normal;      ///< of the crack, unit length, either sign; zero where nothing broke
	double parting_velocity; ///< of the two sides, m/s
	int32_t removed_pieces;  ///< that were not made
	int32_t reserved;        ///< 0
	double removed_mass;     ///< kg
} pliant_fracture_event;

/// A soft body with pliant_body_set_contact_events and what it touches: pliant::ContactEvent.
typedef struct pliant_contact_event
{
	uint32_t size;        ///< of the structure, bytes
	int32_t began;        ///< flag: they did not touch before
	int32_t ended;        ///< flag: they do not touch any more
	int32_t reserved;     ///< 0
	pliant_id body;       ///< 0 once it has left the world
	pliant_id other;      ///< soft or rigid; 0 once it has left the world
	double impulse;       ///< sum of the normal impulses of the step, N s
	pliant_vec3 push;     ///< the same as a vector, on `body`, N s
	pliant_vec3 position; ///< where, world, m
} pliant_contact_event;

/// An attachment that broke in the last step: pliant::AttachmentEvent.
typedef struct pliant_attachment_event
{
	uint32_t size;        ///< of the structure, bytes
	int32_t attachment;   ///< as pliant_attach_... returned it
	pliant_id body;       ///< the first body; 0 once it is gone
	pliant_id other;      ///< the second, soft or rigid; 0 once it is gone
	pliant_vec3 force;    ///< on the first body when it broke, N
	pliant_vec3 position; ///< where it held the first body, world, m
} pliant_attachment_event;

/// First hit of a ray.
typedef struct pliant_ray_hit
{
	uint32_t size;      ///< of the structure, bytes
	int32_t node;       ///< of a soft body: the node nearest to the point; -1 for others
	pliant_id object;   ///< soft or rigid; 0: nothing was hit
	double fraction;    ///< fraction of the ray's length, [0, 1]; 1 where nothing was hit
	pliant_vec3 point;  ///< world, m
	pliant_vec3 normal; ///< unit length, against the ray
} pliant_ray_hit;

/// Kind of an object: pliant_object_get_kind.
enum
{
	PLIANT_KIND_SOFT = 1, ///< a soft body (pliant/c/body.h)
	PLIANT_KIND_RIGID,    ///< a rigid body (pliant/c/rigid.h)
	PLIANT_KIND_OTHER     ///< what else C++ has put into the world: links of multibodies, ghosts
};

/// Flags of pliant_world_save.
enum
{
	PLIANT_SAVE_ALL = 0,           ///< templates too. Default.
	PLIANT_SAVE_STATE_ONLY = 1,    ///< without templates: to go back some frames
	PLIANT_SAVE_FOR_COMPARISON = 2 ///< worlds in equal states have equal bytes; not for restoring to the last bit
};

/// Fills settings with their defaults. `size`: sizeof( pliant_world_settings ).
PLIANT_API pliant_result pliant_world_settings_init( pliant_world_settings* settings, uint32_t size );

/// Makes a world with a Bullet dispatcher, broadphase and solver of its own. `settings`: may be null: the defaults. `world`: the caller's
/// to destroy.
PLIANT_API pliant_result pliant_world_create( const pliant_world_settings* settings, pliant_world** world );
/// Makes a handle of a world that C++ owns: the pointer to its pliant::SoftBodyHost as a void*; pliant/c/mix.h does the same with types.
/// Bodies that C++ has added are found too (pliant_world_get_bodies, rays, events), and stay those of C++. C++ must not destroy bodies that
/// were made through C, and the world must outlive the handle. Make one handle only for a world.
PLIANT_API pliant_result pliant_world_wrap( void* soft_body_host, pliant_world** world );
/// Destroys a world and everything that was made in it; for a wrapped one, what was made through C, and the handle. Null is ignored.
PLIANT_API void pliant_world_destroy( pliant_world* world );

/// Steps by `seconds`, 0 and above, as btDiscreteDynamicsWorld::stepSimulation: at most `max_steps` steps of `fixed_step` s, and the rest
/// is carried over; with max_steps 0 one step of `seconds`. `steps`: made; may be null. Errors: PLIANT_BAD_ARGUMENT, also for a max_steps
/// below 0, and a fixed_step not above 0.
PLIANT_API pliant_result pliant_world_step( pliant_world* world, double seconds, int32_t max_steps, double fixed_step, int32_t* steps );
/// Times and counts of the last step. `size`: sizeof( pliant_step_report ).
PLIANT_API pliant_result pliant_world_get_report( const pliant_world* world, pliant_step_report* report, uint32_t size );

/// Sets the gravity, m/s^2; wakes nothing, as in Bullet. Errors: PLIANT_BAD_ARGUMENT, also for more than 1e6 along an axis.
PLIANT_API pliant_result pliant_world_set_gravity( pliant_world* world, pliant_vec3 gravity );
/// The gravity, m/s^2.
PLIANT_API pliant_result pliant_world_get_gravity( const pliant_world* world, pliant_vec3* gravity );
/// Sets the number of threads, 1 to 64.
PLIANT_API pliant_result pliant_world_set_threads( pliant_world* world, int32_t threads );
/// Sets soft substeps per 1/60 s, and what stiff materials may raise them to: both 1 to 64.
PLIANT_API pliant_result pliant_world_set_soft_substeps( pliant_world* world, int32_t substeps, int32_t most );
/// Limits the pieces of the world. Errors: PLIANT_BAD_SETTINGS; PLIANT_BAD_ARGUMENT in a build without breaking.
PLIANT_API pliant_result pliant_world_set_debris_budget( pliant_world* world, const pliant_debris_budget* budget );
/// Where between the last two steps bodies with pliant_body_set_interpolation are drawn, [0, 1]; the next step sets it anew.
PLIANT_API pliant_result pliant_world_set_interpolation( pliant_world* world, double fraction );
/// Adds `by`, m, to the coordinates of everything in the world; wakes nothing. Errors: PLIANT_BAD_ARGUMENT.
PLIANT_API pliant_result pliant_world_shift_origin( pliant_world* world, pliant_vec3 by );
/// An explosion: `impulse`, N s/m^2, on what faces `centre`, down to 0 at the distance `radius`, m, above 0. `pushed`: number of bodies;
/// may be null. Errors: PLIANT_BAD_SETTINGS; PLIANT_BAD_ARGUMENT where something would get faster than 1e5 m/s.
PLIANT_API pliant_result pliant_world_explode( pliant_world* world, pliant_vec3 centre, double radius, double impulse, int32_t* pushed );

/// The soft bodies of the world, fragments included, in the order in which they came: writes up to `capacity` identities; `count` is their
/// whole number. `ids` may be null where capacity is 0.
PLIANT_API pliant_result pliant_world_get_bodies( pliant_world* world, pliant_id* ids, uint64_t capacity, uint64_t* count );
/// The same for rigid bodies.
PLIANT_API pliant_result pliant_world_get_rigids( pliant_world* world, pliant_id* ids, uint64_t capacity, uint64_t* count );

/// How many bodies broke in the last step.
PLIANT_API pliant_result pliant_world_get_fracture_count( const pliant_world* world, uint64_t* count );
/// One of them, 0 to count - 1. `size`: sizeof( pliant_fracture_event ).
PLIANT_API pliant_result pliant_world_get_fracture(
	const pliant_world* world, uint64_t index, pliant_fracture_event* event, uint32_t size );
/// The fragments of one of them, heaviest first: writes up to `capacity` identities, 0 for those that have been destroyed since; `count` is
/// their whole number. `ids` may be null where capacity is 0.
PLIANT_API pliant_result pliant_world_get_fragments(
	const pliant_world* world, uint64_t index, pliant_id* ids, uint64_t capacity, uint64_t* count );
/// How many pairs of bodies touched in the last step, or ceased to.
PLIANT_API pliant_result pliant_world_get_contact_count( const pliant_world* world, uint64_t* count );
/// One of them. `size`: sizeof( pliant_contact_event ).
PLIANT_API pliant_result pliant_world_get_contact( pliant_world* world, uint64_t index, pliant_contact_event* event, uint32_t size );
/// How many attachments broke in the last step.
PLIANT_API pliant_result pliant_world_get_broken_attachment_count( const pliant_world* world, uint64_t* count );
/// One of them. `size`: sizeof( pliant_attachment_event ).
PLIANT_API pliant_result pliant_world_get_broken_attachment(
	pliant_world* world, uint64_t index, pliant_attachment_event* event, uint32_t size );

/// The first object between two points, world, m; soft bodies by their drawn surface. `group` and `mask`: as Bullet's filters; -1: all.
/// `size`: sizeof( pliant_ray_hit ).
PLIANT_API pliant_result pliant_world_cast_ray(
	pliant_world* world, pliant_vec3 from, pliant_vec3 to, int32_t group, int32_t mask, pliant_ray_hit* hit, uint32_t size );

/// Saves the soft bodies and the state of everything else, between steps: PLIANT_SAVE_... in `flags`. What the buffer held is replaced, and
/// its memory used again: a game that saves every step allocates nothing.
PLIANT_API pliant_result pliant_world_save( const pliant_world* world, uint32_t flags, pliant_buffer* bytes );
/// Restores a world, between steps; it has the rigid bodies that it had when it was saved, made in the same order. Soft bodies have the
/// identities that they had then: those that had gone are back, and those that came since are gone. `templates`: what the snapshot may need
/// without storing it and without a body in the world that has it; null where `template_count` is 0. Events of the last step are gone.
/// Errors: PLIANT_BAD_SNAPSHOT.
PLIANT_API pliant_result pliant_world_restore(
	pliant_world* world, const void* data, uint64_t byte_count, const pliant_template* const* templates, uint64_t template_count );

/// The kind of an object, PLIANT_KIND_... Errors: PLIANT_NO_SUCH_OBJECT, as for all of the following.
PLIANT_API pliant_result pliant_object_get_kind( const pliant_world* world, pliant_id object, int32_t* kind );
/// Sets friction, 0 and above, and restitution, 0 to 1.
PLIANT_API pliant_result pliant_object_set_contact( pliant_world* world, pliant_id object, double friction, double restitution );
/// Friction and restitution; each may be null.
PLIANT_API pliant_result pliant_object_get_contact( const pliant_world* world, pliant_id object, double* friction, double* restitution );
/// Wakes an object.
PLIANT_API pliant_result pliant_object_wake( pliant_world* world, pliant_id object );
/// Whether it is awake: 1 or 0.
PLIANT_API pliant_result pliant_object_get_awake( const pliant_world* world, pliant_id object, int32_t* is_awake );
/// Sets a number of the game's, default 0; in C++ the user pointer. Fragments begin with that of the body that broke; snapshots do not hold
/// it. Errors: PLIANT_BAD_ARGUMENT for a number that a pointer cannot hold.
PLIANT_API pliant_result pliant_object_set_user_data( pliant_world* world, pliant_id object, uint64_t data );
/// The number last set.
PLIANT_API pliant_result pliant_object_get_user_data( const pliant_world* world, pliant_id object, uint64_t* data );
/// Takes an object out of the world and destroys it; what touched it wakes, and pins and attachments to it end. Errors:
/// PLIANT_BAD_ARGUMENT for one that C++ has made.
PLIANT_API pliant_result pliant_object_destroy( pliant_world* world, pliant_id object );

#ifdef __cplusplus
}
#endif
