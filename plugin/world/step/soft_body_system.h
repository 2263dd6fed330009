#pragma once

// The soft bodies of one world. WorldStep calls its stages, in the order of world_step.cpp.

#include "pliant/soft_body.h"
#include "pliant/step_report.h"
#include "pliant/task_runner.h"
#include "world/bodies/attachments.h"
#include "world/bodies/skin_scratch_pool.h"
#include "world/detect/node_algorithm.h"
#include "world/detect/node_contacts.h"
#include "world/implicit/implicit_choice.h"
#include "world/implicit/implicit_solve.h"
#include "world/respond/tunneling_guard.h"
#include "world/shape/contact_proxy.h"
#include "world/step/substep_group.h"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <memory>
#include <vector>

class btCollisionDispatcher;

namespace pliant {

class SoftBodySystem
{
public:
	SoftBodySystem( btDiscreteDynamicsWorld& world, btDispatcher* dispatcher );
	~SoftBodySystem();

	bool add( SoftBody& body );    ///< false when it is there already or belongs to another world
	bool remove( SoftBody& body ); ///< after it has left the world; false when it is not there
	/// Whether an object is in the world: asks the world's list for the pointer, not the object, which may be gone. `index`: where it was
	/// last; where it is.
	bool holds( const btCollisionObject* object, int& index ) const;
	/// Objects that rest on the body or hold it up.
	void wakeTouching( const SoftBody& body );
	/// Notes where the body stands in the world's list, for Bullet takes out whatever stands there.
	void findPlace( SoftBody& body ) const;
	/// What stepSimulation is asked for. False where it cannot be done; a time of more steps than can be counted is cut.
	bool acceptsSteps( btScalar& timeStep, int maxSubSteps, btScalar fixedTimeStep ) const;
	/// Before a step. False where there is nothing to be done for a step of that length; one that is longer than soft bodies can bear is
	/// cut short.
	bool openStep( btScalar& timeStep );
	/// With all pairs processed: those that the game has refused let go of their contacts.
	void releaseRefusedPairs();
	/// A body is being destroyed while it is in the world.
	void forget( SoftBody& body );
	void refreshBox( SoftBody& body );
	const std::vector<SoftBody*>& bodies() const { return m_bodies; }

	bool hasAwakeBody() const;
	/// Chooses what takes soft substeps in a game step of this length, and how many: the user's, or as many more as the stiffest awake
	/// material needs. 1 where nothing does. `canSplit`: else the whole world takes substeps where anything does.
	int planSubsteps( btScalar gameStep, const btAlignedObjectArray<btRigidBody*>& rigid,
		const btAlignedObjectArray<btTypedConstraint*>& constraints, bool canSplit );
	SubstepGroup group;

	void wakeDriven(); ///< sleeping bodies whose pins move
	void beginStep( btScalar gameStep, int substeps );
	/// What follows, up to updateActivation, is for the bodies that this pass moves.
	void beginPass( StepPass pass );
	StepPass pass() const { return m_pass; }
	void endSubsteps()
	{
		group.endSubsteps( m_world );
		copyIslandTags();
	}
	/// An awake body of the pass is in the island.
	bool isAwakeIn( int island ) const;
	bool isInPass( const btCollisionObject& object ) const { return group.moves( m_pass, object ); }
	/// Whether the pass looks for contacts of two objects.
	bool isPairInPass( const btCollisionObject& a, const btCollisionObject& b ) const
	{
		return !group.isSplit() || ( group.contains( a ) || group.contains( b ) ) == ( m_pass == StepPass::Substeps );
	}

	// One pass, in the order of world_step.cpp.
	void accelerate( btScalar h, int substep ); ///< forces, pins' speeds, shape matching, the boxes' sweep
	void collideWithThemselves( btScalar h );   ///< with the broadphase's pairs done
	void endCollision( btScalar h );            ///< with all contacts found
	void holdPredictiveContacts( btAlignedObjectArray<btPersistentManifold*>& manifolds );
	void dropPredictiveContacts();
	void copyIslandTags();
	bool isEmpty() const { return m_bodies.empty(); }
	/// Implicit bodies and what they touch, before Bullet's solver; and what that says to them afterwards.
	void solveImplicit( btDispatcher& dispatcher, const btContactSolverInfo& info );
	void noteSolved() { implicitSolve().after(); }
	void readBack();             ///< what the solver made of the touched nodes
	void holdBack( btScalar h ); ///< fast nodes, from passing through what stands
	void integrate( btScalar h, int substep );
	/// For what asks Bullet where the bodies are (rays, sweeps, contact tests) before the step has ended.
	void freshenShapes();
	void updateActivation( btScalar h );
	void endStep();
	void clearForces();
	/// Somebody is about to read this body's skin.
	void noteAsked( const SoftBody& asked );

