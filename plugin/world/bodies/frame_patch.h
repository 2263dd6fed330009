#pragma once

// Common to the source files of frames: the patch as a part of its body. Formulas: frames.h.

#include "matching/rotation.h"
#include "world/bodies/soft_body_impl.h"
#include "world/joints/frames.h"

namespace pliant {

inline NodeState& nodesOf( SoftBody& body )
{
	return body.impl().body->nodes();
}

/// Sets the mobility of a patch of free nodes.
void setFreeMobility( Frame& frame );

/// The velocity change of a node at `arm`, m from the frame's origin, by an impulse and angular impulse about it, B.
Vec3d velocityChange( const Frame& frame, const Eigen::Matrix3d& inverseInertia, const Vector6& impulse, const Vec3d& arm );
/// The frame's velocity, B^T v.
Vector6 velocityOfPatch( const Frame& frame );
/// W of the patch's masses alone.
Matrix6 freeMobility( const Frame& frame );
/// Sets the velocities of an implicit body by unit impulses on each of its frames.
void measureResponses( const std::vector<Frame*>& frames, const Frames::Response& response, TaskRunner* runner );
/// The velocity of a frame by unit impulses and angular impulses on another of its body, or on itself: W.
Matrix6 mobilityBetween( const Frame& frame, const Frame& other );
/// Adds the response of the body to an impulse and angular impulse on the frame.
void applyImpulse( Frame& frame, const Vector6& impulse );

} // namespace pliant
