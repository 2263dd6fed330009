#pragma once

// The soft bodies of a world: the calls of a game, for any of Bullet's worlds (soft_body_world_over.h).

#include "pliant/attachment.h"
#include "pliant/export.h"
#include "pliant/game/contact_events.h"
#include "pliant/game/debug_draw.h"
#include "pliant/game/forces.h"
#include "pliant/soft_body.h"
#include "pliant/step_report.h"
#include "pliant/task_runner.h"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <memory>
#include <vector>

class btMultiBody;
class btMultiBodyConstraint;
class btMultiBodyDynamicsWorld;

namespace pliant {

class WorldStep;

/// @cond INTERNAL
// Bullet's precision as a parameter type and so in a mangled name: a program compiled for double precision does not link with a library
// built for float, and vice versa. Most of Bullet's own symbols are equal in both, so such a program would link and then crash.
struct BuiltForFloatBullet
{};

struct BuiltForDoubleBullet
{};

#if defined( BT_USE_DOUBLE_PRECISION )
using BulletPrecision = BuiltForDoubleBullet;
#else
using BulletPrecision = BuiltForFloatBullet;
#endif

/// The stages of a step of the Bullet world that holds the soft bodies. SoftBodyWorldOver implements it; games need not know it.
class PLIANT_API BulletStages
{
public:
	virtual ~BulletStages() = default;

	/// Protected parts of Bullet's world.
	struct Parts
	{
		btDiscreteDynamicsWorld& world;
		btAlignedObjectArray<btRigidBody*>& rigidBodies; ///< that are not static
		btAlignedObjectArray<btTypedConstraint*>& constraints;
		btAlignedObjectArray<btMultiBody*>& multiBodies; ///< empty where the base has none
		btAlignedObjectArray<btMultiBodyConstraint*>& multiBodyJoints;
		btAlignedObjectArray<btActionInterface*>& actions;
		btAlignedObjectArray<btPersistentManifold*>& predictiveManifolds;
		btCollisionObjectArray& objects;
		btDispatcher*& dispatcher;
		btSimulationIslandManager*& islandManager;
		btInternalTickCallback &preTick, &tick;
		btScalar &localTime, &fixedStep; ///< s, that stepSimulation carries over to the next call
		bool hasIslandManagerMt;         ///< islandManager is a btSimulationIslandManagerMt
		bool hasOwnSingleStep;           ///< the base replaces btDiscreteDynamicsWorld::internalSingleStepSimulation
		bool hasOwnIslands;              ///< the base replaces Bullet's calculateSimulationIslands
	};

	// The stages as the game's class has them. h in s.
	virtual void predict( btScalar h ) = 0;
	virtual void findPredictiveContacts( btScalar h ) = 0;
	virtual void detect() = 0;
	virtual void findIslands() = 0;
	virtual void solve( btContactSolverInfo& info ) = 0;
	virtual void integrate( btScalar h ) = 0;
	virtual void updateActivation( btScalar h ) = 0;

	// The stages as Bullet's class has them.
	virtual void basePredict( btScalar h ) = 0;
	virtual void baseFindPredictiveContacts( btScalar h ) = 0;
	virtual void baseDetect() = 0;
	virtual void baseFindIslands() = 0;
	virtual void baseSolve( btContactSolverInfo& info ) = 0;
	virtual void baseIntegrate( btScalar h ) = 0;
	virtual void baseUpdateActivation( btScalar h ) = 0;
	virtual void baseSingleStep( btScalar h ) = 0;

