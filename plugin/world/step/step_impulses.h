#pragma once

// Impulses of a game step that was divided into soft substeps. Values that Bullet stores or limits per step (the applied impulses of
// contacts and joints, a joint's breaking threshold, a motor's largest impulse) apply to the whole game step, as without soft bodies.

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
	/// Before a game step: restores the contacts' impulses of the last substep, from which the solver starts.
	void restoreLastSubstep( btDispatcher& dispatcher );
	/// Before the first of several substeps: divides the joints' limits by the number of substeps.
	void begin( const btAlignedObjectArray<btTypedConstraint*>& joints, int substeps );
	/// After each substep is solved: adds up its impulses. `dispatcher` lists the manifolds that were solved.
	void add( btDispatcher& dispatcher );
	/// After the last substep: writes the sums to contacts and joints and restores the joints' limits.
	void end( btDispatcher& dispatcher );
	/// Call when the world removes a joint.
	void forget( const btTypedConstraint* joint );

	static constexpr int kMostPoints = 4; ///< per manifold
	struct PointImpulse
	{
		btScalar normal, lateral1, lateral2; ///< N s
	};
	struct Contact
	{
		btPersistentManifold* manifold;
		const btCollisionObject* bodies[2];
		double sum;                          ///< of the step's substeps, N s
		int points = 0;                      ///< at the end of the step
		PointImpulse last[kMostPoints] = {}; ///< of each point, in the last substep
		btScalar shown[kMostPoints] = {};    ///< normal impulses written to the points instead, N s
	};
	/// A contact's impulses of the last game step; null where there are none.
	Contact* find( const btPersistentManifold& manifold );
	/// Discards all of them, and adds those of one contact: for a world that is restored.
	void clear() { m_contacts.clear(); }
	void add( const Contact& contact );

private:
	struct Joint
	{
		btTypedConstraint* joint;
		btScalar threshold, scaledThreshold; ///< N s
		btScalar motor, scaledMotor;         ///< N s
		double sum;                          ///< of the step's substeps, N s
	};

	std::vector<Contact> m_contacts;
	std::vector<Joint> m_joints;
};

} // namespace pliant
