#include "pliant/soft_body_world.h"

#include "world/bounce.h"
#include "world/constants.h"
#include "world/debug_draw.h"
#include "world/island_manager.h"
#include "world/moved_contacts.h"
#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"
#include "world/stopwatch.h"
#include "world/turning_friction.h"

#include <LinearMath/btQuickprof.h>

#include <algorithm>
#include <new>

namespace pliant {

struct SoftBodyWorld::System
{
	System( SoftBodyWorld& world, btDispatcher* dispatcher, btCollisionConfiguration* configuration ) : bodies( world, dispatcher, configuration ) {}

	SoftBodySystem bodies;
	TurningFriction turning;
	Bounces bounces;
	MovedContacts moved;
	int substep = 0;
	bool isStepping = false; ///< inside a substep of ours: the overrides do their part

	/// Something asks Bullet between substeps where soft bodies are. Actions may ask anything (a vehicle's wheels cast rays), and Bullet's continuous
	/// detection sweeps bodies against all that is there.
	static bool isAsked( const SoftBodyWorld& world )
	{
		bool isSwept = false;
		for ( int i = 0; world.getDispatchInfo().m_useContinuous && !isSwept && i < world.m_nonStaticRigidBodies.size(); ++i )
		{
			isSwept = world.m_nonStaticRigidBodies[i]->getCcdSquareMotionThreshold() != 0;
		}
		return isSwept || world.m_actions.size() > 0;
	}
};

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
	btCollisionWorld::removeCollisionObject( object );
	m_system->bodies.remove( *soft );
	soft->impl().system = nullptr;
}

void SoftBodyWorld::removeRigidBody( btRigidBody* body )
{
	m_system->bodies.releasePinsTo( *body );
	btDiscreteDynamicsWorld::removeRigidBody( body );
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
	m_system->bodies.events.clear();
	m_system->bodies.removeFaded();
	return btDiscreteDynamicsWorld::stepSimulation( timeStep, maxSubSteps, fixedTimeStep );
}

void SoftBodyWorld::internalSingleStepSimulation( btScalar timeStep )
{
	SoftBodySystem& bodies = m_system->bodies;
	bodies.wakeDriven();
	if ( bodies.bodies().empty() || !bodies.hasAwakeBody() )
	{
		bodies.report = StepReport{};
		bodies.report.removedPieces = bodies.removedSinceStep;
		if ( !bodies.bodies().empty() )
		{
			bodies.beginStep( timeStep, 1 );
		}
		btDiscreteDynamicsWorld::internalSingleStepSimulation( timeStep );
		return;
	}

	const int substeps = bodies.planSubsteps( timeStep );
	bodies.beginStep( timeStep, substeps );
	Stopwatch watch( bodies.report.total );

	// The game's callbacks are for the game's step: once before the first substep, once after the last.
	const btInternalTickCallback before = m_internalPreTickCallback, after = m_internalTickCallback;
	if ( before )
	{
		before( this, timeStep );
	}
	m_internalPreTickCallback = nullptr;
	m_internalTickCallback = nullptr;
	m_system->isStepping = true;
	for ( m_system->substep = 0; m_system->substep < substeps; ++m_system->substep )
	{
		btDiscreteDynamicsWorld::internalSingleStepSimulation( timeStep / btScalar( substeps ) );
	}
	m_system->isStepping = false;
	m_internalPreTickCallback = before;
	m_internalTickCallback = after;
	bodies.endStep();
	if ( after )
	{
		after( this, timeStep );
	}
}

void SoftBodyWorld::predictUnconstraintMotion( btScalar timeStep )
{
	m_system->bodies.pool.nextPhase( !m_system->isStepping || m_system->substep == 0 );
	if ( m_system->isStepping )
	{
		m_system->bodies.accelerate( timeStep, m_system->substep );
	}
	btDiscreteDynamicsWorld::predictUnconstraintMotion( timeStep );
}

void SoftBodyWorld::createPredictiveContacts( btScalar timeStep )
{
	if ( m_system->bodies.bodies().empty() )
	{
		btDiscreteDynamicsWorld::createPredictiveContacts( timeStep );
		return;
	}
	releasePredictiveContacts(); // before the stand-ins they name
	m_system->bodies.dropPredictiveContacts();
	btDiscreteDynamicsWorld::createPredictiveContacts( timeStep );
	m_system->bodies.holdPredictiveContacts( m_predictiveManifolds );
}

void SoftBodyWorld::performDiscreteCollisionDetection()
{
	if ( !m_system->isStepping )
	{
		btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
		return;
	}
	Stopwatch watch( m_system->bodies.report.collision );
	btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
	m_system->bodies.collideWithThemselves( getDispatchInfo().m_timeStep );
	m_system->bodies.endCollision( getDispatchInfo().m_timeStep );
}

void SoftBodyWorld::solveConstraints( btContactSolverInfo& info )
{
	if ( m_system->bodies.bodies().empty() )
	{
		btDiscreteDynamicsWorld::solveConstraints( info );
		return;
	}
	// Sleeping bodies too: a rigid body may have hit one of them and woken it in this very step.
	Stopwatch watch( m_system->bodies.report.solve );
	MovedContacts& moved = m_system->moved;
	moved.moveToNodes( *getDispatcher(), info );
	m_system->bodies.report.softContacts = moved.count();
	if ( moved.hasTurning() )
	{
		m_system->turning.hide( *getDispatcher() );
	}
	if ( m_system->isStepping )
	{
		m_system->bodies.solveImplicit( info );
		m_system->bodies.rubbing.aim( *getDispatcher() );
	}
	if ( moved.hasBounces() && m_system->isStepping )
	{
		m_system->bounces.aim( *getDispatcher(), info );
	}
	btDiscreteDynamicsWorld::solveConstraints( info );
	if ( moved.hasBounces() && m_system->isStepping )
	{
		m_system->bounces.settle();
	}
	if ( m_system->isStepping )
	{
		m_system->bodies.rubbing.sum( *getDispatcher() );
		m_system->bodies.noteSolved();
	}
	moved.moveBack();
	m_system->bodies.readBack();
	if ( moved.hasTurning() )
	{
		m_system->turning.apply();
	}
}

void SoftBodyWorld::integrateTransforms( btScalar timeStep )
{
	btDiscreteDynamicsWorld::integrateTransforms( timeStep );
	if ( m_system->isStepping )
	{
		Stopwatch watch( m_system->bodies.report.integrate );
		m_system->bodies.holdBack( timeStep );
		m_system->bodies.integrate( timeStep, m_system->substep );
		m_system->bodies.rubbing.give();
	}
	if ( m_system->isStepping && System::isAsked( *this ) )
	{
		m_system->bodies.freshenShapes();
	}
	if ( m_system->isStepping )
	{
		m_system->bodies.testLinks( timeStep );
	}
}

void SoftBodyWorld::updateActivationState( btScalar timeStep )
{
	btDiscreteDynamicsWorld::updateActivationState( timeStep );
	if ( m_system->isStepping )
	{
		m_system->bodies.updateActivation( timeStep );
	}
}

void SoftBodyWorld::clearForces()
{
	btDiscreteDynamicsWorld::clearForces();
	m_system->bodies.clearForces();
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
