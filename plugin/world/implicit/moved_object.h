#pragma once

// What an implicit block moves beside soft bodies: rigid bodies, and links of multibodies. A link is a rigid body with its own mass and
// inertia; its impulses move the whole multibody, and what its joints add is estimated from the last substeps, as for a rigid body on a
// joint.

#include "world/implicit/implicit_block.h"

#include <LinearMath/btAlignedObjectArray.h>
#include <LinearMath/btMatrix3x3.h>

class btCollisionObject;
class btMultiBodyLinkCollider;

namespace pliant {

/// Returns true for a link of a multibody.
bool isLink( const btCollisionObject& object );

class MovedObjects
{
public:
	/// Fills mass, inertia, centre and locked axes. Returns false for a link that its joints or its fixed base hold.
	bool measure( btCollisionObject& object, RigidPart& part );
	/// Returns the velocity at the centre, m/s, and the angular velocity, rad/s.
	Vector6 velocityOf( const btCollisionObject& object );
	/// Returns the velocity change within h, s, that Bullet's solver adds for applied forces; of a link zero: it counts as a joint's.
	static Vector6 forceOf( const btCollisionObject& object, double h );
	/// Sets a rigid body's velocity where its axes are free. Gives a link's multibody the impulse that the block's solution has for the
	/// link instead, whatever `velocity` is.
	void move( const RigidPart& part, const Vector6& velocity );

private:
	void fillJacobian( const btMultiBodyLinkCollider& link );
	/// Writes the change of the multibody's velocities under an impulse and angular impulse at the link's centre to m_change.
	void respond( const btMultiBodyLinkCollider& link, const Vector6& impulse );

	btAlignedObjectArray<btScalar> m_jacobian[6], m_force, m_change, m_scratch; ///< by degree of freedom
	btAlignedObjectArray<btVector3> m_vectors;
	btAlignedObjectArray<btMatrix3x3> m_matrices;
};

} // namespace pliant
