#pragma once

// A body, soft or rigid, as something that turns as a whole.

#include "lattice/lattice.h"

class btCollisionObject;
class btRigidBody;

namespace pliant {

class SoftBody;

struct RigidMotionProxy
{
	SoftBody* soft = nullptr;
	btRigidBody* rigid = nullptr;
	Vec3d speed = Vec3d::Zero();                       ///< rad/s
	Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero(); ///< of its inertia; 0: nothing turns it
	Vec3d centre = Vec3d::Zero();                      ///< of a soft body's mass, relative to its origin, m

	explicit RigidMotionProxy( btCollisionObject* object );
	/// By an impulse of N m s; of a soft body all nodes turn.
	void turn( const Vec3d& impulse );

private:
	void measure();
};

/// Whether solvers work on what is between the two; they leave alone what sleeps, and impulses there are those of when it fell asleep.
bool areSolved( const btCollisionObject& first, const btCollisionObject& second );

} // namespace pliant