	virtual void releasePredictiveContacts() = 0;
	virtual void updateActions( btScalar h ) = 0;
	/// Of any collision object: the base's own.
	virtual void baseAdd( btCollisionObject* object, int group, int mask ) = 0;
	virtual void baseRemove( btCollisionObject* object ) = 0;
	virtual void baseSerialize( btSerializer* serializer ) = 0;
};
/// @endcond

/// Calls of games on a world with soft bodies, beyond Bullet's own calls: SoftBodyWorld and SoftBodyWorldOver derive from it. Callable from
/// one thread at a time. Fragments of the world (FractureEvent) are deleted with it, other bodies are not. "Not during a step" means not
/// from contact callbacks and force fields (ForceField); actions and tick callbacks run between steps.
class PLIANT_API SoftBodyHost
{
public:
	/// Group and mask as for any Bullet object. The world does not own the body. A body that is already in this or another world, or null,
	/// is ignored. To change group and mask remove the body and add it again: it keeps its state, pins included.
	void addSoftBody( SoftBody* body, int group = btBroadphaseProxy::DefaultFilter, int mask = btBroadphaseProxy::AllFilter );
	/// At any time, also from contact and tick callbacks; the body may be deleted then. Objects that it touched wake. Ignored for a body of
	/// no or another world and for null.
	void removeSoftBody( SoftBody* body );
	/// Number of soft bodies in the world, fragments included.
	[[nodiscard]] int softBodyCount() const;
	/// The soft body of an index, 0 to softBodyCount() - 1, in the order in which they were added; null for an index out of range.
	[[nodiscard]] SoftBody* softBody( int index ) const;

	/// The breaks of the last stepSimulation, in order. Pointers stay valid until a body that they name is deleted; the world itself
	/// deletes small pieces that have faded, at the start of a stepSimulation.
	[[nodiscard]] const std::vector<FractureEvent>& fractureEvents() const;
	/// Number of fragments that belong to the world.
	[[nodiscard]] int fragmentCount() const;
	/// Transfers the fragment to the game, which has to delete it; it stays in the world. Removing it from the world has the same effect.
	/// Deleting a fragment that belongs to the world is allowed too. False for a body that is no fragment of this world.
	bool releaseFragment( SoftBody* fragment );
	/// Limits the number of pieces; pieces over the budget fade from the next step on. BadSettings for values out of range; BadArgument in
	/// a build without Feature::Fracture for anything but the default.
	Status setDebrisBudget( const DebrisBudget& budget );
	/// The budget last set.
	[[nodiscard]] DebrisBudget debrisBudget() const;

	/// Where between the last two steps bodies with SoftBody::setInterpolation are drawn: 0 at the one before, 1 at the last.
	/// stepSimulation sets it to the time left over, as a fraction of fixedTimeStep; to 1 with maxSubSteps 0, and where the world does not
	/// interpolate (setLatencyMotionStateInterpolation). Games that divide time themselves set it before they draw; it counts until the
	/// next stepSimulation. Clamped to 0 to 1; NaN counts as 1.
	void setInterpolationFraction( btScalar fraction );
	/// The fraction in force, 0 to 1; 1 before the first step.
	[[nodiscard]] btScalar interpolationFraction() const;

	/// Sets the soft substeps per step of 1/60 s while an explicit soft body is awake, clamped to 1 to 64, default 4. Stiff materials and
	/// longer steps raise their number by themselves up to maxSoftSubsteps.
	void setSoftSubsteps( int count );
	/// The number last set, 1 to 64.
	[[nodiscard]] int softSubsteps() const;
	/// Sets the largest number that they are raised to, clamped to 1 to 64, default 16. A number of 16 and more is for steps of up to
	/// 1/15 s; longer ones get proportionally more, up to 64. setSoftSubsteps may set more.
	void setMaxSoftSubsteps( int count );
	/// The number last set, 1 to 64.
	[[nodiscard]] int maxSoftSubsteps() const;

	/// Makes the world's own pool of that many threads, the calling one included; clamped to 1 to 64, default 1. Out of memory: the present
	/// pool stays. Not during a step: ignored then.
	void setThreadCount( int count );
	/// Sets a task runner of the game to be used instead of the own pool; null (the default): the own pool. Not owned: it must outlive its
	/// use. Not during a step: ignored then.
	void setTaskRunner( TaskRunner* runner );
	/// Number of tasks that can run at the same time, by the game's runner or by the own pool: at least 1.
	[[nodiscard]] int threadCount() const;

