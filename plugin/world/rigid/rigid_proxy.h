#pragma once

// The rigid body through which Bullet's solver moves a soft body in its rigid state. It belongs to no world: the soft body stays the
// collision object, with hulls for a shape, and its manifolds refer to the rigid proxy while they are solved.

#include "body/rigid_state.h"
#include "world/rigid/rigid_shape.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace pliant {

class SoftBody;

class RigidProxy : public btRigidBody
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// For a body whose core is in its rigid state. `hulls` must be kept as long as the rigid proxy.
	RigidProxy( SoftBody& owner, std::unique_ptr<RigidShape> hulls );

	/// Copies the motion of the body, and what the solver reads of its collision object.
	void follow();
	SoftBody& owner() const { return m_owner; }
	bool isHeld() const; ///< RigidState::isHeld

	/// The motion with the displacement by which the solver has pushed the rigid proxy out of penetrations since follow().
	RigidMotion pushed( const RigidMotion& motion ) const;

private:
	SoftBody& m_owner;
	btTransform m_followed;
	std::unique_ptr<RigidShape> m_hulls;
};

/// Sums of contact forces on a body in its rigid state.
struct RigidLoad
{
	double impulse = 0.0; ///< in this game step so far, N s
	double now = 0.0;     ///< in the last game step, N
	double mean = 0.0;    ///< `now`; for a body that has been slow for kLoadRest, its mean over some kMeanLoadTime
	double first = 0.0;   ///< when the body became rigid, N; for a pinned body in the game step after that, and below 0 until then
	Vec3d acceleration = Vec3d::Zero(); ///< by gravity, central force and force fields when a pinned body became rigid, m/s^2
};

/// The soft body of a rigid proxy, or null for any other object.
SoftBody* ownerOfRigidProxy( const btCollisionObject* object );

} // namespace pliant
