#pragma once

// Joints between rigid bodies, and between frames of soft bodies (pliant_frame_create): Bullet's, as far as a scene in C needs them. All
// hold the bodies' relative pose but for one or more directions of motion, which may have limits and a motor.

#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// pliant_joint_settings::kind.
enum
{
	PLIANT_JOINT_POINT = 0, ///< holds a point; all rotations are free. Default.
	PLIANT_JOINT_HINGE,     ///< rotates about the x axis of the joint's pose
	PLIANT_JOINT_SLIDER,    ///< moves along the x axis of the joint's pose, and does not rotate
	PLIANT_JOINT_FIXED      ///< holds the pose
};

/// How a joint is made.
typedef struct pliant_joint_settings
{
	uint32_t size;           ///< of the structure, bytes
	int32_t kind;            ///< PLIANT_JOINT_...
	pliant_pose pose;        ///< where it holds the bodies, world. Default: at the origin, not turned.
	double low;              ///< least angle of a hinge, rad, -pi to pi, or position of a slider, m; 0 is the pose when made
	double high;             ///< largest. Below `low`: without limits. Default: low 1, high -1.
	double motor_velocity;   ///< of the second body against the first, rad/s about or m/s along the x axis, at most 1e5. Default 0.
	double motor_force;      ///< largest force, N, or moment, N m, 0 to 1e12. Default 0: no motor.
	double breaking_impulse; ///< in one internal step of Bullet's, N s, 0 and above. Default 0: it never breaks.
	int32_t bodies_collide;  ///< flag: the two bodies collide with each other. Default 0.
	int32_t reserved;        ///< 0
} pliant_joint_settings;

/// A joint now.
typedef struct pliant_joint_state
{
	uint32_t size;         ///< of the structure, bytes
	int32_t is_broken;     ///< flag: it has broken and holds nothing
	pliant_id first;       ///< body
	pliant_id second;      ///< body; 0: the world
	double position;       ///< of the second body against the first: a hinge's angle, rad, or a slider's position, m; 0 for others
	double impulse;        ///< of the last step, N s
	double motor_velocity; ///< as in pliant_joint_settings
	double motor_force;    ///< as in pliant_joint_settings
} pliant_joint_state;

/// Fills settings with their defaults. `size`: sizeof( pliant_joint_settings ).
PLIANT_API pliant_result pliant_joint_settings_init( pliant_joint_settings* settings, uint32_t size );

/// Joins two rigid bodies or frames, or one to the world with `second` 0, and wakes them. `settings`: may be null: the defaults. `made`:
/// the joint's identity. It ends with either body. Errors: PLIANT_BAD_SETTINGS; PLIANT_BAD_ARGUMENT for a soft body, for twice the same
/// body and where neither is dynamic; PLIANT_NO_SUCH_OBJECT.
PLIANT_API pliant_result pliant_joint_create(
	pliant_world* world, pliant_id first, pliant_id second, const pliant_joint_settings* settings, pliant_id* made );
/// Ends a joint, and wakes its bodies. Errors: PLIANT_NO_SUCH_OBJECT, as for the following.
PLIANT_API pliant_result pliant_joint_destroy( pliant_world* world, pliant_id joint );
/// Sets the motor of a hinge or a slider, and wakes the bodies: pliant_joint_settings. Errors: PLIANT_BAD_ARGUMENT, also for other kinds.
PLIANT_API pliant_result pliant_joint_set_motor( pliant_world* world, pliant_id joint, double velocity, double force );
/// Its state. `size`: sizeof( pliant_joint_state ).
PLIANT_API pliant_result pliant_joint_get_state( const pliant_world* world, pliant_id joint, pliant_joint_state* state, uint32_t size );

#ifdef __cplusplus
}
#endif