	/// Times and counts of the last step. Valid as long as the world; changes with each step.
	[[nodiscard]] const StepReport& stepReport() const;

	/// Attaches a node of a soft body, where it is now, to a rigid body or a multibody's link (btMultiBodyLinkCollider): both pull on
	/// each other, as by a ball joint. Static and kinematic bodies hold and carry it. The attachment follows changes of levels and stays
	/// with the piece that has the node when the body breaks; it goes when either body leaves the world. Returns its id. BadArgument for a
	/// node that is not there, and for bodies that are not in this world; BadSettings for `settings`.
	Result<int> attach( SoftBody& body, int node, btCollisionObject& to, const AttachmentSettings& settings = {} );
	/// The same for a world position, m, in or near the body: it moves with the nearest node and its neighbours. On bodies with levels it
	/// is the node's centre that is held. BadArgument also for a bad number, and where the position is further from the body than a hundred
	/// times its size.
	Result<int> attach( SoftBody& body, const btVector3& position, btCollisionObject& to, const AttachmentSettings& settings = {} );
	/// Attaches two soft bodies at a world position, m, of both. BadArgument also for one body twice.
	Result<int> attach( SoftBody& body, SoftBody& to, const btVector3& position, const AttachmentSettings& settings = {} );
	/// Attaches each node of `body` within `distance`, m, of a node of `to` midway between the two: faces that touch become one. Returns
	/// the number of attachments. Errors: as for attach; BadArgument also for a distance that is negative or a bad number.
	Result<int> weld( SoftBody& body, SoftBody& to, btScalar distance, const AttachmentSettings& settings = {} );
	/// Removes an attachment; false for an id that is not there.
	bool detach( int id );
	/// Number of attachments in the world.
	[[nodiscard]] int attachmentCount() const;
	/// The force of an attachment on its first body, N, the mean over the last step; zero for an id that is not there.
	[[nodiscard]] btVector3 attachmentForce( int id ) const;
	/// The attachments that broke in the last stepSimulation, in order.
	[[nodiscard]] const std::vector<AttachmentEvent>& attachmentEvents() const;

	/// The contacts of bodies with SoftBody::setContactEvents in the last stepSimulation, one for each pair.
	[[nodiscard]] const std::vector<ContactEvent>& contactEvents() const;

	/// Adds a force field; wakes the bodies that it acts on. Not owned. BadArgument for a field that is in a world already.
	Status addForceField( ForceField& field );
	/// Removes it; wakes the bodies that it acted on. False for a field that is not in this world.
	bool removeForceField( ForceField& field );
	/// Number of force fields in the world.
	[[nodiscard]] int forceFieldCount() const;
	/// Pushes soft and rigid bodies away from a point, in proportion to the area that faces it; rigid bodies are not rotated. Wakes the
	/// bodies that it pushes. Returns their number. BadSettings for a setting out of range; BadArgument if a node or a rigid body would
	/// become faster than 1e5 m/s, and during a step.
	Result<int> explode( const Explosion& explosion );

	/// Moves the world's origin: `by`, m, is added to the coordinates of everything in the world; nothing wakes, and motion continues
	/// unchanged. Moved with it: soft and rigid bodies, ghosts, multibodies, motion states, contacts, pins, and joints with one body, whose
	/// frame is in the world. Exact for soft bodies by multiples of 1/16 m. Not moved: data of the game, including actions and force
	/// fields. BadArgument for a bad number, if an object would be farther than 1e9 m from the origin, in a world with Bullet's own soft
	/// bodies, and during a step.
	Status shiftOrigin( const btVector3& by );

	/// Parts of soft bodies that debugDrawWorld draws. Bad numbers count as the default ones.
	void setDebugDrawing( const DebugDrawing& what );
	/// The setting.
	[[nodiscard]] const DebugDrawing& debugDrawing() const;

