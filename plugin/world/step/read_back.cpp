// Copies the velocities and positions that Bullet's solver gave contact proxies back to their nodes.

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
			ContactProxy* const proxy = impl.touched[k];
			ContactProxyPool::prefetchVelocity( *impl.touched[std::min( k + kProxiesAhead, impl.touched.size() - 1 )] );
			wakes = wakes || ( proxy->wasAsleep && proxy->isActive() );
			if ( !body->isActive() )
			{
				proxy->forceActivationState( body->getActivationState() );
				proxy->wasAsleep = true;
			}
			if ( !pool.isFresh( *proxy ) || nodes.freedom[proxy->node] == 0.0f || impl.block >= 0 || !moves( *body ) ||
				body->getCollisionFlags() & btCollisionObject::CF_NO_CONTACT_RESPONSE )
			{
				continue;
			}
			nodes.v.set( proxy->node, toVec3( proxy->getLinearVelocity() ) );
			const btVector3 pushed = proxy->getWorldTransform().getOrigin() - proxy->written; // split impulse moves positions
			if ( !pushed.isZero() )
			{
				nodes.x.set( proxy->node, nodes.x.get( proxy->node ) + toVec3( pushed ) );
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
