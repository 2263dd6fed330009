#pragma once

// One world's step: the soft bodies, all corrections around Bullet's solver, and the order in which they are called (world_step.cpp).
// SoftBodyHost calls it from the world's overrides of Bullet's stages.

#include "pliant/soft_body_host.h"
#include "world/respond/moved_contacts.h"
#include "world/respond/rolling_friction.h"
#include "world/rigid/lost_contacts.h"
#include "world/step/kinematic_motion.h"
#include "world/step/pass_objects.h"
#include "world/step/soft_body_system.h"
#include "world/step/step_impulses.h"
#include "world/touch/manifold_view.h"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

namespace pliant {

class WorldSnapshot;

class WorldStep
{
public:
	WorldStep( BulletStages& stages, const BulletStages::Parts& parts );
	/// Before the world is destroyed: removes its soft bodies and deletes fragments that the game has not released.
	void leave();

	SoftBodySystem bodies;

	// Called by the world (soft_body_host.h), in the order of a step.
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
	void forget( btMultiBody& body ) { m_multiBodies.forget( &body ); }
	void forget( btMultiBodyConstraint& joint ) { m_multiBodyJoints.forget( &joint ); }

	void serialize( btSerializer& serializer );
	Status shiftOrigin( const btVector3& by );
	btDiscreteDynamicsWorld& world() const { return m_parts.world; }

private:
	friend class WorldSnapshot;
	void openTick();
	void makePasses( btScalar timeStep, int substeps );
	void runPass( btScalar h );
	void runStages( btScalar h );
	/// Reduces the world's arrays to the objects of the pass; showPass() does so for the dispatcher's manifolds.
	void beginPass( StepPass pass );
	void endPass();
	void showPass();
	void carryImpulses( btScalar h );
	void updateBoxes();
	void detectWhole();
	void detectPass();
	void findPassIslands();
	void forgetObject( btCollisionObject& object );

	BulletStages& m_stages;
	BulletStages::Parts m_parts;
	RollingFriction m_rolling;
	MovedContacts m_moved;
	ManifoldView m_view;              ///< the manifolds of a pass
	PassObjects<btRigidBody> m_rigid; ///< the world's full arrays, while a pass sees a part of them
	PassObjects<btTypedConstraint> m_joints;
	PassObjects<btMultiBody> m_multiBodies;
	PassObjects<btMultiBodyConstraint> m_multiBodyJoints;
	OutsideObjects m_outside;
	StepImpulses m_impulses;
	LostContacts m_lostContacts;
	KinematicMotion m_kinematic;
	/// Step lengths of the last game step's passes, s; equal if there was one kind of pass only; 0: there was no step.
	struct Lengths
	{
		btScalar whole = btScalar( 0 ), substep = btScalar( 0 );
	};
	Lengths m_lengths;
	int m_substep = 0;
	btScalar m_gameStep = btScalar( 0 ), m_passLength = btScalar( 0 ); ///< s
	bool m_isNewStep = false;                                          ///< no pass of the game step has begun
	bool m_isStepping = false;                                         ///< a soft body is awake: the stages process soft bodies
	bool m_isTickOver = false;                                         ///< the game step has ended: the next one clears the events
};

} // namespace pliant
