#pragma once

// The soft bodies of one world. WorldStep calls the stages in the order given in world_step.cpp.

#include "pliant/game/debug_draw.h"
#include "pliant/soft_body.h"
#include "pliant/soft_body_host.h"
#include "pliant/step_report.h"
#include "pliant/task_runner.h"
#include "world/block/block_solve.h"
#include "world/block/implicit_choice.h"
#include "world/bodies/skin_scratch_pool.h"
#include "world/detect/node_algorithm.h"
#include "world/detect/node_contacts.h"
#include "world/game/contact_records.h"
#include "world/game/force_fields.h"
#include "world/joints/attachments.h"
#include "world/joints/frames.h"
#include "world/respond/tunneling_guard.h"
#include "world/rigid/rigid_impacts.h"
#include "world/shape/contact_proxy.h"
#include "world/step/object_motion.h"
#include "world/step/substep_group.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <memory>
#include <vector>

class btCollisionDispatcher;

namespace pliant {

class ForecastMotions;
class WorldSnapshot;

class SoftBodySystem
{
public:
	SoftBodySystem( btDiscreteDynamicsWorld& world, btDispatcher* dispatcher );
	~SoftBodySystem();

	bool add( SoftBody& body );    ///< returns false if it is in this or another world already
	bool remove( SoftBody& body ); ///< after it has left Bullet's world; returns false if it is not in this one
	/// Whether an object is in the world. Searches the world's list for the pointer and does not dereference it, since the object may be
	/// deleted. `index`: in: where it was last; out: where it is.
	bool holds( const btCollisionObject* object, int& index ) const;
	/// Wakes the objects in contact with the body.
	void wakeTouching( const SoftBody& body );
	/// Sets the body's index in the world's list, because Bullet removes whichever object is at that index.
	void updateWorldIndex( SoftBody& body ) const;
	/// Limits the time of stepSimulation to a number of steps that can be counted. Returns false if its arguments are invalid.
	bool acceptsSteps( btScalar& timeStep, int maxSubSteps, btScalar fixedTimeStep ) const;
	/// Prepares a step and limits its length to kLongestStep. Returns false if a step of that length must be skipped.
	bool openStep( btScalar& timeStep );
	/// Releases the contacts of pairs that the game has refused. Call when all pairs are processed.
	void releaseRefusedPairs();
	/// Removes a body that is destroyed while it is in the world.
	void forget( SoftBody& body );
	void refreshBox( SoftBody& body );
	const std::vector<SoftBody*>& bodies() const { return m_bodies; }

	bool hasAwakeBody() const;
	/// Rigid states (Material::rigidStrain). At the start of a game step: bodies that an impact, a load or the game deforms leave it.
	void deformLoaded( btScalar gameStep );
	/// At the end of a game step: bodies that hardly deform enter it.
	void makeRigid( btScalar gameStep );
	/// A body leaves its rigid state. Its contacts must be removed afterwards.
	void deform( SoftBody& body );
	/// Between steps: a body in its rigid state leaves it at once, so that its nodes take impulses one by one.
	void deformNow( SoftBody& body );
	/// After a body's shape was replaced.
	void removeContacts( SoftBody& body );
	/// Around Bullet's solver: manifolds refer to the rigid proxies of bodies in their rigid state.
	void showRigidProxies( btDispatcher& dispatcher );
	void hideRigidProxies( btDispatcher& dispatcher );
	/// Of brittle bodies in their rigid state whose impacts pass within a step (impactsPass). Before Bullet's solver, while their rigid
	/// proxies are shown: the approaches at their contacts. After it: what breaks.
	void noteRigidApproaches( btDispatcher& dispatcher );
	void breakRigid( double h );

	/// Chooses the objects that take soft substeps in a game step of this length. Returns the number of substeps: the user's, or more if
	/// the stiffest awake material needs them; 1 if no body takes substeps.
	int planSubsteps( btScalar gameStep, const BulletStages::Parts& parts );
	SubstepGroup group;

