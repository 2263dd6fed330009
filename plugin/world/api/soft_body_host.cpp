#include "pliant/soft_body_host.h"

#include "world/api/debug_draw.h"
#include "world/constants.h"
#include "world/step/world_step.h"

#include <algorithm>
#include <cmath>

namespace pliant {

SoftBodyHost::SoftBodyHost() = default;

SoftBodyHost::~SoftBodyHost() = default;

void SoftBodyHost::hostAttach( BulletStages& stages, const BulletStages::Parts& parts, BulletPrecision )
{
	m_step = std::make_unique<WorldStep>( stages, parts );
	m_isPlain = &m_step->bodies.isPlain;
}

void SoftBodyHost::hostDetach()
{
	m_step->leave();
}

// === Calls of games ===

void SoftBodyHost::addSoftBody( SoftBody* body, int group, int mask )
{
	m_step->addSoftBody( body, group, mask );
}

void SoftBodyHost::removeSoftBody( SoftBody* body )
{
	if ( body && !m_step->bodies.fields.areActing() )
	{
		m_step->world().removeCollisionObject( body );
	}
}

int SoftBodyHost::softBodyCount() const
{
	return int( m_step->bodies.bodies().size() );
}

SoftBody* SoftBodyHost::softBody( int index ) const
{
	const std::vector<SoftBody*>& bodies = m_step->bodies.bodies();
	return index >= 0 && index < int( bodies.size() ) ? bodies[std::size_t( index )] : nullptr;
}

void SoftBodyHost::setInterpolationFraction( btScalar fraction )
{
	m_step->bodies.drawnFraction = fraction >= 0 ? std::min( double( fraction ), 1.0 ) : fraction < 0 ? 0.0 : 1.0;
}

btScalar SoftBodyHost::interpolationFraction() const
{
	return btScalar( m_step->bodies.drawnFraction );
}

void SoftBodyHost::setSoftSubsteps( int count )
{
	m_step->bodies.substeps = std::clamp( count, 1, kLargestSubsteps );
}

int SoftBodyHost::softSubsteps() const
{
	return m_step->bodies.substeps;
}

void SoftBodyHost::setMaxSoftSubsteps( int count )
{
	m_step->bodies.maxSubsteps = std::clamp( count, 1, kLargestSubsteps );
}

int SoftBodyHost::maxSoftSubsteps() const
{
	return m_step->bodies.maxSubsteps;
}

void SoftBodyHost::setThreadCount( int count )
{
	if ( m_step->bodies.isBusy() )
	{
		return;
	}
	if ( std::unique_ptr<TaskRunner> made = createThreadPool( count ) )
	{
		m_step->bodies.ownRunner = std::move( made );
	}
}

void SoftBodyHost::setTaskRunner( TaskRunner* runner )
{
	m_step->bodies.runner = m_step->bodies.isBusy() ? m_step->bodies.runner : runner;
}

int SoftBodyHost::threadCount() const
{
	return std::max( m_step->bodies.tasks()->threadCount(), 1 );
}

const StepReport& SoftBodyHost::stepReport() const
{
	return m_step->bodies.report;
}

const std::vector<FractureEvent>& SoftBodyHost::fractureEvents() const
{
	return m_step->bodies.events;
}

int SoftBodyHost::fragmentCount() const
{
	return int( m_step->bodies.owned.size() );
}

bool SoftBodyHost::releaseFragment( SoftBody* fragment )
{
	return fragment && !m_step->bodies.fields.areActing() && m_step->bodies.release( *fragment );
}

DebrisBudget SoftBodyHost::debrisBudget() const
{
	return m_step->bodies.debris;
}

btDiscreteDynamicsWorld& SoftBodyHost::bulletWorld() const
{
	return m_step->world();
}

void SoftBodyHost::setDebugDrawing( const DebugDrawing& what )
{
	DebugDrawing& taken = m_step->bodies.drawing;
	const DebugDrawing usual;
	taken = what;
	taken.fullStrain = std::isfinite( what.fullStrain ) && what.fullStrain > 0 ? what.fullStrain : usual.fullStrain;
	taken.metresPerNewton = std::isfinite( what.metresPerNewton ) ? what.metresPerNewton : usual.metresPerNewton;
	taken.metresPerImpulse = std::isfinite( what.metresPerImpulse ) ? what.metresPerImpulse : usual.metresPerImpulse;
}

const DebugDrawing& SoftBodyHost::debugDrawing() const
{
	return m_step->bodies.drawing;
}

// === Calls of the world's overrides ===

void SoftBodyHost::singleStep( btScalar timeStep )
{
	m_step->singleStep( timeStep );
}

void SoftBodyHost::predictStage( btScalar h )
{
	m_step->predict( h );
}

void SoftBodyHost::predictiveContactsStage( btScalar h )
{
	m_step->findPredictiveContacts( h );
}

void SoftBodyHost::detectStage()
{
	m_step->detect();
}

void SoftBodyHost::islandsStage()
{
	m_step->findIslands();
}

void SoftBodyHost::solveStage( btContactSolverInfo& info )
{
	m_step->solve( info );
}

void SoftBodyHost::integrateStage( btScalar h )
{
	m_step->integrate( h );
}

void SoftBodyHost::activationStage( btScalar h )
{
	m_step->updateActivation( h );
}

bool SoftBodyHost::beginTick( btScalar& timeStep, int maxSubSteps, btScalar fixedTimeStep )
{
	return m_step->beginTick( timeStep, maxSubSteps, fixedTimeStep );
}

void SoftBodyHost::endTick()
{
	m_step->endTick();
}

void SoftBodyHost::hostAdd( btCollisionObject* object, int group, int mask )
{
	m_step->add( object, group, mask );
}

void SoftBodyHost::hostRemove( btCollisionObject* object )
{
	m_step->remove( object );
}

bool SoftBodyHost::hostMayAdd( const btRigidBody* body )
{
	return !isContactProxy( body );
}

void SoftBodyHost::hostForget( btRigidBody& body )
{
	m_step->forget( body );
}

void SoftBodyHost::hostForget( btTypedConstraint& joint )
{
	m_step->forget( joint );
}

void SoftBodyHost::hostForget( btMultiBody& body )
{
	m_step->forget( body );
}

void SoftBodyHost::hostForget( btMultiBodyConstraint& joint )
{
	m_step->forget( joint );
}

void SoftBodyHost::hostDrawPins()
{
	if ( btIDebugDraw* const drawer = m_step->world().getDebugDrawer() )
	{
		drawBetweenBodies( m_step->bodies, *drawer, m_step->bodies.drawing );
	}
}

bool SoftBodyHost::hostDrawShape( const btCollisionShape* shape, const btVector3& colour )
{
	btIDebugDraw* const drawer = m_step->world().getDebugDrawer();
	return drawer && drawSoftBody( m_step->bodies, shape, colour, *drawer, m_step->bodies.drawing );
}

void SoftBodyHost::hostSerialize( btSerializer& serializer )
{
	m_step->serialize( serializer );
}

} // namespace pliant
