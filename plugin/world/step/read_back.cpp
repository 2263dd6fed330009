// What Bullet's solver made of the stand-ins' speeds and places goes back to their nodes.

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"

#include <LinearMath/btQuickprof.h>

#include <algorithm>

namespace pliant {

void SoftBodySystem::readBack()
{
	BT_PROFILE( "pliant: readBack" );
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		NodeState& nodes = impl.body->nodes();
		bool wakes = false, isPushed = false;
		if ( impl.isGuarded )
		{
			m_positionsBefore.resize( std::size_t( nodes.count ) );
			for ( int i = 0; i < nodes.count; ++i )
			{
				m_positionsBefore[std::size_t( i )] = nodes.x.get( i );
			}
		}
		for ( std::size_t k = 0; k < impl.touched.size(); ++k )
		{
			ContactProxy* const stand = impl.touched[k];
			ContactProxyPool::prefetchVelocity( *impl.touched[std::min( k + kProxiesAhead, impl.touched.size() - 1 )] );
			wakes = wakes || ( stand->wasAsleep && stand->isActive() );
			if ( !body->isActive() )
			{
				stand->forceActivationState( body->getActivationState() );
				stand->wasAsleep = true;
			}
			if ( !pool.isFresh( *stand ) || nodes.freedom[stand->node] == 0.0f || impl.block >= 0 || !moves( *body ) ||
				body->getCollisionFlags() & btCollisionObject::CF_NO_CONTACT_RESPONSE )
			{
				continue;
			}
			nodes.v.set( stand->node, toVec3( stand->getLinearVelocity() ) );
			const btVector3 pushed = stand->getWorldTransform().getOrigin() - stand->written; // split impulse moves positions
			if ( !pushed.isZero() )
			{
				nodes.x.set( stand->node, nodes.x.get( stand->node ) + toVec3( pushed ) );
				isPushed = true;
			}
		}
		if ( isPushed && impl.isGuarded )
		{
			keepPushedNodesOut( *body, m_positionsBefore );
		}
		if ( wakes )
		{
			body->activate();
		}
	}
}

} // namespace pliant
