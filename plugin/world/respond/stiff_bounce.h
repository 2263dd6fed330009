#pragma once

// Rebound of explicit bodies that are stiffer than their step reaches. docs/design/contacts.md, Restitution.

#include "lattice/lattice.h"

#include <LinearMath/btScalar.h>

#include <vector>

class btDispatcher;
class btPersistentManifold;
struct btContactSolverInfo;

namespace pliant {

class SoftBody;

/// Such a body is simulated softer than it is: it would be compressed for many substeps and rebound by that compression, whatever its
/// restitution is. With its own stiffness the impact lies within a substep, so the body bounces as a whole, as a rigid one: after the
/// solver, which has stopped the nodes that touch, their impulses are raised until the rigid motion has the velocity of restitution.
class StiffBounce
{
public:
	/// Called before the solver, and before RestitutionCorrection changes the contacts' restitution.
	void note( btDispatcher& dispatcher, const std::vector<SoftBody*>& bodies );
	/// Called when the nodes have the velocities of the solver.
	void apply( const btContactSolverInfo& info );
	/// Called when the impulses have been reported: restores those of the solver.
	void restore();

private:
	struct Contact
	{
		btPersistentManifold* manifold;
		int point;
		SoftBody* body;
		double restitution;
		// Of a contact that presses:
		double impulse = 0.0;         ///< P, N s
		Vec3d normal = Vec3d::Zero(); ///< towards the body
		Vec3d arm = Vec3d::Zero();    ///< of the node, from the body's mass centre, m
		double velocity = 0.0;        ///< separation velocity of the rigid motions, m/s
		double response = 0.0;        ///< its change by the impulses of all contacts of the body, m/s
		double target = 0.0;          ///< separation velocity of the rigid motions after the bounce, m/s
	};
	struct RigidMotion;

	RigidMotion listPressing( SoftBody& body );
	void bounce( SoftBody& body, double threshold );
	void measure( const RigidMotion& motion );
	void raise( SoftBody& body, const RigidMotion& motion, double fraction );
	void rub( SoftBody& body, const RigidMotion& motion, double impulse );

	std::vector<Contact> m_contacts;
	std::vector<Contact*> m_pressing; ///< of the body in hand
};

} // namespace pliant
