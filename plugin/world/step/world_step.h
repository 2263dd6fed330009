#pragma once

// One world's step: the soft bodies, all corrections around Bullet's solver, and the order in which they take their turns
// (world_step.cpp). SoftBodyHost calls it from the world's overrides of Bullet's stages.

#include "pliant/soft_body_host.h"
#include "world/respond/friction_torque_correction.h"
#include "world/respond/moved_contacts.h"
#include "world/respond/restitution.h"
#include "world/respond/rolling_friction.h"
#include "world/step/pass_objects.h"
#include "world/step/soft_body_system.h"
#include "world/step/step_impulses.h"
#include "world/touch/manifold_view.h"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

namespace pliant {

class WorldStep
{
public:
	WorldStep( BulletStages& stages, const BulletStages::Parts& parts );
	/// Before the world goes: soft bodies leave it; fragments that nobody has taken over are deleted.
	void leave();

	SoftBodySystem bodies;
	FrictionTorqueCorrection frictionTorque;

	// The world's calls (soft_body_host.h), in the order of a step.
	bool beginTick( btScalar& timeStep, int maxSubSteps, btScalar fixedTimeStep );
	void singleStep( btScalar timeStep );
	void predict( btScalar h );
	void findPredictiveContacts( btScalar h );
	void detect();
	void findIslands();
	void solve( btContactSolverInfo& info );
	void integrate( btScalar h );
	void updateActivation( btScalar h );
	void endTick();

	// Membership.
	void add( btCollisionObject* object, int group, int mask );
	void addSoftBody( SoftBody* body, int group, int mask );
	void remove( btCollisionObject* object );
	void forget( btRigidBody& body );
	void forget( btTypedConstraint& joint );

	void serialize( btSerializer& serializer );
	btDiscreteDynamicsWorld& world() const { return m_parts.world; }

private:
	void makePasses( btScalar timeStep, int substeps );
	void runPass( btScalar h );
	void runStages( btScalar h );
	/// The world's arrays hold what the pass moves, and its dispatcher shows the manifolds of that.
	void beginPass( StepPass pass );
	void endPass();
	void showPass();
	void carryImpulses( btScalar h );
	void updateBoxes();
	void detectPass();
	void findPassIslands();
	/// Something asks Bullet between substeps where soft bodies are. Actions may ask anything (a vehicle's wheels cast rays), and Bullet's
	/// continuous detection sweeps bodies against all that is there.
	bool isAsked() const;
	void forgetObject( btCollisionObject& object );

	BulletStages& m_stages;
	BulletStages::Parts m_parts;
	RollingFriction m_rolling;
	RestitutionCorrection m_restitution;
	MovedContacts m_moved;
	ManifoldView m_view;              ///< the manifolds of a pass
	PassObjects<btRigidBody> m_rigid; ///< the world's own arrays, while a pass sees its part of them
	PassObjects<btTypedConstraint> m_joints;
	LentObjects m_lent;
	StepImpulses m_impulses;
	/// Of the last game step's passes, s; the same where there was one pass only; 0: there was no step.
	struct Lengths
	{
		btScalar whole = btScalar( 0 ), substep = btScalar( 0 );
	};
	Lengths m_lengths;
	int m_substep = 0;
	btScalar m_gameStep = btScalar( 0 ), m_passLength = btScalar( 0 ); ///< s
	bool m_isNewStep = false;                                          ///< no pass of the game step has begun
	bool m_isStepping = false;                                         ///< a soft body is awake: the stages do their part
	bool m_isTickOver = false;                                         ///< the game's step has ended: the next one begins with no events
};

} // namespace pliant
