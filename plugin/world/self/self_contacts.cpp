// Self-collision of bodies. The broadphase pairs no object with itself: these contacts are found after those of its pairs.

#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <LinearMath/btQuickprof.h>

#include <new>

namespace pliant {

void SoftBodySystem::collideWithThemselves( btScalar h )
{
	report.selfContacts = 0;
	// Contact callbacks of the game may remove any body.
	unsigned serial = 0;
	while ( SoftBody* const body = bodyAfter( serial ) )
	{
		serial = body->impl().serial;
		SelfCollision* const self = body->impl().self.get();
		if ( !self )
		{
			continue;
		}
		if ( !body->isHealthy() )
		{
			self->contacts.reset();
			continue;
		}
		if ( !self->contacts )
		{
			self->contacts = std::make_unique<PairContacts>( m_dispatcher, pool, pairScratch );
		}
		// A sleeping body keeps its contacts, as Bullet's pairs do.
		if ( moves( *body ) && isInPass( *body ) && !body->impl().rigidProxy )
		{
			BT_PROFILE( "pliant: self-collision" );
			self->contacts->processSelf( *body, self->search, double( h ) );
		}
		const SoftBody* const after = bodyAfter( serial - 1 );
		const bool exists = after == body && body->impl().self.get() == self && self->contacts;
		report.selfContacts += exists ? self->contacts->count() : 0;
	}
}

Status SoftBody::setSelfCollision( bool isOn )
{
	if ( Status status = m_impl->checkTime( "setSelfCollision" ); !status.ok() )
	{
		return status;
	}
	if ( isOn == selfCollision() )
	{
		return {};
	}
	std::unique_ptr<SelfCollision> made( isOn ? new ( std::nothrow ) SelfCollision : nullptr );
	if ( isOn && !made )
	{
		return Status{ ResultCode::OutOfMemory, "Not enough memory for self-collision." };
	}
	m_impl->self = std::move( made );
	activate();
	return {};
}

bool SoftBody::selfCollision() const
{
	return m_impl->self != nullptr;
}

} // namespace pliant
