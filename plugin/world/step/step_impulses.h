#pragma once

// Impulses of a game step that was made in soft substeps: what Bullet keeps and limits by the step (a contact's and a joint's applied
// impulse, a joint's breaking threshold, a motor's largest impulse) means the whole game step, as without soft bodies.

#include <LinearMath/btAlignedObjectArray.h>
#include <LinearMath/btScalar.h>

#include <vector>

class btCollisionObject;
class btDispatcher;
class btPersistentManifold;
class btTypedConstraint;

namespace pliant {

class StepImpulses
{
public:
	/// Before a game step: contacts get back the impulses of the last substep, which the solver starts from.
	void giveBack( btDispatcher& dispatcher );
	/// Before the first of several substeps: joints get their part of what they may do in the whole step.
	void begin( const btAlignedObjectArray<btTypedConstraint*>& joints, int substeps );
	/// After each substep's solution: `dispatcher` shows the manifolds that were solved.
	void add( btDispatcher& dispatcher );
	/// After the last one.
	void end( btDispatcher& dispatcher );
	/// The world removes a joint.
	void forget( const btTypedConstraint* joint );

private:
	static constexpr int kMostPoints = 4; ///< of a manifold
	struct PointImpulse
	{
		btScalar normal, lateral1, lateral2; ///< N s
	};
	struct Contact
	{
		btPersistentManifold* manifold;
		const btCollisionObject* bodies[2];
		double sum;                     ///< of the step's substeps, N s
		int points = 0;                 ///< those there were at its end
		PointImpulse last[kMostPoints]; ///< their impulses in its last substep
		btScalar shown[kMostPoints];    ///< what was written instead, N s
	};
	struct Joint
	{
		btTypedConstraint* joint;
		btScalar threshold, scaledThreshold; ///< N s
		btScalar motor, scaledMotor;         ///< N s
		double sum;                          ///< N s
	};

	Contact* find( const btPersistentManifold& manifold );

	std::vector<Contact> m_contacts;
	std::vector<Joint> m_joints;
};

} // namespace pliant