	void wakeDriven(); ///< sleeping bodies whose pins move
	/// Keeps bodies awake that have lost their support: Bullet would let bodies that are about to sleep fall asleep in the air.
	void wakeUnsupported();
	void beginStep( btScalar gameStep, int substeps );
	/// The stages up to updateActivation then apply to the bodies that this pass moves.
	void beginPass( StepPass pass );
	StepPass pass() const { return m_pass; }
	/// Whether the stages of a step run, or functions that they call: contact callbacks, force fields. Then the world's arrays hold a part
	/// of its objects, and tasks may be running.
	bool areStagesRunning = false;
	/// The same, or outside of a step while force fields are called.
	bool isBusy() const { return areStagesRunning || fields.areActing(); }
	/// Call when the game changes data of a body's implicit equations. In the middle of a step the body moves freely for the rest of the
	/// pass, because the equations are the previous ones.
	void equationsChanged( SoftBody& body ) const;
	void endSubsteps()
	{
		group.endSubsteps( m_world );
		copyIslandTags();
	}
	/// Whether an awake body of the pass is in the island.
	bool isAwakeIn( int island ) const;
	bool isInPass( const btCollisionObject& object ) const { return group.moves( m_pass, object ); }
	/// Whether the pass searches contacts of two objects.
	bool isPairInPass( const btCollisionObject& a, const btCollisionObject& b ) const
	{
		return !group.isSplit() || ( group.contains( a ) || group.contains( b ) ) == ( m_pass == StepPass::Substeps );
	}

	// One pass, in the order of world_step.cpp.
	void accelerate( btScalar h, int substep ); ///< forces, velocities of pins, shape matching, swept boxes
	void wakeLate( SoftBody& body );
	/// Sleeping bodies that something awake touches take part in this pass's contacts. Returns whether there are any.
	bool wakeHit();
	void completeFirstContacts(); ///< of bodies that have just become rigid; after the broadphase's pairs
	void collideWithThemselves( btScalar h );
	void endCollision( btScalar h ); ///< when all contacts are found
	void holdPredictiveContacts( btAlignedObjectArray<btPersistentManifold*>& manifolds );
	void dropPredictiveContacts();
	void copyIslandTags();
	bool isEmpty() const { return m_bodies.empty(); }
	/// Neither a soft body nor a field is in the world, and nothing of them is left to do: Bullet's world steps alone, and the host passes
	/// its stages by.
	bool isPlain = false;
	/// Solves contacts of deformable bodies, and implicit bodies, before Bullet's solver; noteSolved() then reads that solver's results.
	/// `joints`: of the pass.
	void solveImplicit( const btAlignedObjectArray<btTypedConstraint*>& joints, btDispatcher& dispatcher, const btContactSolverInfo& info );
	void noteSolved() { implicitSolve().after(); }
	void carryImpulses() { implicitSolve().carryImpulses(); } ///< once they have been reported
	/// Solves the joints of frames and gives the frames the velocities of their patches, before Bullet's solver.
	void giveFrames( const btAlignedObjectArray<btTypedConstraint*>& joints, const btContactSolverInfo& info );
	/// Passes the joints' changes to the patches' nodes.
	void readFrames( const btAlignedObjectArray<btTypedConstraint*>& joints, btScalar h );
	void wakeTouched();          ///< wakes the bodies whose contact proxies Bullet has woken, and puts those of sleeping bodies to sleep
	void holdBack( btScalar h ); ///< keeps fast nodes from passing through static and kinematic objects
	void integrate( btScalar h, int substep );
	void updateActivation( btScalar h );
	void endStep();
	void clearForces();
	/// Notes that this body's skin is about to be read.
	void noteSkinRequest( const SoftBody& requested );

	/// Finds links that are stretched too far, after the nodes have moved. They break at the start of the next substep.
	void noteImpacts( double h ); ///< on brittle bodies, in the implicit step
	void testLinks( btScalar h );
	void turnFrames(); ///< of implicit bodies on levels, by the rotation of the substep
	/// Removes small pieces that have faded. Call between game steps.
	void removeFaded();
	int removedSinceStep = 0; ///< by the last call
	/// Gives up ownership of a fragment. Returns false if it is not owned by this world.
	bool release( SoftBody& fragment );
	std::vector<FractureEvent> events;
	Attachments attachments;
	ForceFields fields;
	ContactEvents contactEvents;
	DebugDrawing drawing;
	/// Adds `by`, m, to the coordinates of soft bodies and of data that refers to them.
	void shift( const btVector3& by );
	Frames frames;
	std::vector<SoftBody*> owned; ///< fragments that the game has not released
	DebrisBudget debris;

	void releasePinsTo( const btRigidBody& body );
	void releaseLostPins( SoftBody& body, bool isAdded );

	/// Sets the number of contacts of soft bodies in the pass's last substep.
	void countContacts( int count ) { report.softContacts = m_contactsBefore + count; }

