#include "world/soft_body_world_impl.h"

#include "world/constants.h"
#include "world/debug_draw.h"
#include "world/island_manager.h"
#include "world/soft_body_impl.h"

#include <algorithm>
#include <new>

namespace pliant {

SoftBodyWorld::SoftBodyWorld(
	btDispatcher* dispatcher, btBroadphaseInterface* broadphase, btConstraintSolver* solver, btCollisionConfiguration* configuration,
	BulletPrecision ) :
	btDiscreteDynamicsWorld( dispatcher, broadphase, solver, configuration ),
	m_system( std::make_unique<System>( *this, dispatcher, configuration ) )
{
	// As btDiscreteDynamicsWorldMt does it: the base made a manager and owns it; ours takes its place and is owned in turn.
	m_islandManager->~btSimulationIslandManager();
	btAlignedFree( m_islandManager );
	void* const room = btAlignedAlloc( sizeof( IslandManager ), 16 );
	m_islandManager = new ( room ) IslandManager( m_system->bodies );
}

SoftBodyWorld::~SoftBodyWorld()
{
	// Fragments that nobody has taken over go. What the game added stays the game's: the bodies leave, and take their contacts along while the pool still stands.
	for ( SoftBody* fragment : std::vector<SoftBody*>( m_system->bodies.owned ) )
	{
		delete fragment;
	}
	while ( !m_system->bodies.bodies().empty() )
	{
		removeSoftBody( m_system->bodies.bodies().back() );
	}
	releasePredictiveContacts();
	m_system->bodies.dropPredictiveContacts();
	m_system->bodies.restoreCreateFuncs();
}

void SoftBodyWorld::addSoftBody( SoftBody* body, int group, int mask )
{
	if ( body && m_system->bodies.add( *body ) )
	{
		addCollisionObject( body, group, mask );
	}
}

void SoftBodyWorld::removeSoftBody( SoftBody* body )
{
	if ( body )
	{
		removeCollisionObject( body );
	}
}

void SoftBodyWorld::removeCollisionObject( btCollisionObject* object )
{
	SoftBody* const soft = asSoftBody( object );
	if ( !soft )
	{
		if ( btRigidBody* rigid = btRigidBody::upcast( object ) )
		{
			m_system->bodies.releasePinsTo( *rigid );
		}
		m_system->forget( *object, getNumCollisionObjects() );
		btDiscreteDynamicsWorld::removeCollisionObject( object );
		return;
	}
	if ( soft->impl().system != &m_system->bodies )
	{
		return;
	}
	// Predictive contacts may still name its nodes; then the pair cache lets the algorithms go, and with them manifolds and stand-ins.
	releasePredictiveContacts();
	m_system->bodies.dropPredictiveContacts();
	m_system->forget( *object, getNumCollisionObjects() );
	btCollisionWorld::removeCollisionObject( object );
	m_system->bodies.remove( *soft );
	soft->impl().system = nullptr;
}

void SoftBodyWorld::removeRigidBody( btRigidBody* body )
{
	m_system->bodies.releasePinsTo( *body );
	m_system->forget( *body, getNumCollisionObjects() );
	btDiscreteDynamicsWorld::removeRigidBody( body );
}

void SoftBodyWorld::removeConstraint( btTypedConstraint* constraint )
{
	m_system->joints.forget( constraint );
	m_system->impulses.forget( constraint );
	btDiscreteDynamicsWorld::removeConstraint( constraint );
}

int SoftBodyWorld::softBodyCount() const
{
	return int( m_system->bodies.bodies().size() );
}

SoftBody* SoftBodyWorld::softBody( int index )
{
	return m_system->bodies.bodies()[index];
}

void SoftBodyWorld::setSoftSubsteps( int count )
{
	m_system->bodies.substeps = std::clamp( count, 1, kLargestSubsteps );
}

int SoftBodyWorld::softSubsteps() const
{
	return m_system->bodies.substeps;
}

void SoftBodyWorld::setMaxSoftSubsteps( int count )
{
	m_system->bodies.maxSubsteps = std::clamp( count, 1, kLargestSubsteps );
}

int SoftBodyWorld::maxSoftSubsteps() const
{
	return m_system->bodies.maxSubsteps;
}

void SoftBodyWorld::setThreadCount( int count )
{
	if ( std::unique_ptr<TaskRunner> made = createThreadPool( count ) )
	{
		m_system->bodies.ownRunner = std::move( made );
	}
}

void SoftBodyWorld::setTaskRunner( TaskRunner* runner )
{
	m_system->bodies.runner = runner;
}

const StepReport& SoftBodyWorld::stepReport() const
{
	return m_system->bodies.report;
}

const std::vector<FractureEvent>& SoftBodyWorld::fractureEvents() const
{
	return m_system->bodies.events;
}

int SoftBodyWorld::fragmentCount() const
{
	return int( m_system->bodies.owned.size() );
}

bool SoftBodyWorld::releaseFragment( SoftBody* fragment )
{
	return fragment && m_system->bodies.release( *fragment );
}

int SoftBodyWorld::stepSimulation( btScalar timeStep, int maxSubSteps, btScalar fixedTimeStep )
{
	m_system->isTickOver = false;
	m_system->bodies.events.clear();
	m_system->bodies.removeFaded();
	return btDiscreteDynamicsWorld::stepSimulation( timeStep, maxSubSteps, fixedTimeStep );
}

void SoftBodyWorld::debugDrawWorld()
{
	btDiscreteDynamicsWorld::debugDrawWorld();
	if ( getDebugDrawer() )
	{
		drawSoftBodies( m_system->bodies, *getDebugDrawer() );
	}
}

} // namespace pliant
