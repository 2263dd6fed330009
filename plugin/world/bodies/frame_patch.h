#pragma once

// Common to the two source files of frames.

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

} // namespace pliant