	/// Times and counts of the game step; below it the settings.
	StepReport report;
	int substeps;
	int maxSubsteps;
	ContactProxyPool pool;
	PairScratch pairScratch;
	SkinScratchPool skinScratch;
	double drawnFraction = 1.0; ///< SoftBodyHost::interpolationFraction
	std::unique_ptr<TaskRunner> ownRunner;
	TaskRunner* runner = nullptr; ///< the game's, or null
	/// Returns the game's runner, or this world's own if the game has set none.
	TaskRunner* tasks() const;
	const btDiscreteDynamicsWorld& world() const { return m_world; }

private:
	friend class WorldSnapshot;
	bool moves( const SoftBody& body ) const;
	struct RestState
	{
		btCollisionObject* object;
		int activation;
		btScalar time; ///< btCollisionObject::getDeactivationTime
	};
	void moveHeldBodies();
	bool maySettle( const SoftBody& body ) const;
	/// Makes scenery of pieces that have slept for DebrisBudget::settleTime.
	void settleDebris( btScalar gameStep );
	/// The game has made a body dynamic again that was scenery.
	void leaveScenery( SoftBody& body );
	void keepDrawn(); ///< keeps the drawing from which SoftBody::setInterpolation blends
	void strainByImpact( const IslandBlock& block, int part, double h );
	/// Notes the peak of an impact that takes `energy`, J, from the motion of the bodies. `stopping`: its impulses on the nodes, N s;
	/// `storedElsewhere`: the energy of the others' response to it, J.
	void strainAtPeak( SoftBody& body, const AlignedArray<float>& stopping, double energy, double storedElsewhere, double h );
	/// The same for a body in its rigid state, whose links are tested at the peak.
	void strainRigid( SoftBody& body, const AlignedArray<float>& stopping, double energy, double h );
	/// A body that an impact has broken, or a piece of it, deforms no longer if its impacts pass within a step.
	void stiffen( SoftBody& body );
	void becomeRigid( SoftBody& body );
	/// Changes `response`, a first guess, to the velocities of an implicit body that has got impulses on its nodes, N s, without the rigid
	/// motions of its free parts; returns its energy, J, which is accurate to `fraction`.
	double respondTo( SoftBody& body, const AlignedArray<float>& impulse, AlignedArray<float>& response, double fraction );
	/// Solves an implicit body's velocities accurately for the impulses of its contacts on its nodes, N s. Rigid motions stay, and all
	/// velocities where their change has more energy than `most`, J.
	void refineSolution( SoftBody& body, const AlignedArray<float>& impulse, double most );
	BlockSolve& implicitSolve() { return m_implicit[int( m_pass )]; }
	/// Returns the number of substeps that the body takes in the game step.
	int substepsOf( const SoftBody& body ) const;
	/// Whether the body has nothing elastic and may step implicitly: it needs no substeps.
	bool isImplicitRigidPiece( const SoftBody& body ) const;
	bool isReachableAwake( const SoftBody& body, btScalar gameStep ) const;
	StiffnessPlan planOf( const SoftBody& body, btScalar gameStep, int count ) const;
	btVector3 gravityOf( const SoftBody& body ) const;  ///< its own or the world's, m/s^2
	Vec3 ownAcceleration( const SoftBody& body ) const; ///< gravity and the game's force, m/s^2
	bool isHeld( const SoftBody& body ) const;          ///< by an attachment or by joints
	double gravityShareOf( const SoftBody& body, double h ) const;
	/// Returns false if a number is not finite or a node is faster than kSpeedLimit.
	bool sweepBox( SoftBody& body, btScalar h ) const;
	void quarantine( SoftBody& body );
	void quarantineBroken();
	void gatherAwake();
	/// Calls work( body, runner for its own loops or null ) for each awake body.
	template <class F>
	void forAwake( F&& work );
	void drawSkins( long long vertices );
	bool breakBodies();
	struct Broken;
	void makeFragments( std::vector<Broken>& broken );
	void claimFrames( Broken& broken );
	void settlePieces( Broken& broken );
	void advanceFading( btScalar gameStep );
	void limitDebris( btScalar gameStep );
	int partsNow( int k, int count ) const;
	void ignoreAs( SoftBody& parent, SoftBody& fragment ) const; ///< setIgnoreCollisionCheck, by either object
	void stopIgnoring( SoftBody& fragment ) const;
	void addFragment( SoftBody& parent, std::unique_ptr<SoftBody> fragment );
	void adaptLevels( btScalar h );
	void requestContactSplits( SoftBody::Impl& impl ); ///< Adaptivity::refinesOnContact
	void changeLevels( SoftBody& body );
	void countNodes();
	/// Returns the static and kinematic objects within `reach` of a body's nodes that collide with it, by ascending broadphase id.
	std::vector<const btCollisionObject*> wallsAround( SoftBody& body, double reach );
	void keepNewNodesOut( SoftBody& body, const std::vector<Vec3>& positionBefore );
	SoftBody* bodyAfter( unsigned serial ) const;
	void removeLost();
	void noteSleepers();
	void wakeRestingOnWoken();
	void drawToPose( SoftBody& body, btScalar h ); ///< of an explicit body, after its forces
	void placeFrames();
	void pressFrames( bool isOn );
	void drivePins( SoftBody& body, btScalar h, int substep );
	static void drivePinsOn( btRigidBody& holder, SoftBody& body, btScalar h ); ///< a kinematic one
	void settlePins( SoftBody& body, btScalar h, int substep );
	double leastWaking( const SoftBody& body, double gameStep ) const;
	double leastLanding( const SoftBody& body, double gameStep, int usual ) const;
	double rollingOf( const SoftBody& body ) const;
	double rollingOn( SoftBody& body );
	void noteLandings( btScalar gameStep, int usual, bool canSplit );
	void countIslandBodies();
	bool isSmallImpact( const btCollisionObject& a, const btCollisionObject& b ) const;
	void noteImpact( SoftBody& body, btCollisionObject& other, btScalar gameStep, int usual );
	int listSubstepped( btScalar gameStep, int usual );
	int mostSubsteps( btScalar gameStep ) const;
	bool isGroupTooLarge( const SubstepGroup::Scene& scene, int count ) const;
	void leaveLargeGroups( const SubstepGroup::Scene& scene, btScalar gameStep, int count );
	bool canBeRigid( const SoftBody& body ) const;
	double loadOn( const SoftBody& body ) const; ///< sum of the contact forces on a deformable body, N
	/// Brakes bodies in their rigid state that touch something: their spin about the normal, and too fast a rotation.
	void brakeRigidProxies( btDispatcher& dispatcher );
	void forecastImpacts( btScalar h );
	bool mayTouch( SoftBody& body, btCollisionObject& other );
	void forecastImpact( SoftBody& body, btCollisionObject& other, const ForecastMotions& motions, btScalar h );
	void accelerateRigid( btScalar h );
	void integrateRigid( btScalar h );

