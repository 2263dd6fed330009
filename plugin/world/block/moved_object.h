#pragma once

// Objects other than soft bodies that a block moves: rigid bodies, and links of multibodies. The links of a multibody that take
// part have one mass matrix: the inverse of the velocities that impulses on each of them give to all,
//
//   K = ( W + epsilon D )^-1,   W = J M^-1 J^T,   D = diag( 1 / m, I^-1 ) of the links alone
//
// with J the links' velocities by the multibody's coordinates and M its mass matrix, neither of which is formed. W is singular where joints
// hold: there epsilon makes a link very heavy. The impulses of motors, limits and contacts of other links are estimated from the last
// substeps, as for a rigid body on a joint.

#include "world/block/island_block.h"
#include "world/joints/joint_mobility.h"

#include <LinearMath/btAlignedObjectArray.h>
#include <LinearMath/btMatrix3x3.h>

class btCollisionObject;
class btMultiBodyLinkCollider;

namespace pliant {

class Attachments;

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
	/// Fills IslandBlock::linked from its rigid parts that are links.
	void measureLinks( IslandBlock& block );
	/// Sets a rigid body's velocity where its axes are free.
	void move( const RigidPart& part, const Vector6& velocity );
	/// Adds the rigid bodies on `joints` that are attached or hit to IslandBlock::linked; where one is hit, with those of its group.
	void measureJointed( IslandBlock& block, const Attachments& attachments, const JointGroup::Joints& joints, double h, double erp );
	/// Gives rigid bodies on joints, and the bodies that joints connect with them, the velocities of the block's solution.
	static void moveJointed( const IslandBlock& block );
	/// Gives multibodies the impulses that the block's solution has for their links.
	void moveLinks( const IslandBlock& block );

private:
	/// K of parts whose W is in `mass`.
	static void invertMobility( const IslandBlock& block, LinkedParts& whole );
	/// W of the links' parts.
	void fillMobility( const IslandBlock& block, LinkedParts& whole );
	void fillJacobian( const btMultiBodyLinkCollider& link );
	/// Writes the change of the multibody's velocities under an impulse and angular impulse at the link's centre to m_change.
	void respond( const btMultiBodyLinkCollider& link, const Vector6& impulse );

	btAlignedObjectArray<btScalar> m_jacobian[6], m_force, m_change, m_scratch; ///< by degree of freedom
	Eigen::MatrixXd m_changes; ///< of a multibody's velocities under unit impulses on its links, by column
	btAlignedObjectArray<btVector3> m_vectors;
	btAlignedObjectArray<btMatrix3x3> m_matrices;
};

} // namespace pliant
