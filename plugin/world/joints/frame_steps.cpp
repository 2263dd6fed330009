// Frames and poses in a pass.

#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

namespace pliant {

void SoftBodySystem::placeFrames()
{
	for ( SoftBody* body : m_bodies )
	{
		if ( !frames.isEmpty() && ( body->isActive() || body->isStaticOrKinematicObject() ) && isInPass( *body ) )
		{
			frames.place( *body );
		}
	}
}

void SoftBodySystem::drawToPose( SoftBody& body, btScalar h )
{
	SoftBody::Impl& impl = body.impl();
	if ( impl.follower && impl.body->pull().isOn() )
	{
		impl.body->applyPull();
		impl.follower->sum( *impl.body, double( h ) );
	}
}

void SoftBodySystem::pressFrames( bool isOn )
{
	for ( SoftBody* body : m_awake )
	{
		if ( !frames.isEmpty() )
		{
			frames.press( *body, isOn );
		}
	}
}

void SoftBodySystem::giveFrames( btScalar h )
{
	for ( SoftBody* body : m_bodies )
	{
		if ( !frames.isEmpty() && moves( *body ) && isInPass( *body ) )
		{
			frames.before( *body, double( h ), tasks() );
		}
		else if ( !frames.isEmpty() && ( body->isStaticOrKinematicObject() || !body->isHealthy() ) )
		{
			frames.hold( *body );
		}
	}
}

void SoftBodySystem::readFrames( btScalar h )
{
	for ( SoftBody* body : m_awake )
	{
		if ( !frames.isEmpty() && moves( *body ) )
		{
			frames.after( *body, double( h ) );
		}
	}
}

} // namespace pliant
