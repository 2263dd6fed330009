// The order of a step.
//
// A game step makes one pass over the stages by the whole step, for all objects that no explicit soft body touches, and then one pass per
// substep for the explicit soft bodies and what touches them (substep_group.h). Actions and tick callbacks run once, as in Bullet's world.
// A pass of length h:
//
//   stage                    reads                                    writes
//   predict                  x, v, F, pins, forces, strain            v; topology: pieces come off, levels change; swept boxes
//   findPredictiveContacts   fast rigid bodies                        their contacts with nodes
//   detect                   x, v, boxes, shapes                      contacts, including those of bodies with themselves
//   findIslands              contacts, joints                         island tags, start impulses
//   solve                    contacts, v                              v of nodes and rigid bodies, impulses
//   integrate                v                                        x, spheres; the links that break next
//   updateActivation         v, x                                     sleep states
//
// Each stage is called once a pass through the world's virtual functions, so that a game's subclass may extend it. The functions that the
// stages below call are called nowhere else; tests/house (StagesAreCalledInOnePlace) checks this.

#include "world/step/world_step.h"

#include "world/bodies/soft_body_impl.h"
#include "world/detect/manifold_order.h"
#include "world/stopwatch.h"

#include <LinearMath/btQuickprof.h>

#include <algorithm>

