// The order of a step. A game step is at most two passes over the same stages: one by the whole step for all that no explicit soft body
// touches, and then as many substeps as explicit soft bodies need for those and what touches them (substep_group.h). Actions and tick
// callbacks run once, as in Bullet's world.

#include "world/step/soft_body_world_impl.h"

#include "world/bodies/soft_body_impl.h"
#include "world/stopwatch.h"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <LinearMath/btQuickprof.h>

namespace pliant {

bool SoftBodyWorld::System::isAsked( const SoftBodyWorld& world )
{
	bool isSwept = false;
	for ( int i = 0; world.getDispatchInfo().m_useContinuous && !isSwept && i < world.m_nonStaticRigidBodies.size(); ++i )
	{
		isSwept = world.m_nonStaticRigidBodies[i]->getCcdSquareMotionThreshold() != 0;
	}
	return isSwept || world.m_actions.size() > 0;
}

// The stages of a step of length h for the bodies of the pass, as in Bullet's internalSingleStepSimulation.
void SoftBodyWorld::System::stepPass( SoftBodyWorld& world, btScalar h )
{
	world.predictUnconstraintMotion( h ); // forces, pins, matching; levels and fracture change nodes here alone
	btDispatcherInfo& info = world.getDispatchInfo();
	info.m_timeStep = h;
	info.m_stepCount = 0;
	info.m_debugDraw = world.getDebugDrawer();
	world.createPredictiveContacts( h );       // of fast rigid bodies
	world.performDiscreteCollisionDetection(); // broadphase, narrow phase, bodies with themselves
	bodies.releaseRefusedPairs();              // before anybody lists manifolds
	btDispatcher* const dispatcher = world.m_dispatcher1;
	showPass( world ); // islands and solver see the manifolds of the pass
	world.calculateSimulationIslands();
	carryImpulses( world, h );
	world.getSolverInfo().m_timeStep = h;
	world.solveConstraints( world.getSolverInfo() ); // implicit blocks, Bullet's solver, velocities back to the nodes
	if ( bodies.pass() == StepPass::Substeps )
	{
		impulses.add( *world.m_dispatcher1 );
	}
	world.m_dispatcher1 = dispatcher;
	lent.giveBack();
	world.integrateTransforms( h ); // positions; which links break
}

// One game step, in this order.
void SoftBodyWorld::internalSingleStepSimulation( btScalar timeStep )
{
	SoftBodySystem& bodies = m_system->bodies;
	if ( m_system->isTickOver )
	{
		m_system->isTickOver = false;
		bodies.events.clear();
		bodies.removeFaded();
	}
	if ( !bodies.openStep( timeStep ) )
	{
		return;
	}
	if ( bodies.isEmpty() )
	{
		bodies.report = StepReport{};
		bodies.report.removedPieces = bodies.removedSinceStep;
		btDiscreteDynamicsWorld::internalSingleStepSimulation( timeStep );
		return;
	}
	BT_PROFILE( "internalSingleStepSimulation" );
	if ( m_internalPreTickCallback )
	{
		m_internalPreTickCallback( this, timeStep );
	}
	m_system->impulses.giveBack( *m_dispatcher1 );
	bodies.wakeDriven();
	m_system->isStepping = bodies.hasAwakeBody();
	const int substeps = bodies.planSubsteps( timeStep, m_nonStaticRigidBodies, m_constraints );
	bodies.beginStep( timeStep, substeps );
	{
		Stopwatch watch( bodies.report.total );
		m_system->stepGroups( *this, timeStep, substeps );
	}
	if ( m_internalTickCallback )
	{
		m_internalTickCallback( this, timeStep );
	}
}

void SoftBodyWorld::System::stepGroups( SoftBodyWorld& world, btScalar timeStep, int substeps )
{
	const bool hasWhole = bodies.group.isEmpty() || bodies.group.isSplit();
	substep = 0;
	isNewStep = true;
	gameStep = timeStep;
	if ( hasWhole )
	{
		beginPass( world, StepPass::Whole );
		stepPass( world, timeStep );
		endPass( world );
	}
	if ( !bodies.group.isEmpty() )
	{
		beginPass( world, StepPass::Substeps );
		impulses.begin( world.m_constraints, substeps );
		for ( ; substep < substeps; ++substep )
		{
			stepPass( world, timeStep / btScalar( substeps ) );
			world.updateActivationState( timeStep / btScalar( substeps ) );
		}
		impulses.end( *world.m_dispatcher1 );
		endPass( world );
		bodies.endSubsteps();
	}
	const btScalar h = bodies.group.isEmpty() ? timeStep : timeStep / btScalar( substeps );
	lengths = Lengths{ hasWhole ? timeStep : h, h };
	world.updateActions( timeStep );
	if ( hasWhole )
	{
		beginPass( world, StepPass::Whole );
		world.updateActivationState( timeStep );
		endPass( world );
	}
	if ( isStepping )
	{
		bodies.endStep();
	}
	isStepping = false;
}

void SoftBodyWorld::predictUnconstraintMotion( btScalar timeStep )
{
	m_system->bodies.pool.nextPhase( m_system->isNewStep );
	m_system->isNewStep = false;
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
	if ( m_system->bodies.group.isSplit() )
	{
		m_system->detectPass( *this );
	}
	else
	{
		btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
	}
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
	m_system->bodies.countContacts( moved.count() );
	if ( moved.hasRollingFriction() )
	{
		m_system->turning.hide( *getDispatcher() );
	}
	if ( m_system->isStepping )
	{
		m_system->bodies.solveImplicit( *getDispatcher(), info );
		m_system->bodies.frictionTorque.aim( *getDispatcher() );
	}
	if ( moved.hasRestitution() && m_system->isStepping )
	{
		m_system->bounces.aim( *getDispatcher(), info );
	}
	btDiscreteDynamicsWorld::solveConstraints( info );
	if ( moved.hasRestitution() && m_system->isStepping )
	{
		m_system->bounces.settle();
	}
	if ( m_system->isStepping )
	{
		m_system->bodies.frictionTorque.sum( *getDispatcher() );
		m_system->bodies.noteSolved();
	}
	moved.moveBack();
	m_system->bodies.readBack();
	if ( moved.hasRollingFriction() )
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
		m_system->bodies.frictionTorque.give();
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

// The end of a game's step, whoever made it: Bullet's stepSimulation, ours, or that of a class which derives from this one.
void SoftBodyWorld::clearForces()
{
	m_system->isTickOver = true;
	btDiscreteDynamicsWorld::clearForces();
	m_system->bodies.clearForces();
}

} // namespace pliant
