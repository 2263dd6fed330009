#pragma once

// The soft bodies of a world: what a game calls, whichever of Bullet's worlds they sit in (soft_body_world_over.h).

#include "pliant/attachment.h"
#include "pliant/export.h"
#include "pliant/precision.h"
#include "pliant/soft_body.h"
#include "pliant/step_report.h"
#include "pliant/task_runner.h"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <memory>
#include <vector>

namespace pliant {

class WorldStep;

/// The stages of a step of the Bullet world that soft bodies sit in. SoftBodyWorldOver implements it; games need not know it.
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
		btAlignedObjectArray<btActionInterface*>& actions;
		btAlignedObjectArray<btPersistentManifold*>& predictiveManifolds;
		btCollisionObjectArray& objects;
		btDispatcher*& dispatcher;
		btSimulationIslandManager*& islandManager;
		btInternalTickCallback &preTick, &tick;
		bool hasIslandManagerMt; ///< islandManager is a btSimulationIslandManagerMt
		bool hasOwnSingleStep;   ///< the base replaces btDiscreteDynamicsWorld::internalSingleStepSimulation
		bool hasOwnIslands;      ///< the base replaces btDiscreteDynamicsWorld::calculateSimulationIslands
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

class PLIANT_API SoftBodyHost
{
public:
	/// Group and mask as for any Bullet object. The world does not own the body. Adding twice, or what is in another world, is ignored. To
	/// change group and mask remove the body and add it again: it goes on as it was, its pins too.
	void addSoftBody( SoftBody* body, int group = btBroadphaseProxy::DefaultFilter, int mask = btBroadphaseProxy::AllFilter );
	/// At any time, out of contact and tick callbacks too; the body may be deleted then. What it touched wakes. Ignored for a body of no or
	/// another world.
	void removeSoftBody( SoftBody* body );
	int softBodyCount() const;
	/// Null for an index that is not there.
	SoftBody* softBody( int index ) const;

	/// What broke in the last stepSimulation, in order. Pointers stay good until a body they name is deleted; the world itself deletes
	/// small pieces that have faded, at the start of a stepSimulation.
	const std::vector<FractureEvent>& fractureEvents() const;
	/// Fragments that belong to the world.
	int fragmentCount() const;
	/// Makes the fragment the game's to delete; it stays in the world. So does removing it from the world. Deleting a fragment that
	/// belongs to the world is legal too. False for what is no fragment of this world's.
	bool releaseFragment( SoftBody* fragment );

	/// Soft substeps per game step while a soft body is awake, 1 to 64, default 4. Stiff materials raise it by themselves up to
	/// maxSoftSubsteps (default 16).
	void setSoftSubsteps( int count );
	int softSubsteps() const;
	void setMaxSoftSubsteps( int count );
	int maxSoftSubsteps() const;

	/// Own pool of that many threads, default 1; or the game's runner (not owned; null goes back to the own pool).
	void setThreadCount( int count );
	void setTaskRunner( TaskRunner* runner );

	const StepReport& stepReport() const;

	/// Attaches a node of a soft body, where it is now, to a rigid body: both pull on each other, as by a ball joint. Static and kinematic
	/// bodies hold and carry it. The attachment follows changes of levels and stays with the piece that has the node when the body breaks;
	/// it goes when either body leaves the world. Returns its id. BadArgument for a node that is not there, for bodies that are not in this
	/// world, and for bad settings; also without PLIANT_WITH_IMPLICIT.
	Result<int> attach( SoftBody& body, int node, btRigidBody& to, const AttachmentSettings& settings = {} );
	/// The same for a world position, m, in or near the body: it moves with the nearest node and its neighbours. On bodies with levels it
	/// is the node's centre that is held.
	Result<int> attach( SoftBody& body, const btVector3& position, btRigidBody& to, const AttachmentSettings& settings = {} );
	/// Attaches two soft bodies at a world position, m, of both.
	Result<int> attach( SoftBody& body, SoftBody& to, const btVector3& position, const AttachmentSettings& settings = {} );
	/// Attaches each node of `body` within `distance`, m, of a node of `to` half-way between the two: faces that touch become one. Returns
	/// the number of attachments.
	Result<int> weld( SoftBody& body, SoftBody& to, btScalar distance, const AttachmentSettings& settings = {} );
	/// Removes an attachment; false for an id that is not there.
	bool detach( int id );
	int attachmentCount() const;
	/// The force of an attachment on its first body, N, the mean over the last step; zero for an id that is not there.
	btVector3 attachmentForce( int id ) const;
	/// The attachments that broke in the last stepSimulation, in order.
	const std::vector<AttachmentEvent>& attachmentEvents() const;

	/// The Bullet world that the soft bodies are in.
	btDiscreteDynamicsWorld& bulletWorld() const;

protected:
	SoftBodyHost();
	~SoftBodyHost();
	SoftBodyHost( const SoftBodyHost& ) = delete;
	SoftBodyHost& operator=( const SoftBodyHost& ) = delete;

	/// At the end of the world's constructor. Leave the last parameter alone: it makes a program that disagrees with the library about
	/// Bullet's precision fail to link (precision.h).
	void hostAttach( BulletStages& stages, const BulletStages::Parts& parts, BulletPrecision = {} );
	/// At the start of the world's destructor: soft bodies leave, fragments that nobody has taken over are deleted.
	void hostDetach();

	// What the world's overrides of Bullet's calls do; world/step/world_step.cpp is the order of a step.
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
	void hostAdd( btCollisionObject* object, int group, int mask );
	void hostRemove( btCollisionObject* object );
	/// False for what stands in a manifold for a soft body's node: it is in no world.
	static bool hostMayAdd( const btRigidBody* body );
	/// Before a rigid body or a joint leaves the world.
	void hostForget( btRigidBody& body );
	void hostForget( btTypedConstraint& joint );
	void hostDrawPins();
	/// False where the shape is no soft body's.
	bool hostDrawShape( const btCollisionShape* shape, const btVector3& colour );
	void hostSerialize( btSerializer& serializer );

private:
	std::unique_ptr<WorldStep> m_step;
};

} // namespace pliant
