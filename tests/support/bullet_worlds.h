#pragma once

// Bullet's worlds that can hold soft bodies, each with its components.

#include <pliant/soft_body_world_over.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolverMt.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <LinearMath/btThreads.h>

#include <btBulletDynamicsCommon.h>

#include <memory>

namespace pliant::test {

/// A game's own subclass: counts the calls of its virtual functions.
class CountingWorld : public btDiscreteDynamicsWorld
{
public:
	using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
	int integrations = 0;

protected:
	void integrateTransforms( btScalar timeStep ) override
	{
		++integrations;
		btDiscreteDynamicsWorld::integrateTransforms( timeStep );
	}
};

/// Bullet's parts; `make<World>()`: a world made from them.
template <class Configuration, class Solver>
struct PartsWith
{
	Configuration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	Solver solver;
	template <class World>
	std::unique_ptr<World> make()
	{
		return std::make_unique<World>( &dispatcher, &broadphase, &solver, &configuration );
	}
};

/// A pool of two solvers. A Bullet that is built for threads needs a task scheduler before any of its parts for threads.
struct SolverPool : btConstraintSolverPoolMt
{
	SolverPool() : btConstraintSolverPoolMt( 2 )
	{
		if ( !btGetTaskScheduler() )
		{
			btSetTaskScheduler( btGetSequentialTaskScheduler() );
		}
	}
};

/// The components from which `Base` is constructed.
template <class Base>
struct PartsOf : PartsWith<btDefaultCollisionConfiguration, btSequentialImpulseConstraintSolver>
{};

template <>
struct PartsOf<btMultiBodyDynamicsWorld> : PartsWith<btDefaultCollisionConfiguration, btMultiBodyConstraintSolver>
{};

template <>
struct PartsOf<btSoftRigidDynamicsWorld> : PartsWith<btSoftBodyRigidBodyCollisionConfiguration, btSequentialImpulseConstraintSolver>
{};

template <>
struct PartsOf<btDiscreteDynamicsWorldMt> : PartsWith<btDefaultCollisionConfiguration, SolverPool>
{
	template <class World>
	std::unique_ptr<World> make()
	{
		btConstraintSolver* const ofLargeIslands = nullptr;
		return std::make_unique<World>( &dispatcher, &broadphase, &solver, ofLargeIslands, &configuration );
	}
};

} // namespace pliant::test
