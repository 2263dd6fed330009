// Frames and poses in a pass.

#include "world/bodies/manifolds.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>
#include <vector>

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
	frames.begin( joints );
	for ( SoftBody* body : m_bodies )
	{
		if ( !frames.has( *body ) )
		{
			continue;
		}
		if ( moves( *body ) && isInPass( *body ) )
		{
			IslandBlock* const block = body->impl().isImplicit ? &implicitSolve().responseBlock( *body, tasks() ) : nullptr;
			frames.measureMobility(
				*body, [block]( const float* impulse, float* velocity ) { block->respond( impulse, velocity, kResponseFraction ); },
				tasks() );
		}
		else if ( body->isStaticOrKinematicObject() || !body->isHealthy() )
		{
			frames.hold( *body );
		}
	}
	std::vector<unsigned char> touches;
	forEachManifold( *m_world.getDispatcher(), [&touches]( const btPersistentManifold& manifold ) {
		bool isTouch = false;
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			isTouch = isTouch || manifold.getContactPoint( k ).getDistance() <= 0;
		}
		for ( const btCollisionObject* const object : { manifold.getBody0(), manifold.getBody1() } )
		{
			if ( isTouch && object->getWorldArrayIndex() >= 0 && object->hasContactResponse() )
			{
				const std::size_t index = std::size_t( object->getWorldArrayIndex() );
				touches.resize( std::max( touches.size(), index + 1 ) );
				touches[index] = 1;
			}
		}
	} );
	frames.solve( joints, touches, info );
	frames.raiseIterations( joints, info );
	frames.give();
}

void SoftBodySystem::readFrames( const btAlignedObjectArray<btTypedConstraint*>& joints, btScalar h )
{
	frames.restoreIterations( joints );
	for ( SoftBody* body : m_awake )
	{
		if ( !frames.isEmpty() && moves( *body ) )
		{
			frames.after( *body, double( h ) );
		}
	}
}

} // namespace pliant