namespace pliant {

namespace {

/// Game steps that Bullet makes of the time of a stepSimulation.
int gameStepsOf( btScalar time, int most, btScalar step )
{
	return most == 0 ? 1 : int( std::min( time / step, btScalar( most ) ) );
}

} // namespace

// === The game step ===

// Events are those of the last tick, and small pieces that have faded leave between ticks.
void WorldStep::openTick()
{
	m_isTickOver = false;
	bodies.events.clear();
	bodies.attachments.events.clear();
	bodies.contactEvents.clear( bodies.bodies() );
	bodies.removeFaded();
	m_kinematic.clear();
}

bool WorldStep::beginTick( btScalar& timeStep, int maxSubSteps, btScalar fixedTimeStep )
{
	if ( bodies.isBusy() )
	{
		return false; // called from within a step
	}
	openTick();
	if ( !bodies.acceptsSteps( timeStep, maxSubSteps, fixedTimeStep ) )
	{
		return false;
	}
	if ( !bodies.isEmpty() )
	{
		m_kinematic.noteStarts( m_parts.objects, gameStepsOf( m_parts.localTime + timeStep, maxSubSteps, fixedTimeStep ) );
	}
	return true;
}

void WorldStep::singleStep( btScalar timeStep )
{
	if ( m_isTickOver )
	{
		openTick(); // the game, or a class derived from the world, calls single steps itself
	}
	if ( !bodies.openStep( timeStep ) )
	{
		return;
	}
	bodies.fields.pushRigid();
	if ( bodies.isEmpty() )
	{
		bodies.report = StepReport{};
		bodies.report.removedPieces = bodies.removedSinceStep;
		bodies.isPlain = bodies.fields.count() == 0 && bodies.removedSinceStep == 0;
		m_stages.baseSingleStep( timeStep );
		return;
	}
	BT_PROFILE( "internalSingleStepSimulation" );
	if ( m_parts.preTick )
	{
		m_parts.preTick( &m_parts.world, timeStep );
	}
	m_impulses.restoreLastSubstep( *m_parts.dispatcher );
	double preparation = 0.0; // s
	{
		Stopwatch watch( preparation );
		bodies.wakeDriven();
		bodies.deformLoaded( timeStep );
	}
	const int substeps = bodies.planSubsteps( timeStep, m_parts ); // which wakes what will be hit
	m_isStepping = bodies.hasAwakeBody();
	bodies.beginStep( timeStep, substeps );
	bodies.report.total = preparation;
	{
		Stopwatch watch( bodies.report.total );
		makePasses( timeStep, substeps );
	}
	if ( m_parts.tick && !( m_parts.hasOwnSingleStep && bodies.group.isEmpty() ) ) // else the base has called it
	{
		m_parts.tick( &m_parts.world, timeStep );
	}
}

void WorldStep::makePasses( btScalar timeStep, int substeps )
{
	const bool hasWhole = bodies.group.isEmpty() || bodies.group.isSplit();
	m_kinematic.beginStep( m_parts.objects, timeStep );
	bodies.areStagesRunning = true;
	m_substep = 0;
	m_isNewStep = true;
	m_gameStep = timeStep;
	if ( hasWhole )
	{
		beginPass( StepPass::Whole );
		runPass( timeStep );
		endPass();
	}
	if ( !bodies.group.isEmpty() )
	{
		beginPass( StepPass::Substeps );
		m_impulses.begin( m_parts.constraints, substeps );
		for ( ; m_substep < substeps; ++m_substep )
		{
			m_kinematic.place( btScalar( m_substep + 1 ) / btScalar( substeps ) );
			runPass( timeStep / btScalar( substeps ) );
			if ( !m_parts.hasOwnSingleStep )
			{
				m_stages.updateActivation( timeStep / btScalar( substeps ) );
			}
		}
		m_kinematic.finish();
		m_impulses.end( *m_parts.dispatcher );
		endPass();
		bodies.endSubsteps();
	}
	const btScalar h = bodies.group.isEmpty() ? timeStep : timeStep / btScalar( substeps );
	bodies.areStagesRunning = false; // actions are the game's, and see the whole world
	m_lengths = Lengths{ hasWhole ? timeStep : h, h };
	if ( !m_parts.hasOwnSingleStep || !hasWhole )
	{
		m_stages.updateActions( timeStep );
	}
	if ( hasWhole && !m_parts.hasOwnSingleStep )
	{
		beginPass( StepPass::Whole );
		m_stages.updateActivation( timeStep );
		endPass();
	}
	if ( m_isStepping )
	{
		bodies.contactEvents.endStep( *m_parts.dispatcher, bodies.bodies(), m_parts.world ); // before shapes change
		bodies.endStep();
	}
	m_isStepping = false;
}

// A base that replaces Bullet's single step makes the pass itself, through the stages. It calls callbacks and actions in each pass, so
// those that run once a game step are hidden from it.
void WorldStep::runPass( btScalar h )
{
	m_passLength = h;
	if ( !m_parts.hasOwnSingleStep )
	{
		runStages( h );
		return;
	}
	const bool isWhole = bodies.pass() == StepPass::Whole;
	const btInternalTickCallback preTick = m_parts.preTick, tick = m_parts.tick;
	btAlignedObjectArray<btActionInterface*> actions( m_parts.actions );
	m_parts.preTick = nullptr;
	if ( !isWhole )
	{
		m_parts.tick = nullptr;
		m_parts.actions.resizeNoInitialize( 0 );
	}
	m_stages.baseSingleStep( h );
	m_parts.preTick = preTick;
	if ( !isWhole )
	{
		m_parts.tick = tick;
		m_parts.actions = actions;
	}
}

// Bullet's internalSingleStepSimulation, for the objects of the pass.
void WorldStep::runStages( btScalar h )
{
	m_stages.predict( h );
	btDispatcherInfo& info = m_parts.world.getDispatchInfo();
	info.m_timeStep = h;
	info.m_stepCount = 0;
	info.m_debugDraw = m_parts.world.getDebugDrawer();
	m_stages.findPredictiveContacts( h );
	m_stages.detect();
	btDispatcher* const dispatcher = m_parts.dispatcher;
	showPass(); // islands and solver see only the manifolds of the pass
	m_stages.findIslands();
	m_parts.world.getSolverInfo().m_timeStep = h;
	m_stages.solve( m_parts.world.getSolverInfo() );
	m_parts.dispatcher = dispatcher;
	m_outside.restore();
	m_stages.integrate( h );
}

// The end of a game step, whether Bullet's stepSimulation, ours or a derived class's made it.
void WorldStep::endTick()
{
	m_isTickOver = true;
	bodies.clearForces();
	bodies.fields.noteClearedForces();
}

// === The stages ===

void WorldStep::predict( btScalar h )
{
	bodies.pool.nextPhase( m_isNewStep );
	m_isNewStep = false;
	if ( m_isStepping )
	{
		bodies.accelerate( h, m_substep ); // breaking, levels, pins, matching, forces, boxes
	}
	m_stages.basePredict( h );
}

void WorldStep::findPredictiveContacts( btScalar h )
{
	if ( bodies.isEmpty() )
	{
		m_stages.baseFindPredictiveContacts( h );
		return;
	}
	m_stages.releasePredictiveContacts(); // before the contact proxies they refer to
	bodies.dropPredictiveContacts();
	m_stages.baseFindPredictiveContacts( h );
	bodies.holdPredictiveContacts( m_parts.predictiveManifolds );
}

void WorldStep::detect()
{
	if ( !m_isStepping )
	{
		detectWhole();
		bodies.releaseRefusedPairs();
		m_isStepping = bodies.areStagesRunning && bodies.wakeHit(); // else the game asks for contacts between steps
		return;
	}
	Stopwatch watch( bodies.report.collision );
	const auto isRigid = []( const SoftBody* body ) { return body->isRigid(); };
	const bool isLater = m_substep > 0 && std::any_of( bodies.bodies().begin(), bodies.bodies().end(), isRigid );
	if ( !isLater )
	{
		m_lostContacts.note( bodies, m_parts.world ); // later substeps complete contacts where they are lost
	}
	if ( bodies.group.isSplit() || isLater )
	{
		detectPass();
		bodies.pairScratch.processPostponed();
	}
	else
	{
		detectWhole();
	}
	const btScalar h = m_parts.world.getDispatchInfo().m_timeStep;
	bodies.completeFirstContacts();
	if ( !isLater )
	{
		m_lostContacts.complete( m_parts.world );
	}
	bodies.collideWithThemselves( h );
	bodies.endCollision( h );
	bodies.releaseRefusedPairs(); // before manifolds are listed, and before pairs count that were not detected because they slept
	bodies.wakeHit();
}

// A parallel dispatcher's threads make manifolds in any order, and leave the pairs of soft bodies.
void WorldStep::detectWhole()
{
	noteManifolds( *m_parts.dispatcher );
	m_stages.baseDetect();
	orderNewManifolds( *m_parts.dispatcher, *m_parts.world.getPairCache() );
	bodies.pairScratch.processPostponed();
}

void WorldStep::findIslands()
{
	bodies.wakeUnsupported();
	if ( bodies.group.isSplit() )
	{
		findPassIslands();
	}
	else
	{
		m_stages.baseFindIslands();
	}
	if ( !bodies.isEmpty() )
	{
		carryImpulses( m_passLength );
	}
}

void WorldStep::solve( btContactSolverInfo& info )
{
	if ( bodies.isEmpty() )
	{
		m_stages.baseSolve( info );
		return;
	}
	// Sleeping bodies too: a rigid body may have hit and woken one in this step.
	Stopwatch watch( bodies.report.solve );
	btDispatcher& dispatcher = *m_parts.dispatcher;
	bodies.showRigidProxies( dispatcher );
	bodies.noteRigidApproaches( dispatcher );
	m_moved.moveToNodes( dispatcher, info );
	bodies.countContacts( m_moved.count() );
	if ( m_moved.hasRollingFriction() )
	{
		m_rolling.hide( m_moved.manifolds() );
	}
	if ( m_isStepping )
	{
		bodies.solveImplicit( m_parts.constraints, dispatcher, info );
		bodies.giveFrames( m_parts.constraints, info );
	}
	m_stages.baseSolve( info ); // joints, and contacts without a deformable body
	if ( m_isStepping )
	{
		bodies.noteSolved();
	}
	m_moved.moveBack();
	bodies.wakeTouched();
	bodies.readFrames( m_parts.constraints, info.m_timeStep );
	if ( m_moved.hasRollingFriction() )
	{
		m_rolling.apply();
	}
	bodies.hideRigidProxies( dispatcher );
	bodies.breakRigid( double( info.m_timeStep ) );
	bodies.contactEvents.add( dispatcher, bodies.bodies() );
	if ( bodies.pass() == StepPass::Substeps )
	{
		m_impulses.add( dispatcher );
	}
	if ( m_isStepping )
	{
		bodies.carryImpulses();
	}
}

void WorldStep::integrate( btScalar h )
{
	m_stages.baseIntegrate( h );
	if ( !m_isStepping )
	{
		return;
	}
	{
		Stopwatch watch( bodies.report.integrate );
		bodies.holdBack( h );
		bodies.integrate( h, m_substep );
	}
	bodies.testLinks( h );
	bodies.turnFrames();
}

void WorldStep::updateActivation( btScalar h )
{
	m_stages.baseUpdateActivation( h );
	if ( m_isStepping )
	{
		bodies.updateActivation( h );
	}
}

} // namespace pliant
