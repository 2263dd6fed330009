#pragma once

// Interface of every matching method: goals from the nodes' positions, and the velocity change towards them.

#include "matching/node_state.h"
#include "matching/stiffness.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pliant {

class Archive;
class TaskRunner;

/// Plastic flow of rest shapes; see plasticity.h.
struct PlasticLaw
{
	float yieldStrain = 0.0f; ///< 0: no flow
	float creep = 0.0f;       ///< 1/s
	float limit = 0.0f;
};

/// Parameters of one substep.
struct MatchStep
{
	float h = 0.0f;              ///< substep, s, above 0
	float alpha = 1.0f;          ///< fraction of the displacement to the goal, (0, 1]
	float damping = 0.0f;        ///< 1/s; the factor per substep is k = 1 - exp(-damping h)
	float wobbleDamping = 0.0f;  ///< 1/s, of all motion except rigid motion of the whole body, or of the connected part of the node
	float bodyFraction = 0.0f;   ///< weight of the whole body's rigid fit in the goal, against the regions' goals, [0, 1]
	bool measuresStrain = false; ///< record the values that `strain` and `stretch` return for this substep
	PlasticLaw plastic = {};
	FarFractions far = {};     ///< alphas of the far levels, where the matcher has them
	bool isOnePart = true;     ///< false: the body's cells may form several unlinked parts
	float wobbleLength = 1.0f; ///< m, body length that `wobbleDamping` refers to; shorter parts are damped faster in proportion
	float mostWobble = 1.0f;   ///< largest wobble damping factor of a substep (largestWobbleFraction)
	float mostVolumeResponse = kAnyVolumeResponse; ///< largest response of volume conservation that is stable (largestVolumeResponse)
	bool storesVolumeGradients = false;            ///< for the implicit step's operator, where volume is conserved

	/// Wobble damping factor of the substep, f = 1 - exp(-rate h); `rate`: 1/s.
	double wobbleFraction( double rate ) const { return std::min( double( mostWobble ), 1.0 - std::exp( -rate * double( h ) ) ); }
};

class Matcher
{
public:
	virtual ~Matcher() = default;

	/// Discards all history; the body is at its rest shape rotated by `rotation`. Plastic flow is kept.
	virtual void reset( const NodeState& nodes, const Eigen::Quaterniond& rotation ) = 0;

	/// Restores the rest shape the body was created with.
	virtual void forgetFlow() {}

	/// Rotates the history by `by`, after the whole body was rotated from outside.
	virtual void turn( const Eigen::Quaterniond& by ) = 0;

	/// v += (alpha e + k de) / h for every free node, e = goal - position. Internal forces only: the linear and angular momentum of all
	/// nodes together is conserved up to rounding. `runner` may be null.
	virtual void accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner ) = 0;

	/// Writes, for each node, the unit quaternion (x, y, z, w) of the rotation of its own region from rest to the current shape.
	virtual void nodeRotations( const NodeState& nodes, float* quaternions ) const = 0;

	/// Writes each region's plastic stretch S_p, 9 floats per region, row-major; returns false and writes nothing if no region has flowed.
	virtual bool nodeFlow( int /*count*/, float* /*stretches*/ ) const { return false; }
	/// True where `nodeFlow` would write.
	virtual bool hasFlowed() const { return false; }

	/// Writes or reads the data that one substep passes to the next; a matcher without it is refused.
	virtual void archive( Archive& archive );
};

} // namespace pliant
