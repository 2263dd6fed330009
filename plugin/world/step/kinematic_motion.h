#pragma once

// The motion of kinematic bodies, rigid and soft, within a game step, for bodies that take it in substeps. A kinematic body is at the end
// of its motion from the start of stepSimulation on, with the velocity of the whole motion. The first substep would push soft bodies by the
// displacement of all substeps at once. A body that the game teleports has no motion: it is at its end at once.

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btTransform.h>

#include "lattice/lattice.h"

#include <span>
#include <vector>

class btRigidBody;

namespace pliant {

class SoftBody;

class KinematicMotion
{
public:
	/// At the start of a stepSimulation of `steps` game steps, before Bullet moves kinematic bodies to where the game wants them.
	void noteStarts( const btCollisionObjectArray& objects, int steps );
	/// Forgets them: the next steps are none of that stepSimulation.
	void clear()
	{
		m_motions.clear();
		m_softCount = 0;
	}
	/// At the start of a game step of `seconds`: finds the bodies that move.
	void beginStep( const btCollisionObjectArray& objects, btScalar seconds );
	/// Before a substep: puts the moving bodies where they are at its end, `fraction` of the game step.
	void place( btScalar fraction );
	/// After the last substep, and wherever a step has ended: puts it to the end of its motion.
	void finish();
	/// The box in the broadphase of a moving body, which contains its whole motion in the step. Returns false for other objects.
	bool boxOf( const btCollisionObject& object, btVector3& low, btVector3& high ) const;
	void forget( const btCollisionObject& object );

private:
	struct Motion
	{
		btRigidBody* body;
		int index; ///< in the world's list of objects
		btTransform start, end;
		bool moves; ///< in this game step
	};
	/// Of a soft body's nodes.
	struct NodeMotion
	{
		SoftBody* body = nullptr;
		int index = -1;                ///< in the world's list of objects
		std::vector<Vec3d> start, end; ///< world, m
		bool moves = false;
	};
	btScalar fractionOfAll( btScalar fraction ) const;
	btTransform poseAt( const Motion& motion, btScalar fraction ) const;
	void place( NodeMotion& motion, double fraction ) const;
	bool boxOf( const NodeMotion& motion, btVector3& low, btVector3& high ) const;
	std::span<NodeMotion> soft() { return { m_soft.data(), m_softCount }; }
	std::span<const NodeMotion> soft() const { return { m_soft.data(), m_softCount }; }

	std::vector<Motion> m_motions; ///< of active kinematic bodies
	std::vector<NodeMotion> m_soft;
	std::size_t m_softCount = 0;
	btScalar m_seconds = 0; ///< of a game step
	int m_steps = 1;        ///< game steps in the stepSimulation
	int m_step = 0;         ///< begun so far
};

} // namespace pliant
