// Pinned nodes: held in place, tied to a rigid body, or driven by the game.

#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

namespace pliant {

Pin* SoftBody::Impl::findPin( int node )
{
	const auto found = std::lower_bound( pins.begin(), pins.end(), node, []( const Pin& pin, int n ) { return pin.node < n; } );
	return found != pins.end() && found->node == node ? &*found : nullptr;
}

Status SoftBody::pin( const PinRequest& request )
{
	if ( request.node < 0 || request.node >= nodeCount() )
	{
		return Status{ ResultCode::BadArgument, "There is no node of this number." };
	}
	if ( !isFinite( request.point ) )
	{
		return Status{ ResultCode::BadArgument, "The pin's target is not finite." };
	}
	Impl& impl = *m_impl;
	Pin* pin = impl.findPin( request.node );
	if ( !pin )
	{
		const auto place = std::lower_bound( impl.pins.begin(), impl.pins.end(), request.node, []( const Pin& p, int n ) { return p.node < n; } );
		pin = &*impl.pins.insert( place, Pin{} );
	}
	pin->node = request.node;
	pin->kind = PinKind( request.kind );
	pin->body = request.body;
	pin->point = request.point;
	pin->hasTarget = pin->kind == PinKind::Driven;
	impl.body->setPinned( request.node, true );
	impl.body->nodes().v.set( request.node, Vec3::Zero() );
	activate( true );
	return {};
}

Status SoftBody::pinNode( int node )
{
	return pin( PinRequest{ node, int( PinKind::Still ), nullptr, btVector3( 0, 0, 0 ) } );
}

Status SoftBody::pinNodeToBody( int node, btRigidBody* body )
{
	if ( !body || node < 0 || node >= nodeCount() )
	{
		return Status{ ResultCode::BadArgument, "pinNodeToBody needs a node and a rigid body." };
	}
	return pin( PinRequest{ node, int( PinKind::FollowsBody ), body, body->getWorldTransform().invXform( nodePosition( node ) ) } );
}

Status SoftBody::driveNode( int node, const btVector3& worldPosition )
{
	return pin( PinRequest{ node, int( PinKind::Driven ), nullptr, worldPosition } );
}

void SoftBody::releaseNode( int node )
{
	Impl& impl = *m_impl;
	if ( Pin* pinned = impl.findPin( node ) )
	{
		impl.pins.erase( impl.pins.begin() + ( pinned - impl.pins.data() ) );
		impl.body->setPinned( node, false );
		activate( true );
	}
}

int SoftBody::pinNodesInside( const btVector3& low, const btVector3& high )
{
	int count = 0;
	for ( int i = 0; i < nodeCount(); ++i )
	{
		const btVector3 p = nodePosition( i );
		const bool isInside = p.x() >= low.x() && p.y() >= low.y() && p.z() >= low.z() && p.x() <= high.x() && p.y() <= high.y() && p.z() <= high.z();
		if ( isInside && pinNode( i ).ok() )
		{
			++count;
		}
	}
	return count;
}

bool SoftBody::isPinned( int node ) const
{
	return m_impl->findPin( node ) != nullptr;
}

void SoftBodySystem::releasePinsTo( const btRigidBody& body )
{
	m_implicit.forget( body );
	for ( SoftBody* soft : m_bodies )
	{
		std::vector<Pin>& pins = soft->impl().pins;
		for ( std::size_t k = pins.size(); k-- > 0; )
		{
			if ( pins[k].body == &body )
			{
				soft->releaseNode( pins[k].node );
			}
		}
	}
}

// A pinned node's speed is what takes it where it must be at the substep's end.
void SoftBodySystem::drivePins( SoftBody& body, btScalar h, int substep )
{
	SoftBody::Impl& impl = body.impl();
	NodeState& nodes = impl.body->nodes();
	for ( const Pin& pin : impl.pins )
	{
		btVector3 speed( 0, 0, 0 );
		if ( pin.kind == PinKind::FollowsBody )
		{
			speed = pin.body->getVelocityInLocalPoint( pin.body->getWorldTransform().getBasis() * pin.point );
		}
		if ( pin.kind == PinKind::Driven && pin.hasTarget )
		{
			speed = ( pin.point - impl.position( pin.node ) ) / ( h * btScalar( m_substepCount - substep ) );
		}
		nodes.v.set( pin.node, toVec3( speed ) );
	}
}

// After all has moved: a node that follows a body stands exactly where the body has taken it.
void SoftBodySystem::settlePins( SoftBody& body, btScalar h, int substep )
{
	SoftBody::Impl& impl = body.impl();
	NodeState& nodes = impl.body->nodes();
	for ( Pin& pin : impl.pins )
	{
		if ( pin.kind == PinKind::FollowsBody )
		{
			const Vec3d target = toVec3d( pin.body->getWorldTransform() * pin.point ) - nodes.origin;
			nodes.v.set( pin.node, ( ( target - nodes.x.get( pin.node ).cast<double>() ) / double( h ) ).cast<float>() );
		}
		if ( pin.kind == PinKind::Driven && pin.hasTarget && substep + 1 == m_substepCount )
		{
			const Vec3d way = toVec3d( pin.point ) - nodes.worldPosition( pin.node );
			nodes.v.set( pin.node, ( way / double( h ) ).cast<float>() );
			pin.hasTarget = false;
		}
	}
}

} // namespace pliant
