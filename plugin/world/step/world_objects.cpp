// Objects that enter and leave a world, and its serialization.

#include "world/bodies/soft_body_impl.h"
#include "world/step/island_manager.h"
#include "world/step/world_step.h"

#include <BulletDynamics/Dynamics/btSimulationIslandManagerMt.h>
#include <LinearMath/btSerializer.h>

#include <new>

namespace pliant {

namespace {

// Replaces the base's island manager, as btDiscreteDynamicsWorldMt does; the base owns the new one.
template <class Base>
btSimulationIslandManager* replaced( btSimulationIslandManager* base, SoftBodySystem& bodies )
{
	using Manager = IslandManager<Base>;
	base->~btSimulationIslandManager();
	btAlignedFree( base );
	void* const memory = btAlignedAlloc( sizeof( Manager ), 16 );
	return new ( memory ) Manager( bodies );
}

btCollisionObjectArray withoutSoftBodies( const btCollisionObjectArray& objects )
{
	btCollisionObjectArray others;
	for ( int k = 0; k < objects.size(); ++k )
	{
		if ( !SoftBody::upcast( objects[k] ) )
		{
			others.push_back( objects[k] );
		}
	}
	return others;
}

} // namespace

WorldStep::WorldStep( BulletStages& stages, const BulletStages::Parts& parts ) :
	bodies( parts.world, parts.dispatcher ), m_stages( stages ), m_parts( parts )
{
	m_parts.islandManager = parts.hasIslandManagerMt ? replaced<btSimulationIslandManagerMt>( parts.islandManager, bodies )
													 : replaced<btSimulationIslandManager>( parts.islandManager, bodies );
	bodies.pairScratch.postponesAll = parts.hasIslandManagerMt;
}

// Deletes the fragments that the game has not released, and removes all other bodies, which the game owns, with their contacts while the
// pool still exists.
void WorldStep::leave()
{
	while ( !bodies.owned.empty() )
	{
		delete bodies.owned.back();
	}
	while ( !bodies.bodies().empty() )
	{
		remove( bodies.bodies().back() );
	}
	bodies.frames.removeAll( m_parts.world );
	m_stages.releasePredictiveContacts();
	bodies.dropPredictiveContacts();
}

void WorldStep::addSoftBody( SoftBody* body, int group, int mask )
{
	if ( body && !bodies.fields.areActing() && bodies.add( *body ) )
	{
		m_stages.baseAdd( body, group, mask );
	}
}

void WorldStep::add( btCollisionObject* object, int group, int mask )
{
	if ( isContactProxy( object ) )
	{
		return;
	}
	SoftBody* const soft = asSoftBody( object );
	if ( !soft )
	{
		m_stages.baseAdd( object, group, mask );
		return;
	}
	const bool isDefault = group == btBroadphaseProxy::StaticFilter &&
		mask == ( btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter );
	const bool isDynamic = isDefault && !soft->isStaticOrKinematicObject();
	isDynamic ? addSoftBody( soft, btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter ) : addSoftBody( soft, group, mask );
}

void WorldStep::remove( btCollisionObject* object )
{
	SoftBody* const soft = SoftBody::upcast( object );
	if ( !soft && !isContactProxy( object ) )
	{
		if ( !btRigidBody::upcast( object ) )
		{
			forgetObject( *object );
		}
		m_stages.baseRemove( object ); // which calls removeRigidBody
	}
	if ( !soft || soft->impl().system != &bodies )
	{
		return;
	}
	bodies.updateWorldIndex( *soft );
	if ( soft->impl().rigidProxy )
	{
		bodies.wakeTouching( *soft ); // contacts of nodes do this when they end
	}
	// Predictive contacts may still refer to its nodes, so they are released first. The pair cache then frees the algorithms with their
	// manifolds and contact proxies.
	m_stages.releasePredictiveContacts();
	bodies.dropPredictiveContacts();
	forgetObject( *soft );
	m_parts.world.btCollisionWorld::removeCollisionObject( soft );
	bodies.remove( *soft );
}

void WorldStep::forgetObject( btCollisionObject& object )
{
	bodies.attachments.removeAllOf( object );
	bodies.contactEvents.forget( object, bodies.bodies() );
	bodies.frames.forget( object, m_parts.world );
	bodies.group.noteRemoval( object, m_parts.world.getNumCollisionObjects() );
	m_outside.forget( object );
	m_kinematic.forget( object );
	if ( btRigidBody* const body = btRigidBody::upcast( &object ) )
	{
		m_rigid.forget( body );
		bodies.fields.forget( *body );
	}
}

void WorldStep::forget( btRigidBody& body )
{
	bodies.releasePinsTo( body );
	forgetObject( body );
}

void WorldStep::forget( btTypedConstraint& joint )
{
	m_joints.forget( &joint );
	m_impulses.forget( &joint );
}

// The base writes all objects and contacts that it sees; soft bodies and their contacts are hidden from it.
void WorldStep::serialize( btSerializer& serializer )
{
	const btCollisionObjectArray all( m_parts.objects );
	m_parts.objects = withoutSoftBodies( all );
	btDispatcher* const dispatcher = m_parts.dispatcher;
	m_view.show( *dispatcher, []( const btPersistentManifold& manifold ) {
		return !SoftBody::upcast( manifold.getBody0() ) && !SoftBody::upcast( manifold.getBody1() );
	} );
	m_parts.dispatcher = &m_view;
	m_stages.baseSerialize( &serializer );
	m_parts.dispatcher = dispatcher;
	m_parts.objects = all;
}

} // namespace pliant
