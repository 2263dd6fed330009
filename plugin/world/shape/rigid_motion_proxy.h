#pragma once

// The rigid rotation of a body, soft or rigid.

#include "lattice/lattice.h"

class btCollisionObject;
class btRigidBody;

namespace pliant {

class SoftBody;

struct RigidMotionProxy
{
	SoftBody* soft = nullptr;
	btRigidBody* rigid = nullptr;
	Vec3d angularVelocity = Vec3d::Zero();                    ///< rad/s
	Eigen::Matrix3d inverseInertia = Eigen::Matrix3d::Zero(); ///< of the inertia tensor; 0: not rotatable
	Vec3d centre = Vec3d::Zero();                             ///< mass centre of a soft body, relative to its origin, m

	explicit RigidMotionProxy( btCollisionObject* object );
	/// Applies an angular impulse, N m s; all nodes of a soft body rotate.
	void turn( const Vec3d& impulse );

private:
	void measure();
};

/// Whether solvers act between the two; contacts of sleeping bodies keep the impulses of when they fell asleep.
bool areSolved( const btCollisionObject& first, const btCollisionObject& second );

} // namespace pliant
