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

void SoftBodySystem::giveFrames( const btAlignedObjectArray<btTypedConstraint*>& joints, const btContactSolverInfo& info )
{
	if ( frames.isEmpty() )
	{
		return;
	}
	for ( SoftBody* body : m_bodies )
	{
		if ( moves( *body ) && isInPass( *body ) )
		{
			IslandBlock* const alone = frames.has( *body ) && body->impl().isImplicit ? &implicitSolve().alone( *body, tasks() ) : nullptr;
			frames.measureMobility(
				*body, [alone]( const float* impulse, float* velocity ) { alone->respond( impulse, velocity ); }, tasks() );
		}
		else if ( body->isStaticOrKinematicObject() || !body->isHealthy() )
		{
			frames.hold( *body );
		}
	}
	const double h = double( info.m_timeStep );
	frames.solve( joints, h, double( info.m_erp ) );
	frames.refineJoints( joints );
	frames.give();
}

void SoftBodySystem::readFrames( btScalar h )
{
	frames.restoreIterations();
	for ( SoftBody* body : m_awake )
	{
		if ( !frames.isEmpty() && moves( *body ) )
		{
			frames.after( *body, double( h ) );
		}
	}
}

} // namespace pliant
