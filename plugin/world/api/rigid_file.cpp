#include "world/api/rigid_file.h"

#include "pliant/soft_body.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <LinearMath/btSerializer.h>

namespace pliant {

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

void serializeRigidContacts( btDispatcher& dispatcher, btSerializer& serializer )
{
	const bool isAsked = ( serializer.getSerializationFlags() & BT_SERIALIZE_CONTACT_MANIFOLDS ) != 0;
	for ( int m = 0; isAsked && m < dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold* const manifold = dispatcher.getManifoldByIndexInternal( m );
		if ( manifold->getNumContacts() == 0 || SoftBody::upcast( manifold->getBody0() ) || SoftBody::upcast( manifold->getBody1() ) )
		{
			continue;
		}
		btChunk* const chunk = serializer.allocate( std::size_t( manifold->calculateSerializeBufferSize() ), 1 );
		const char* const type = manifold->serialize( manifold, chunk->m_oldPtr, &serializer );
		serializer.finalizeChunk( chunk, type, BT_CONTACTMANIFOLD_CODE, const_cast<btPersistentManifold*>( manifold ) );
	}
}

} // namespace pliant
