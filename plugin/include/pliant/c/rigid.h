#pragma once

// Rigid bodies: Bullet's, as far as a scene in C needs them. Their identities, friction and end are those of objects (pliant/c/world.h).

#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// pliant_rigid_settings::kind.
enum
{
	PLIANT_RIGID_DYNAMIC = 0, ///< moved by forces. Default. Needs a mass above 0.
	PLIANT_RIGID_STATIC,      ///< does not move
	PLIANT_RIGID_KINEMATIC    ///< moved by pliant_rigid_set_pose alone; carries what lies on it
};

/// How a rigid body is made.
typedef struct pliant_rigid_settings
{
	uint32_t size;                ///< of the structure, bytes
	int32_t kind;                 ///< PLIANT_RIGID_...
	double mass;                  ///< kg, above 0, at most 1e12, for dynamic bodies. Default 1.
	pliant_pose pose;             ///< Default: at the origin, not turned.
	pliant_vec3 linear_velocity;  ///< m/s, at most 1e5 along an axis. Default 0.
	pliant_vec3 angular_velocity; ///< rad/s, as above. Default 0.
	double friction;              ///< 0 and above. Default 0.5.
	double rolling_friction;      ///< 0 and above. Default 0.
	double restitution;           ///< 0 to 1. Default 0.
	double linear_damping;        ///< 0 to 1. Default 0.
	double angular_damping;       ///< 0 to 1. Default 0.
	int32_t group;                ///< of Bullet's filters; 0, the default, with mask 0: Bullet's own for the kind
	int32_t mask;                 ///< the groups that it collides with
} pliant_rigid_settings;

/// Fills settings with their defaults. `size`: sizeof( pliant_rigid_settings ).
PLIANT_API pliant_result pliant_rigid_settings_init( pliant_rigid_settings* settings, uint32_t size );

// In the following `settings` may be null: the defaults. `made` is the identity of the body, which is in the world. Errors:
// PLIANT_BAD_SETTINGS for settings out of range; PLIANT_BAD_ARGUMENT for a shape that is not possible. Lengths are above 0, at most 1e6 m.

/// A sphere about the body's origin; radius in m.
PLIANT_API pliant_result pliant_rigid_create_sphere(
	pliant_world* world, double radius, const pliant_rigid_settings* settings, pliant_id* made );
/// A box about the body's origin; half its edges, m.
PLIANT_API pliant_result pliant_rigid_create_box(
	pliant_world* world, pliant_vec3 half_edges, const pliant_rigid_settings* settings, pliant_id* made );
/// A capsule about the body's origin, along its y axis; `height`: between the centres of its ends, m.
PLIANT_API pliant_result pliant_rigid_create_capsule(
	pliant_world* world, double radius, double height, const pliant_rigid_settings* settings, pliant_id* made );
/// The convex hull of points: 3 floats each, m, at least 4 of them. Its mass centre is the body's origin.
PLIANT_API pliant_result pliant_rigid_create_hull(
	pliant_world* world, const float* points, uint64_t count, const pliant_rigid_settings* settings, pliant_id* made );
/// A plane through the body's origin, `normal` of any length but 0; everything below it is solid. Static only, which is its default.
PLIANT_API pliant_result pliant_rigid_create_plane(
	pliant_world* world, pliant_vec3 normal, const pliant_rigid_settings* settings, pliant_id* made );
/// A triangle mesh, copied: 3 floats per vertex, m, 3 indices per triangle. Static, which is its default, or kinematic.
PLIANT_API pliant_result pliant_rigid_create_mesh( pliant_world* world, const float* positions, uint64_t vertex_count,
	const uint32_t* indices, uint64_t triangle_count, const pliant_rigid_settings* settings, pliant_id* made );

/// The pose.
PLIANT_API pliant_result pliant_rigid_get_pose( const pliant_world* world, pliant_id rigid, pliant_pose* pose );
/// Puts a body somewhere else, and wakes it; a kinematic one moves there during the next step. Errors: PLIANT_BAD_ARGUMENT.
PLIANT_API pliant_result pliant_rigid_set_pose( pliant_world* world, pliant_id rigid, const pliant_pose* pose );
/// Velocity of the mass centre, m/s, and angular velocity, rad/s; each may be null.
PLIANT_API pliant_result pliant_rigid_get_velocity( const pliant_world* world, pliant_id rigid, pliant_vec3* linear, pliant_vec3* angular );
/// Sets both, at most 1e5 along an axis, and wakes the body. Errors: PLIANT_BAD_ARGUMENT, also for a body that is not dynamic, as for the
/// following two.
PLIANT_API pliant_result pliant_rigid_set_velocity( pliant_world* world, pliant_id rigid, pliant_vec3 linear, pliant_vec3 angular );
/// An impulse, N s, at a point in the world, m. Refused where the body would be faster than 1e5 m/s or rad/s along an axis.
PLIANT_API pliant_result pliant_rigid_apply_impulse( pliant_world* world, pliant_id rigid, pliant_vec3 impulse, pliant_vec3 point );
/// A force, N, at a point in the world, m, until the end of the step. Refused where it would give 1e5 m/s within 1/60 s.
PLIANT_API pliant_result pliant_rigid_apply_force( pliant_world* world, pliant_id rigid, pliant_vec3 force, pliant_vec3 point );
/// The mass, kg; 0 for a body that is not dynamic.
PLIANT_API pliant_result pliant_rigid_get_mass( const pliant_world* world, pliant_id rigid, double* mass );

#ifdef __cplusplus
}
#endif