	btDiscreteDynamicsWorld& m_world;
	btCollisionDispatcher& m_dispatcher;
	std::shared_ptr<AlgorithmTable> m_algorithms; ///< null while there is no soft body
	std::vector<SoftBody*> m_bodies;              ///< ascending by serial
	std::vector<ContactProxy*> m_predictive;
	BlockSolve m_implicit[2]; ///< by pass
	ManifoldFilter m_inBlocks;
	TunnelingGuard m_guard;
	ImplicitChoice m_choice;
	std::vector<SoftBody*> m_awake;              ///< in this substep, deformable
	std::vector<SoftBody*> m_rigid;              ///< in this substep, in their rigid state
	bool m_hasRigidProxies = false;              ///< in this substep
	std::vector<SoftBody*> m_asleep;             ///< when the last step ended
	std::vector<SoftBody*> m_parallel, m_serial; ///< awake bodies processed by all threads together; by one thread each
	std::vector<RestState> m_restStates;         ///< scratch of removeContacts
	std::vector<RigidApproach> m_approaches;     ///< in this substep
	std::vector<SoftBody*> m_stale;              ///< scratch of noteSkinRequest
	std::vector<std::uint32_t> m_contactNodes;   ///< scratch of requestContactSplits: nodes and their F
	std::vector<float> m_stretches;
	unsigned m_steps = 1, m_requestedIn = 0; ///< game steps so far, from 1; the step after which a skin was last requested (0: never)
	btScalar m_gameStep = btScalar( 0 );
	int m_substepCount = 1; ///< of the substep group
	StepPass m_pass = StepPass::Whole;
	int m_contactsBefore = 0;            ///< StepReport::softContacts of the previous pass
	std::vector<SoftBody*> m_substepped; ///< scratch of planSubsteps
	FastPairs m_fastPairs;
	btManifoldArray m_manifolds;     ///< scratch of rollingOn
	std::vector<int> m_islandBodies; ///< scratch of noteLandings: numbers of deformable bodies, by island tag + 1
	unsigned m_serials = 0;
	double m_clock = 0.0; ///< s of steps so far
	int m_piecesLeft = 0; ///< of DebrisBudget::piecesPerStep
};

} // namespace pliant
