// Nodes that forces do not move: pinned in place, tied to a rigid body, driven by the game, and those of static and kinematic bodies.

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
	for ( ImplicitSolve& solve : m_implicit )
	{
		solve.forget( body );
	}
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
			speed = ( pin.point - impl.position( pin.node ) ) / ( h * btScalar( substepsOf( body ) - substep ) );
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
		if ( pin.kind == PinKind::Driven && pin.hasTarget && substep + 1 == substepsOf( body ) )
		{
			const Vec3d way = toVec3d( pin.point ) - nodes.worldPosition( pin.node );
			nodes.v.set( pin.node, ( way / double( h ) ).cast<float>() );
			pin.hasTarget = false;
		}
	}
}

// A kinematic body stands where the game has put it, by `teleport` or by its pins, and moves at what took it there; a static one stands.
void SoftBodySystem::moveHeldBodies()
{
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		if ( !body->isStaticOrKinematicObject() )
		{
			impl.heldBefore.clear();
			continue;
		}
		NodeState& nodes = impl.body->nodes();
		const std::size_t count = std::size_t( nodes.count );
		bool isDriven = false;
		for ( Pin& pin : impl.pins )
		{
			const bool follows = pin.kind == PinKind::FollowsBody;
			if ( follows || ( pin.kind == PinKind::Driven && pin.hasTarget ) )
			{
				const btVector3 target = follows ? pin.body->getWorldTransform() * pin.point : pin.point;
				nodes.x.set( pin.node, ( toVec3d( target ) - nodes.origin ).cast<float>() );
				pin.hasTarget = false;
				isDriven = true;
			}
		}
		const bool isKnown = body->isKinematicObject() && impl.heldBefore.size() == count && m_gameStep > 0;
		impl.heldBefore.resize( count, Vec3d::Zero() );
		Vec3d low = Vec3d::Zero(), high = Vec3d::Zero();
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3d at = nodes.worldPosition( i );
			const Vec3d velocity = isKnown ? Vec3d( ( at - impl.heldBefore[std::size_t( i )] ) / double( m_gameStep ) ) : Vec3d( Vec3d::Zero() );
			nodes.v.set( i, velocity.cast<float>() );
			impl.heldBefore[std::size_t( i )] = at;
			low = low.cwiseMin( velocity );
			high = high.cwiseMax( velocity );
		}
		impl.shape->setSweep( m_gameStep * toBt( low ), m_gameStep * toBt( high ) );
		if ( isDriven )
		{
			impl.skin.nodesMoved();
			impl.placeShape( *body );
		}
	}
}

} // namespace pliant
