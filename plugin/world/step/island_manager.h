#pragma once

// Bullet's island manager, which also copies the island tag of each soft body to its contact proxies. This happens twice a step: after the
// union-find's indices are assigned and after the final tags are.
//
// Bullet unites all objects whose bounding boxes overlap. A soft body's box is large compared to its material, and the boxes of fragments
// overlap one another. Soft bodies are therefore united with the objects they touch only; otherwise no body of a heap could sleep while
// one of them moves.
//
// Where the step makes several passes (substep_group.h), islands consist of the objects that the pass moves; the others keep their tags.

#include "pliant/soft_body.h"
#include "world/bodies/manifolds.h"
#include "world/bodies/soft_body_impl.h"
#include "world/shape/contact_proxy.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>

namespace pliant {

/// `Base`: btSimulationIslandManager or btSimulationIslandManagerMt.
template <class Base>
class IslandManager : public Base
{
public:
	explicit IslandManager( SoftBodySystem& bodies ) : m_bodies( bodies ) {}

	void updateActivationState( btCollisionWorld* world, btDispatcher* dispatcher ) override
	{
		if ( m_bodies.isEmpty() )
		{
			Base::updateActivationState( world, dispatcher );
			return;
		}
		int index = 0;
		for ( int i = 0; i < world->getNumCollisionObjects(); ++i )
		{
			btCollisionObject* const object = world->getCollisionObjectArray()[i];
			// A body that has just been made static would keep its tag of the last step.
			if ( object->isStaticOrKinematicObject() )
			{
				object->setIslandTag( -1 );
			}
			else if ( m_bodies.isInPass( *object ) )
			{
				object->setIslandTag( index++ );
			}
			else
			{
				continue;
			}
			object->setCompanionId( -1 );
			object->setHitFraction( btScalar( 1 ) );
		}
		this->initUnionFind( index );
		uniteByBoxes( *world->getPairCache() );
		uniteByContacts( *dispatcher, world->getCollisionObjectArray() );
		uniteByAttachments();
		m_bodies.copyIslandTags();
	}
	void storeIslandActivationState( btCollisionWorld* world ) override
	{
		if ( m_bodies.group.isSplit() )
		{
			storePass( *world );
		}
		else
		{
			Base::storeIslandActivationState( world );
		}
		m_bodies.copyIslandTags();
	}

private:
	/// Bullet's storeIslandActivationState, for the objects of the pass.
	void storePass( btCollisionWorld& world )
	{
		constexpr int kFixed = -2; // Bullet's companion id of static objects
		int index = 0;
		for ( int i = 0; i < world.getNumCollisionObjects(); ++i )
		{
			btCollisionObject* const object = world.getCollisionObjectArray()[i];
			if ( object->isStaticOrKinematicObject() )
			{
				object->setIslandTag( -1 );
				object->setCompanionId( kFixed );
			}
			else if ( m_bodies.isInPass( *object ) )
			{
				object->setIslandTag( this->getUnionFind().find( index ) );
				this->getUnionFind().getElement( index ).m_sz = i;
				object->setCompanionId( -1 );
				++index;
			}
		}
	}
	/// Pinned bodies in their rigid state connect nothing, like static objects: else one swinging shard would keep a whole pane awake.
	static bool connects( const btCollisionObject* object )
	{
		const SoftBody* const soft = object && object->mergesSimulationIslands() ? SoftBody::upcast( object ) : nullptr;
		return object && object->mergesSimulationIslands() && !( soft && soft->impl().rigidProxy && soft->impl().rigidProxy->isHeld() );
	}
	void unite( const btCollisionObject* a, const btCollisionObject* b )
	{
		if ( connects( a ) && connects( b ) )
		{
			this->getUnionFind().unite( a->getIslandTag(), b->getIslandTag() );
		}
	}
	static bool isSoft( const btCollisionObject* object ) { return object && SoftBody::upcast( object ); }

	/// Unites pairs of rigid bodies, as Bullet does.
	void uniteByBoxes( btOverlappingPairCache& pairs )
	{
		for ( int i = 0; i < pairs.getNumOverlappingPairs(); ++i )
		{
			const btBroadphasePair& pair = pairs.getOverlappingPairArrayPtr()[i];
			const auto* const a = static_cast<const btCollisionObject*>( pair.m_pProxy0->m_clientObject );
			const auto* const b = static_cast<const btCollisionObject*>( pair.m_pProxy1->m_clientObject );
			if ( !isSoft( a ) && !isSoft( b ) && a && b && m_bodies.isInPass( *a ) && m_bodies.isInPass( *b ) )
			{
				unite( a, b );
			}
		}
	}

	/// Another world may share the dispatcher; the tags of its objects do not apply here.
	static bool isIn( const btCollisionObjectArray& objects, const btCollisionObject* object )
	{
		const int index = object->getWorldArrayIndex();
		return index >= 0 && index < objects.size() && objects[index] == object;
	}

	void uniteByAttachments()
	{
		const auto uniteMoving = [this]( const btCollisionObject& a, const btCollisionObject& b ) {
			if ( !a.isStaticOrKinematicObject() && !b.isStaticOrKinematicObject() && m_bodies.isInPass( a ) && m_bodies.isInPass( b ) )
			{
				unite( &a, &b );
			}
		};
		for ( const Attachment& attachment : m_bodies.attachments.all() )
		{
			uniteMoving( *attachment.first.body, attachment.secondObject() );
		}
		for ( const Frame& frame : m_bodies.frames.all() )
		{
			if ( frame.body )
			{
				uniteMoving( *frame.body, *frame.rigid );
			}
		}
	}

	void uniteByContacts( btDispatcher& dispatcher, const btCollisionObjectArray& objects )
	{
		forEachManifold( dispatcher, [this, &objects]( const btPersistentManifold& manifold ) {
			const btCollisionObject *a = manifold.getBody0(), *b = manifold.getBody1();
			const SoftBody *const ownerA = ownerOfContactProxy( a ), *const ownerB = ownerOfContactProxy( b );
			a = ownerA ? ownerA : a;
			b = ownerB ? ownerB : b;
			if ( manifold.getNumContacts() <= 0 || !isIn( objects, a ) || !isIn( objects, b ) )
			{
				return;
			}
			if ( ( a && !a->isStaticOrKinematicObject() && !m_bodies.isInPass( *a ) ) ||
				( b && !b->isStaticOrKinematicObject() && !m_bodies.isInPass( *b ) ) )
			{
				return;
			}
			if ( ownerA || ownerB || isSoft( a ) || isSoft( b ) )
			{
				unite( a, b );
			}
		} );
	}

	SoftBodySystem& m_bodies;
};

} // namespace pliant