	/// Makes a frame: a rigid body, without collisions, that moves with the nodes of a soft body within `radius`, m, of a world position,
	/// and through which Bullet's joints, motors, forces and torques act on them. It adds no mass to the patch: its own mass represents the
	/// patch's resistance. The library chooses its origin and axes: joints refer to its getWorldTransform. The world owns it until
	/// removeFrame. It follows changes of levels and the piece that has most of the patch; when the soft body leaves the world, or has too
	/// few nodes left, it becomes an ordinary rigid body of the patch's mass. Velocities and transforms that the game sets on it, and
	/// impulses, are ignored. BadArgument for a body that is not in this world, a bad number, and if the nodes within the radius are fewer
	/// than three or collinear.
	Result<btRigidBody*> addFrame( SoftBody& body, const btVector3& position, btScalar radius );
	/// Removes a frame and all joints at it from the world and deletes the frame, but not the joints; false for a body that is no frame of
	/// this world, and during a step.
	bool removeFrame( const btRigidBody* frame );
	/// The soft body that a frame moves with; null if it has left, and for a body that is no frame.
	[[nodiscard]] SoftBody* frameOwner( const btRigidBody* frame ) const;

	/// The Bullet world that the soft bodies are in.
	[[nodiscard]] btDiscreteDynamicsWorld& bulletWorld() const;

	/// @cond INTERNAL
	/// For Pliant's own sources only.
	WorldStep& step() const { return *m_step; }

protected:
	SoftBodyHost();
	~SoftBodyHost();
	SoftBodyHost( const SoftBodyHost& ) = delete;
	SoftBodyHost& operator=( const SoftBodyHost& ) = delete;

	/// At the end of the world's constructor. Leave the last parameter alone: it makes a program that disagrees with the library about
	/// Bullet's precision fail to link (BulletPrecision).
	void hostAttach( BulletStages& stages, const BulletStages::Parts& parts, BulletPrecision = {} );
	/// At the start of the world's destructor: soft bodies leave, fragments that the game has not taken are deleted.
	void hostDetach();

	/// True while the world has no soft body and no force field: the overrides call Bullet's stages only.
	bool isPlain() const { return *m_isPlain; }
	// Implementation of the world's overrides of Bullet's calls; world/step/world_step.cpp is the order of a step.
	void singleStep( btScalar timeStep );
	void predictStage( btScalar h );
	void predictiveContactsStage( btScalar h );
	void detectStage();
	void islandsStage();
	void solveStage( btContactSolverInfo& info );
	void integrateStage( btScalar h );
	void activationStage( btScalar h );
	/// False where the step cannot be made; cuts a time of more steps than can be counted.
	bool beginTick( btScalar& timeStep, int maxSubSteps, btScalar fixedTimeStep );
	void endTick();
	/// When Bullet updates motion states: times in s, 0 for a step of the whole time.
	void hostNoteTime( btScalar left, btScalar fixedTimeStep ) { setInterpolationFraction( fixedTimeStep > 0 ? left / fixedTimeStep : 1 ); }
	void hostAdd( btCollisionObject* object, int group, int mask );
	void hostRemove( btCollisionObject* object );
	/// False for the contact proxy of a soft body's node in a manifold: it is in no world.
	static bool hostMayAdd( const btRigidBody* body );
	/// Before a rigid body, a multibody or a joint leaves the world.
	void hostForget( btRigidBody& body );
	void hostForget( btTypedConstraint& joint );
	void hostForget( btMultiBody& body );
	void hostForget( btMultiBodyConstraint& joint );
	void hostDrawPins();
	/// False where the shape is no soft body's.
	bool hostDrawShape( const btCollisionShape* shape, const btVector3& colour );
	void hostSerialize( btSerializer& serializer );
	/// @endcond

private:
	std::unique_ptr<WorldStep> m_step;
	const bool* m_isPlain = nullptr;
};

} // namespace pliant
