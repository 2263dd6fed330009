#pragma once

// Common to the two source files of frames.

#include "world/bodies/soft_body_impl.h"
#include "world/joints/frames.h"

namespace pliant {

/// The matrix of the cross product a x.
inline Eigen::Matrix3d hat( const Vec3d& a )
{
	Eigen::Matrix3d m;
	m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
	return m;
}

inline NodeState& nodesOf( SoftBody& body )
{
	return body.impl().body->nodes();
}

/// Sets the mobility of a patch of free nodes.
void setFreeMobility( Frame& frame );

} // namespace pliant
