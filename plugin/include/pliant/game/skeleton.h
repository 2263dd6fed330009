#pragma once

// Soft bodies that follow an animated pose, with springs from their cells to where the pose has them: flesh on a character. The blend fades
// the springs in and out at run time: at 0 the body is free, with the velocity it had.
//
//     pliant::followBones( *body, weights, settings );
//     // before each step of the world, with the transforms of the step's end:
//     pliant::setPose( *body, bones, boneCount );

#include "pliant/export.h"
#include "pliant/result.h"

#include <LinearMath/btScalar.h>
#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include <limits>

namespace pliant {

class SoftBody;

/// Which bones move the vertices of a body's mesh: as of skinned models. Read during followBones only.
struct SkinWeights
{
	const int* bones = nullptr;     ///< perVertex bone numbers a vertex, 0 to boneCount - 1; one of weight 0 may be any number
	const float* weights = nullptr; ///< perVertex weights a vertex, at least 0; each vertex's are divided by their sum, above 0
	int perVertex = 4;              ///< 1 to 4
	int vertexCount = 0;            ///< as BodyTemplate::vertexCount
	int boneCount = 0;              ///< at least 1
};

/// How a cell follows the pose.
struct PosePaint
{
	/// Factor on the stiffness of its spring, [0, 1]; 0: it does not follow.
	float strength = 1.0f;
	/// Largest distance from its target, m, above 0; default: any. Divided by the blend.
	float largestDistance = std::numeric_limits<float>::infinity();
};

/// Springs from a body's cells to their targets. They act within the solution of the step: any frequency is stable at any step.
struct PoseSettings
{
	/// Of a cell of strength 1 alone on its spring, Hz, above 0; infinity: held at its target.
	float frequency = 4.0f;
	/// Damping of its velocity relative to the target's, as a fraction of the critical one, 0 to 10. Infinite frequency ignores it.
	float dampingRatio = 0.3f;
	/// Called once for each cell of the template. `point`: 3 floats, the centre of mass of its material, mesh coordinates, m. Null: the
	/// default PosePaint for every cell.
	PosePaint ( *paint )( const float* point, void* context ) = nullptr;
	void* context = nullptr; ///< passed to `paint`; used during the call only
};

/// Lets a body follow bones: its cells get the weights of the mesh's vertices near them. It follows from the first setPose on; pieces that
/// break off follow too, and changes of levels keep the targets. Replaces the former bones or targets. BadArgument for bad weights, numbers
/// of bones and counts, and for a template without a skin; BadSettings for `settings` and for bad return values of `paint`.
PLIANT_API Status followBones( SoftBody& body, const SkinWeights& weights, const PoseSettings& settings = {} );
/// The same with targets that the game gives by setTargets.
PLIANT_API Status followTargets( SoftBody& body, const PoseSettings& settings = {} );
/// Frees the body; it keeps its velocity. Does nothing for a body that follows nothing.
PLIANT_API void stopFollowing( SoftBody& body );
/// Whether followBones or followTargets was called, and not stopFollowing.
[[nodiscard]] PLIANT_API bool isFollowing( const SoftBody& body );

/// The pose at the end of the next step of the world, `count` transforms, one for each bone, from mesh coordinates in the bind pose to the
/// world (of a skeleton: bone times inverse bind matrix); they may scale. Until then the targets move evenly, afterwards they keep their
/// positions until the next call. `jumps`: the targets move there at once, without a velocity, as after a teleport of the character. Wakes
/// the body if they move. BadArgument for a body that does not follow bones, another count, bad numbers, and where a cell would be farther
/// than 1e9 m from the origin.
PLIANT_API Status setPose( SoftBody& body, const btTransform* bones, int count, bool jumps = false );
/// The same for a body that follows targets: `count` world positions, m, one for each cell of the template (BodyTemplate::cellCount).
PLIANT_API Status setTargets( SoftBody& body, const btVector3* positions, int count, bool jumps = false );
/// Where the pose last given has a cell of the template, world, m. Zero for an index out of range and a body without a pose.
[[nodiscard]] PLIANT_API btVector3 poseTarget( const SoftBody& body, int cell );

/// Sets how much of the pose acts: factor on the stiffness of all springs, [0, 1], default 1. At 0 the body is free. BadArgument for
/// another number and for a body that follows nothing.
PLIANT_API Status setPoseBlend( SoftBody& body, btScalar blend );
/// The blend last set; 0 for a body that follows nothing.
[[nodiscard]] PLIANT_API btScalar poseBlend( const SoftBody& body );

/// Force of the skeleton on a body.
struct PoseForce
{
	btVector3 force = btVector3( 0, 0, 0 );  ///< N, the sum over the body
	btVector3 torque = btVector3( 0, 0, 0 ); ///< N m, about the centre of mass
};

/// The mean over the last step. The skeleton represents the character, so nothing receives the reaction: a game in which the soft body
/// should pull on a rigid body applies the reaction there.
[[nodiscard]] PLIANT_API PoseForce poseForce( const SoftBody& body );

} // namespace pliant
