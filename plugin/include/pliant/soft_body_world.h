#pragma once

// The world class to swap in for btDiscreteDynamicsWorld. Without a soft body in it, it is that world, bit for bit.

#include "pliant/export.h"
#include "pliant/precision.h"
#include "pliant/soft_body.h"
#include "pliant/task_runner.h"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <memory>
#include <vector>

namespace pliant {

/// Where one game step's time went, s, and what it met. All zero for a world without soft bodies.
struct StepReport
{
	double forces = 0, matching = 0, spheres = 0, collision = 0, solve = 0, integrate = 0, skinning = 0, levels = 0, fracture = 0,
		   total = 0;   ///< s; the implicit solution is matching's
	int substeps = 0;   ///< soft substeps made in the last game step
	int softBodies = 0; ///< in the world
	int awakeSoftBodies = 0;
	int nodes = 0;                ///< in all soft bodies
	int softContacts = 0;         ///< contact points between nodes and anything, last substep
	int implicitBodies = 0;       ///< awake bodies that took the implicit step
	int implicitPasses = 0;       ///< of the implicit solution that took most, last substep (docs/design/implicit.md)
	int implicitProducts = 0;     ///< the same: products with its matrix
	int selfContacts = 0;         ///< those of them between two nodes of one body (SoftBody::setSelfCollision)
	int heldNodes = 0;            ///< fast nodes that were kept from passing through what stands (docs/design/contacts.md), all substeps
	int levelChanges = 0;         ///< changes of bodies' levels of detail: each may split and merge many nodes
	int splits = 0;               ///< nodes that gave way to their parts
	int merges = 0;               ///< nodes that took the place of their parts
	int nodesOnLevel[5] = {};     ///< of all soft bodies, finest first; bodies without levels have finest nodes only
	int brokenLinks = 0;          ///< between finest cells
	int fragments = 0;            ///< bodies that came off others
	int removedPieces = 0;        ///< small pieces that were not made, or have faded (SmallPieces)
	int quarantined = 0;          ///< bodies that stand still because a number in them stopped being finite
	int unreachableStiffness = 0; ///< bodies whose Young's modulus was out of reach: raise maxSoftSubsteps or regionHalfWidth
};

/// A body that broke. Its heaviest part keeps the object; the others are new bodies in the world, with its template, material, filter,
/// surface, user pointer and indices. They belong to the world, which deletes them when it is destroyed; see releaseFragment.
struct FractureEvent
{
	SoftBody* parent = nullptr;
	std::vector<SoftBody*> fragments; ///< heaviest first; empty where the body cracked and holds together
	int links = 0;                    ///< broken, between finest cells
	double area = 0;                  ///< of the crack, one side, m^2
	double energy = 0;                ///< J, that the broken links held
	int removedPieces = 0;            ///< SmallPieces::Remove
	double removedMass = 0;           ///< kg
};

class PLIANT_API SoftBodyWorld : public btDiscreteDynamicsWorld
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// As btDiscreteDynamicsWorld; works with any dispatcher, broadphase, solver and configuration. Leave the last parameter alone:
	/// it makes a program that disagrees with the library about Bullet's precision fail to link (precision.h).
	SoftBodyWorld( btDispatcher* dispatcher, btBroadphaseInterface* broadphase, btConstraintSolver* solver,
		btCollisionConfiguration* configuration, BulletPrecision = {} );
	~SoftBodyWorld() override;

	/// Group and mask as for any Bullet object. The world does not own the body. Adding twice, or what is in another world, is ignored. To
	/// change group and mask remove the body and add it again: it goes on as it was, its pins too.
	void addSoftBody( SoftBody* body, int group = btBroadphaseProxy::DefaultFilter, int mask = btBroadphaseProxy::AllFilter );
	/// At any time, out of contact and tick callbacks too; the body may be deleted then. What it touched wakes. Ignored for a body of no or
	/// another world.
	void removeSoftBody( SoftBody* body );
	int softBodyCount() const;
	/// Null for an index that is not there.
	SoftBody* softBody( int index );

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

	/// As Bullet's. While a soft body is in the world a time step that is negative with maxSubSteps 0, NaN or infinite, and a fixedTimeStep
	/// that is no positive number, do nothing and return 0; a single step (timeStep with maxSubSteps 0, else fixedTimeStep) is cut to 1 s.
	int stepSimulation( btScalar timeStep, int maxSubSteps = 1, btScalar fixedTimeStep = btScalar( 1. ) / btScalar( 60. ) ) override;
	/// A soft body comes in as by addSoftBody; Bullet's default filter, which is for static objects, is a dynamic body's then. What stands
	/// in a manifold for a soft body's node is never added itself.
	void addCollisionObject( btCollisionObject* object, int group = btBroadphaseProxy::StaticFilter,
		int mask = btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter ) override;
	void addRigidBody( btRigidBody* body ) override;
	void addRigidBody( btRigidBody* body, int group, int mask ) override;
	/// A soft body leaves as by removeSoftBody, also where it is named by what stands for one of its nodes in a manifold.
	void removeCollisionObject( btCollisionObject* object ) override;
	void removeRigidBody( btRigidBody* body ) override;
	void removeConstraint( btTypedConstraint* constraint ) override;
	void clearForces() override;
	/// Soft bodies are drawn as the links of their surface (DBG_DrawWireframe) and crosses at pinned nodes (DBG_DrawConstraints).
	void debugDrawWorld() override;
	void debugDrawObject( const btTransform& transform, const btCollisionShape* shape, const btVector3& colour ) override;
	/// Writes what Bullet's world writes, without soft bodies, their shapes and their contacts: a file with all else in it, as if they were
	/// not there.
	void serialize( btSerializer* serializer ) override;
	void solveConstraints( btContactSolverInfo& info ) override;

protected:
	void internalSingleStepSimulation( btScalar timeStep ) override;
	void predictUnconstraintMotion( btScalar timeStep ) override;
	void createPredictiveContacts( btScalar timeStep ) override;
	void performDiscreteCollisionDetection() override;
	void calculateSimulationIslands() override;
	void integrateTransforms( btScalar timeStep ) override;
	void updateActivationState( btScalar timeStep ) override;

private:
	struct System;
	std::unique_ptr<System> m_system;
};

} // namespace pliant
