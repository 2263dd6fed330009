#pragma once

// The motion of kinematic rigid bodies within a game step, for bodies that take it in substeps. Bullet has a kinematic body at the end of
// its motion from the start of stepSimulation on, with the velocity of the whole motion. The first substep would push soft bodies by the
// displacement of all substeps at once. A body that the game teleports has no motion: it is at its end at once.

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btTransform.h>

#include <vector>

class btRigidBody;

namespace pliant {

class KinematicMotion
{
public:
	/// At the start of a stepSimulation of `steps` game steps, before Bullet moves kinematic bodies to where the game wants them.
	void noteStarts( const btCollisionObjectArray& objects, int steps );
	/// Forgets them: the next steps are none of that stepSimulation.
	void clear() { m_motions.clear(); }
	/// At the start of a game step: finds the bodies that move.
	void beginStep( const btCollisionObjectArray& objects );
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
	btTransform poseAt( const Motion& motion, btScalar fraction ) const;

	std::vector<Motion> m_motions; ///< of active kinematic bodies
	int m_steps = 1;               ///< game steps in the stepSimulation
	int m_step = 0;                ///< begun so far
};

} // namespace pliant
