#include "world/step/soft_body_world_impl.h"

#include "world/api/debug_draw.h"
#include "world/api/rigid_file.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/island_manager.h"

#include <LinearMath/btSerializer.h>

#include <algorithm>
#include <new>

namespace pliant {

SoftBodyWorld::SoftBodyWorld( btDispatcher* dispatcher, btBroadphaseInterface* broadphase, btConstraintSolver* solver,
	btCollisionConfiguration* configuration, BulletPrecision ) :
	btDiscreteDynamicsWorld( dispatcher, broadphase, solver, configuration ),
	m_system( std::make_unique<System>( *this, dispatcher ) )
{
	// As btDiscreteDynamicsWorldMt does it: the base made a manager and owns it; ours takes its place and is owned in turn.
	m_islandManager->~btSimulationIslandManager();
	btAlignedFree( m_islandManager );
	void* const memory = btAlignedAlloc( sizeof( IslandManager ), 16 );
	m_islandManager = new ( memory ) IslandManager( m_system->bodies );
}

SoftBodyWorld::~SoftBodyWorld()
{
	// Fragments that nobody has taken over go. What the game added stays the game's: the bodies leave, and take their contacts along while
	// the pool still stands.
	while ( !m_system->bodies.owned.empty() )
	{
		delete m_system->bodies.owned.back();
	}
	while ( !m_system->bodies.bodies().empty() )
	{
		removeSoftBody( m_system->bodies.bodies().back() );
	}
	releasePredictiveContacts();
	m_system->bodies.dropPredictiveContacts();
}

void SoftBodyWorld::addSoftBody( SoftBody* body, int group, int mask )
{
	if ( body && m_system->bodies.add( *body ) )
	{
		btDiscreteDynamicsWorld::addCollisionObject( body, group, mask );
	}
}

void SoftBodyWorld::removeSoftBody( SoftBody* body )
{
	if ( body )
	{
		removeCollisionObject( body );
	}
}

void SoftBodyWorld::addCollisionObject( btCollisionObject* object, int group, int mask )
{
	if ( isContactProxy( object ) )
	{
		return;
	}
	SoftBody* const soft = asSoftBody( object );
	if ( !soft )
	{
		btDiscreteDynamicsWorld::addCollisionObject( object, group, mask );
		return;
	}
	const bool isDefault = group == btBroadphaseProxy::StaticFilter &&
		mask == ( btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter );
	isDefault && !soft->isStaticOrKinematicObject() ? addSoftBody( soft ) : addSoftBody( soft, group, mask );
}

void SoftBodyWorld::addRigidBody( btRigidBody* body )
{
	if ( !isContactProxy( body ) )
	{
		btDiscreteDynamicsWorld::addRigidBody( body );
	}
}

void SoftBodyWorld::addRigidBody( btRigidBody* body, int group, int mask )
{
	if ( !isContactProxy( body ) )
	{
		btDiscreteDynamicsWorld::addRigidBody( body, group, mask );
	}
}

void SoftBodyWorld::removeCollisionObject( btCollisionObject* object )
{
	SoftBody* const soft = SoftBody::upcast( object );
	if ( !soft && !isContactProxy( object ) )
	{
		if ( !btRigidBody::upcast( object ) )
		{
			m_system->forget( *object, getNumCollisionObjects() );
		}
		btDiscreteDynamicsWorld::removeCollisionObject( object ); // which calls removeRigidBody
	}
	if ( !soft || soft->impl().system != &m_system->bodies )
	{
		return;
	}
	m_system->bodies.findPlace( *soft );
	// Predictive contacts may still name its nodes; then the pair cache lets the algorithms go, and with them manifolds and stand-ins.
	releasePredictiveContacts();
	m_system->bodies.dropPredictiveContacts();
	m_system->forget( *soft, getNumCollisionObjects() );
	btCollisionWorld::removeCollisionObject( soft );
	m_system->bodies.remove( *soft );
}

void SoftBodyWorld::removeRigidBody( btRigidBody* body )
{
	if ( isContactProxy( body ) )
	{
		removeCollisionObject( body );
		return;
	}
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
	const std::vector<SoftBody*>& bodies = m_system->bodies.bodies();
	return index >= 0 && index < int( bodies.size() ) ? bodies[std::size_t( index )] : nullptr;
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
	if ( !m_system->bodies.acceptsSteps( timeStep, maxSubSteps, fixedTimeStep ) )
	{
		return 0;
	}
	return btDiscreteDynamicsWorld::stepSimulation( timeStep, maxSubSteps, fixedTimeStep );
}

void SoftBodyWorld::debugDrawWorld()
{
	btDiscreteDynamicsWorld::debugDrawWorld();
	if ( getDebugDrawer() )
	{
		drawPins( m_system->bodies, *getDebugDrawer() );
	}
}

void SoftBodyWorld::debugDrawObject( const btTransform& transform, const btCollisionShape* shape, const btVector3& colour )
{
	if ( !getDebugDrawer() || !drawSoftBody( m_system->bodies, shape, colour, *getDebugDrawer() ) )
	{
		btDiscreteDynamicsWorld::debugDrawObject( transform, shape, colour );
	}
}

// As Bullet's own. What is written of the list of objects is written of all that are in it: soft bodies stand aside for that time.
void SoftBodyWorld::serialize( btSerializer* serializer )
{
	const btCollisionObjectArray all( m_collisionObjects );
	m_collisionObjects = withoutSoftBodies( all );
	serializer->startSerialization();
	serializeDynamicsWorldInfo( serializer );
	serializeCollisionObjects( serializer );
	serializeRigidBodies( serializer );
	m_collisionObjects = all;
	serializeRigidContacts( *getDispatcher(), *serializer );
	serializer->finishSerialization();
}

} // namespace pliant
