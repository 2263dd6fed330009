#pragma once

// The way of kinematic rigid bodies within a game step, for bodies that take it in substeps. Bullet has a kinematic body at the end of its
// way from the start of stepSimulation on, with the velocity of the way. A substep that found it there would be pushed by the displacement
// of all substeps at once. What the game puts somewhere else altogether has no way, and is at its end at once.

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
	/// Forgets them: what follows is no game step of that stepSimulation.
	void clear() { m_ways.clear(); }
	/// At the start of a game step: finds what moves.
	void beginStep( const btCollisionObjectArray& objects );
	/// Before a substep: puts what moves to where it is at the end of the substep, `fraction` of the game step.
	void place( btScalar fraction );
	/// After the last substep, and wherever a step has ended: puts it to the end of its way.
	void finish();
	/// The box in the broadphase of a moving body, which contains all of its way in the step. Returns false for other objects.
	bool boxOf( const btCollisionObject& object, btVector3& low, btVector3& high ) const;
	void forget( const btCollisionObject& object );

private:
	struct Way
	{
		btRigidBody* body;
		int index; ///< in the world's list of objects
		btTransform start, end;
		bool moves; ///< in this game step
	};
	btTransform poseAt( const Way& way, btScalar fraction ) const;

	std::vector<Way> m_ways; ///< of active kinematic bodies
	int m_steps = 1;         ///< game steps in the stepSimulation
	int m_step = 0;          ///< begun so far
};

} // namespace pliant
