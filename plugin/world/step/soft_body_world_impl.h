#pragma once

// What stands behind a SoftBodyWorld.

#include "pliant/soft_body_world.h"
#include "world/respond/moved_contacts.h"
#include "world/respond/restitution.h"
#include "world/respond/rolling_friction.h"
#include "world/step/pass_objects.h"
#include "world/step/soft_body_system.h"
#include "world/step/step_impulses.h"
#include "world/touch/manifold_view.h"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

namespace pliant {

struct SoftBodyWorld::System
{
	System( SoftBodyWorld& world, btDispatcher* dispatcher ) : bodies( world, dispatcher ) {}

	SoftBodySystem bodies;
	RollingFriction turning;
	RestitutionCorrection bounces;
	MovedContacts moved;
	ManifoldView view;              ///< the manifolds of a pass
	PassObjects<btRigidBody> rigid; ///< the world's own arrays, while a pass sees its part of them
	PassObjects<btTypedConstraint> joints;
	LentObjects lent;
	StepImpulses impulses;
	/// Of the last game step's passes, s; the same where there was one pass only; 0: there was no step.
	struct Lengths
	{
		btScalar whole = btScalar( 0 ), substep = btScalar( 0 );
	};
	Lengths lengths;
	int substep = 0;
	btScalar gameStep = btScalar( 0 ); ///< s
	bool isNewStep = false;            ///< no pass of the game step has begun
	bool isStepping = false;           ///< a soft body is awake: the overrides do their part
	bool isTickOver = false;           ///< the game's step has ended: the next one begins with no events

	/// Something asks Bullet between substeps where soft bodies are. Actions may ask anything (a vehicle's wheels cast rays), and Bullet's
	/// continuous detection sweeps bodies against all that is there.
	static bool isAsked( const SoftBodyWorld& world );
	/// The world's arrays hold what the pass moves, and its dispatcher shows the manifolds of that.
	void beginPass( SoftBodyWorld& world, StepPass pass );
	void endPass( SoftBodyWorld& world );
	/// The game step's passes over the stages, the actions and the sleep of what takes it whole.
	void stepGroups( SoftBodyWorld& world, btScalar timeStep, int substeps );
	void stepPass( SoftBodyWorld& world, btScalar h );
	void showPass( SoftBodyWorld& world );
	void carryImpulses( SoftBodyWorld& world, btScalar h );
	void updateBoxes( SoftBodyWorld& world );
	void detectPass( SoftBodyWorld& world );
	/// The world is about to remove an object.
	void forget( btCollisionObject& object, int objectCount )
	{
		bodies.group.noteRemoval( object, objectCount );
		lent.forget( object );
		if ( btRigidBody* const body = btRigidBody::upcast( &object ) )
		{
			rigid.forget( body );
		}
	}
};

} // namespace pliant
