#pragma once

// The rigid state of a body (Material::rigidStrain): while its deformation is invisible, its nodes keep their positions in a frame that
// moves as one rigid body.

#include "lattice/lattice.h"
#include "matching/node_state.h"

namespace pliant {

/// Position and motion of a rigid frame, whose axes are the body's principal axes.
struct RigidMotion
{
	Vec3d centre = Vec3d::Zero(); ///< of mass, world, m
	Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
	Vec3d velocity = Vec3d::Zero();        ///< m/s
	Vec3d angularVelocity = Vec3d::Zero(); ///< rad/s
};

struct RigidState
{
	RigidMotion motion;
	double mass = 0.0; ///< kg
	Vec3d moments =
		Vec3d::Zero();   ///< principal moments of inertia, kg m^2; 0: all nodes are on that axis, and the body has no spin about it
	Vec3Array arm;       ///< node positions in the frame, m
	bool isBent = false; ///< by more than Body::largestInvisibleStrain, by a load that has to stay
	bool isHeld = false; ///< by pinned nodes: it is at rest until it deforms
};

/// Moves a free rigid body by h, s, at constant angular momentum.
RigidMotion advanced( const RigidState& state, const RigidMotion& motion, double h );

} // namespace pliant