	/// Links that are stretched too far, found after the nodes have moved; they break at the start of the next substep.
	void testLinks( btScalar h );
	/// Small pieces that have faded leave the world; to be called between game steps.
	void removeFaded();
	int removedSinceStep = 0; ///< by the last call
	/// False for what is no fragment of this world's.
	bool release( SoftBody& fragment );
	std::vector<FractureEvent> events;
	Attachments attachments;
	std::vector<SoftBody*> owned; ///< fragments that nobody has released

	void releasePinsTo( const btRigidBody& body );
	void releaseLostPins( SoftBody& body, bool isAdded );

	/// Contacts of soft bodies that the pass's last substep met.
	void countContacts( int count ) { report.softContacts = m_contactsBefore + count; }

	/// Seconds and counts of the game step, and the knobs.
	StepReport report;
	int substeps;
	int maxSubsteps;
	ContactProxyPool pool;
	PairScratch pairScratch;
	SkinScratchPool skinScratch;
	std::unique_ptr<TaskRunner> ownRunner;
	TaskRunner* runner = nullptr; ///< the game's, or null
	/// The game's, or the own.
	TaskRunner* tasks() const;
	const btDiscreteDynamicsWorld& world() const { return m_world; }

private:
	bool moves( const SoftBody& body ) const;
	void moveHeldBodies();
	ImplicitSolve& implicitSolve() { return m_implicit[int( m_pass )]; }
	/// Substeps that the body takes of the game step.
	int substepsOf( const SoftBody& body ) const;
	bool stepsImplicitly( const SoftBody& body ) const;
	/// A crumb of one node, of what may step implicitly: nothing in it is elastic, so it asks for no substeps.
	bool isImplicitPoint( const SoftBody& body ) const;
	StiffnessPlan planOf( const SoftBody& body, btScalar gameStep, int count ) const;
	Vec3 ownAcceleration( const SoftBody& body ) const; ///< gravity and the game's force, m/s^2
	/// False where a number is not finite, or a node beyond the limit of speed.
	bool sweepBox( SoftBody& body, btScalar h ) const;
	void quarantine( SoftBody& body );
	void quarantineBroken();
	void gatherAwake();
	/// work( body, runner for its own loops or null ) for each that is awake.
	template <class F>
	void forAwake( F&& work );
	void drawSkins( long long vertices );
	bool breakBodies();
	struct Broken;
	void makeFragments( std::vector<Broken>& broken );
	void settlePieces( Broken& broken );
	void advanceFading( btScalar gameStep );
	void addFragment( SoftBody& parent, std::unique_ptr<SoftBody> fragment );
	void adaptLevels( btScalar h );
	void askForContacts( SoftBody::Impl& impl ); ///< Adaptivity::refinesOnContact
	void changeLevels( SoftBody& body );
	void countNodes();
	/// What stands within `reach` of a body's nodes and collides with it, ascending by the order in which Bullet came to know it.
	std::vector<const btCollisionObject*> wallsAround( SoftBody& body, double reach );
	void keepNewNodesOut( SoftBody& body, const std::vector<Vec3>& positionBefore );
	void keepPushedNodesOut( SoftBody& body, const std::vector<Vec3>& positionBefore );
	SoftBody* bodyAfter( unsigned serial ) const;
	void removeLost();
	void noteSleepers();
	void wakeOnTheWoken();
	void drivePins( SoftBody& body, btScalar h, int substep );
	void settlePins( SoftBody& body, btScalar h, int substep );

	btDiscreteDynamicsWorld& m_world;
	btCollisionDispatcher& m_dispatcher;
	std::shared_ptr<AlgorithmTable> m_algorithms; ///< null while there is no body
	std::vector<SoftBody*> m_bodies;              ///< ascending by serial
	std::vector<ContactProxy*> m_predictive;
	ImplicitSolve m_implicit[2]; ///< by pass
	TunnelingGuard m_guard;
	std::vector<Vec3> m_positionsBefore; ///< scratch of readBack
	ImplicitChoice m_choice;
	std::vector<SoftBody*> m_awake;              ///< in this substep
	std::vector<SoftBody*> m_asleep;             ///< when the last step ended
	std::vector<SoftBody*> m_staleShapes;        ///< scratch of freshenShapes
	std::vector<SoftBody*> m_sharedOut, m_whole; ///< those of them that all threads do together, and that one does
	std::vector<SoftBody*> m_stale;              ///< scratch of noteAsked
	std::vector<std::uint32_t> m_widening;       ///< scratch of askForContacts, and the nodes' F
	std::vector<float> m_stretches;
	unsigned m_steps = 1, m_askedIn = 0; ///< game steps so far, from 1; after which of them a skin was last asked for (0: never)
	btScalar m_gameStep = btScalar( 0 );
	int m_substepCount = 1; ///< of the group that takes substeps
	StepPass m_pass = StepPass::Whole;
	int m_contactsBefore = 0;            ///< StepReport::softContacts of the pass before
	std::vector<SoftBody*> m_substepped; ///< scratch of planSubsteps
	unsigned m_serials = 0;
};

} // namespace pliant
