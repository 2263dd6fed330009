#pragma once

// Soft bodies that follow an animated pose. pliant/game/skeleton.h describes each call and its errors.

#include "pliant/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/// The bones that move the vertices of a body's mesh: pliant::SkinWeights. Arrays are read during the call only.
typedef struct pliant_skin_weights
{
	uint32_t size;        ///< of the structure, bytes
	int32_t per_vertex;   ///< bones of a vertex, 1 to 4. Default 4.
	const int32_t* bones; ///< per_vertex numbers a vertex, 0 to bone_count - 1; one of weight 0 may be any number
	const float* weights; ///< as many weights, 0 and above; those of a vertex are divided by their sum, above 0
	int32_t vertex_count; ///< as of the mesh that the template was built from
	int32_t bone_count;   ///< at least 1
} pliant_skin_weights;

/// Springs from a body's cells to the pose: pliant::PoseSettings.
typedef struct pliant_pose_settings
{
	uint32_t size;       ///< of the structure, bytes
	float frequency;     ///< of a cell alone on its spring, Hz, above 0; infinity: held. Default 4.
	float damping_ratio; ///< fraction of the critical damping, 0 to 10. Default 0.3.
	uint32_t reserved;   ///< 0
	/// Called once for each cell. `point`: 3 floats, mesh coordinates, m. Writes the `strength` of the cell's spring, 0 to 1, and the
	/// `largest_distance` from its target, m, above 0; initially 1 and infinity, which hold for all cells where this is null.
	void ( *paint )( const float* point, float* strength, float* largest_distance, void* context );
	void* paint_context; ///< passed to `paint`
} pliant_pose_settings;

/// Fills weights with their defaults. `size`: sizeof( pliant_skin_weights ).
PLIANT_API pliant_result pliant_skin_weights_init( pliant_skin_weights* weights, uint32_t size );
/// Fills settings with their defaults. `size`: sizeof( pliant_pose_settings ).
PLIANT_API pliant_result pliant_pose_settings_init( pliant_pose_settings* settings, uint32_t size );

/// Lets a body follow bones, from the first pliant_body_set_pose on. `settings`: may be null: the defaults.
PLIANT_API pliant_result pliant_body_follow_bones(
	pliant_world* world, pliant_id body, const pliant_skin_weights* weights, const pliant_pose_settings* settings );
/// Lets a body follow positions that the game gives by pliant_body_set_targets.
PLIANT_API pliant_result pliant_body_follow_targets( pliant_world* world, pliant_id body, const pliant_pose_settings* settings );
/// Ends following; the body keeps its velocity. No effect on a body that follows nothing.
PLIANT_API pliant_result pliant_body_stop_following( pliant_world* world, pliant_id body );
/// Whether the body follows bones or targets: 1 or 0.
PLIANT_API pliant_result pliant_body_get_following( const pliant_world* world, pliant_id body, int32_t* is_following );

/// The pose at the end of the next step. `bones`: for each of `count` bones the 12 numbers of a 3 x 4 matrix, row by row, from mesh
/// coordinates in the bind pose to the world, m; it may scale. `jumps`: flag: the targets are there at once, without a velocity.
PLIANT_API pliant_result pliant_body_set_pose( pliant_world* world, pliant_id body, const double* bones, int32_t count, int32_t jumps );
/// The same for a body that follows targets. `positions`: 3 numbers for each of `count` cells of the template, world, m.
PLIANT_API pliant_result pliant_body_set_targets(
	pliant_world* world, pliant_id body, const double* positions, int32_t count, int32_t jumps );
/// The position of a cell of the template in the last pose, world, m; 0 for a missing cell and without a pose.
PLIANT_API pliant_result pliant_body_get_pose_target( const pliant_world* world, pliant_id body, int32_t cell, pliant_vec3* target );
/// Sets the fraction of the pose that acts, 0 to 1. Default 1.
PLIANT_API pliant_result pliant_body_set_pose_blend( pliant_world* world, pliant_id body, double blend );
/// The blend last set; 0 for a body that follows nothing.
PLIANT_API pliant_result pliant_body_get_pose_blend( const pliant_world* world, pliant_id body, double* blend );
/// The mean force, N, and torque about the mass centre, N m, of the skeleton on the body in the last step; each may be null.
PLIANT_API pliant_result pliant_body_get_pose_force( const pliant_world* world, pliant_id body, pliant_vec3* force, pliant_vec3* torque );

#ifdef __cplusplus
}
#endif
