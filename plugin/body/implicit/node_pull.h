#pragma once

// Nodes that something outside draws toward velocities, as the pose of a skeleton does: v += gain ( u - v' ), v' the velocity at the end of
// the substep, so that no gain is too large. With springs of frequency omega and damping ratio zeta gain = h^2 omega^2 + 2 h zeta omega.

#include "matching/node_state.h"

namespace pliant {

/// Empty arrays: nothing draws the body's nodes.
struct NodePull
{
	AlignedArray<float> gain; ///< by node, at least 0
	Vec3Array velocity;       ///< u, m/s

	bool isOn() const { return !gain.empty(); }
	void resize( int padded )
	{
		gain.assign( std::size_t( padded ), 0.0f );
		velocity.resize( padded );
	}
	void clear()
	{
		gain.clear();
		velocity = Vec3Array{};
	}
};

} // namespace pliant
