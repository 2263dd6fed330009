#pragma once

// What every matching method offers the body's step: goals from the nodes' positions, and the velocity change towards them.

#include "matching/node_state.h"
#include "matching/stiffness.h"

#include <Eigen/Geometry>

#include <cstddef>

namespace pliant {

class TaskRunner;

/// How rest shapes flow; see plasticity.h.
struct PlasticLaw
{
	float yieldStrain = 0.0f; ///< 0: they do not
	float creep = 0.0f;       ///< 1/s
	float limit = 0.0f;
};

/// What one substep asks for.
struct MatchStep
{
	float h = 0.0f;              ///< substep, s, above 0
	float alpha = 1.0f;          ///< share of the way to the goal, (0, 1]
	float damping = 0.0f;        ///< 1/s; the factor a substep is k = 1 - exp(-damping h)
	float wobbleDamping = 0.0f;  ///< 1/s, of all motion that is no rigid motion of the whole body, or of the part of it a node belongs to
	float bodyFraction = 0.0f;   ///< share of the goal that is the whole body's rigid fit instead of the regions', [0, 1]
	bool measuresStrain = false; ///< keep what `strain` and `stretch` tell of this substep
	PlasticLaw plastic = {};
	FarFractions far = {};     ///< shares of the way to the goal on the far levels, where the matcher has them
	bool isOnePart = true;     ///< false: the body's cells may fall into several parts that nothing links
	float wobbleLength = 1.0f; ///< m, length of the body `wobbleDamping` is meant for; a part is damped as much faster as it is shorter
};

class Matcher
{
public:
	virtual ~Matcher() = default;

	/// Forget all history; the body stands at rest shape turned by `rotation`. What has flowed stays as it is.
	virtual void reset( const NodeState& nodes, const Eigen::Quaterniond& rotation ) = 0;

	/// The rest shape is once more the one the body was made with.
	virtual void forgetFlow() {}

	/// The whole body was turned by `by` from outside: turn the history along.
	virtual void turn( const Eigen::Quaterniond& by ) = 0;

	/// v += (alpha e + k de) / h for every free node, e = goal - position. Internal forces only: linear and angular momentum
	/// of all nodes together stay as they were, but for rounding. `runner` may be null.
	virtual void accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner ) = 0;

	/// Writes, for each node, the unit quaternion (x, y, z, w) of the rotation of its own region from rest to now.
	virtual void nodeRotations( const NodeState& nodes, float* quaternions ) const = 0;

	/// Writes each region's flowed stretch S_p, 9 floats a region, row by row; false, and nothing written, where nothing has flowed.
	virtual bool nodeFlow( int /*count*/, float* /*stretches*/ ) const { return false; }
	/// Whether it would.
	virtual bool hasFlowed() const { return false; }

	/// Bytes held, buffers included, what is shared with other bodies left out.
	virtual std::size_t bytes() const = 0;
	/// Bytes shared with other bodies of the same template and setting.
	virtual std::size_t sharedBytes() const { return 0; }
};

} // namespace pliant
