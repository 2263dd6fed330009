#pragma once

// What every matching method offers the body's step: goals from the nodes' positions, and the velocity change towards them.

#include "matching/node_state.h"

#include <Eigen/Geometry>

#include <cstddef>

namespace pliant {

class TaskRunner;

/// What one substep asks for.
struct MatchStep
{
	float h = 0.0f;       ///< substep, s, above 0
	float alpha = 1.0f;   ///< share of the way to the goal, (0, 1]
	float damping = 0.0f; ///< 1/s; the factor a substep is k = 1 - exp(-damping h)
	float wobbleDamping = 0.0f; ///< 1/s, of all motion that is no rigid motion of the whole body
	float bodyShare = 0.0f;     ///< share of the goal that is the whole body's rigid fit instead of the regions', [0, 1]
	bool measuresStrain = false; ///< keep what `strain` tells of this substep
};

class Matcher
{
public:
	virtual ~Matcher() = default;

	/// Forget all history; the body stands at rest shape turned by `rotation`.
	virtual void reset( const NodeState& nodes, const Eigen::Quaterniond& rotation ) = 0;

	/// The whole body was turned by `by` from outside: turn the history along.
	virtual void turn( const Eigen::Quaterniond& by ) = 0;

	/// v += (alpha e + k de) / h for every free node, e = goal - position. Internal forces only: linear and angular momentum
	/// of all nodes together stay as they were, but for rounding. `runner` may be null.
	virtual void accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner ) = 0;

	/// Writes, for each node, the unit quaternion (x, y, z, w) of the rotation of its own region from rest to now.
	virtual void nodeRotations( const NodeState& nodes, float* quaternions ) const = 0;

	/// Bytes held, buffers included, what is shared with other bodies left out.
	virtual std::size_t bytes() const = 0;
	/// Bytes shared with other bodies of the same template and setting.
	virtual std::size_t sharedBytes() const { return 0; }
};

} // namespace pliant
