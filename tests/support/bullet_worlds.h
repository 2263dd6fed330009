#pragma once

// Bullet's worlds that soft bodies may sit in, each with the parts that it is made from.

#include <pliant/soft_body_world_over.h>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolverMt.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <btBulletDynamicsCommon.h>

#include <memory>

namespace pliant::test {

/// A game's own subclass: counts what Bullet calls.
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

/// What `Base` is made from. `make<World>()`: the base itself, or a world over it.
template <class Base>
struct PartsOf
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	template <class World>
	std::unique_ptr<World> make()
	{
		return std::make_unique<World>( &dispatcher, &broadphase, &solver, &configuration );
	}
};

template <>
struct PartsOf<btDiscreteDynamicsWorldMt>
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btConstraintSolverPoolMt solver{ 2 };
	template <class World>
	std::unique_ptr<World> make()
	{
		btConstraintSolver* const ofLargeIslands = nullptr;
		return std::make_unique<World>( &dispatcher, &broadphase, &solver, ofLargeIslands, &configuration );
	}
};

template <>
struct PartsOf<btMultiBodyDynamicsWorld>
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btMultiBodyConstraintSolver solver;
	template <class World>
	std::unique_ptr<World> make()
	{
		return std::make_unique<World>( &dispatcher, &broadphase, &solver, &configuration );
	}
};

template <>
struct PartsOf<btSoftRigidDynamicsWorld>
{
	btSoftBodyRigidBodyCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	template <class World>
	std::unique_ptr<World> make()
	{
		return std::make_unique<World>( &dispatcher, &broadphase, &solver, &configuration );
	}
};

} // namespace pliant::test
