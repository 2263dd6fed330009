// When soft bodies fall asleep and what wakes them, by Bullet's own clock.

#include "world/constants.h"
#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"

#include <algorithm>

namespace pliant {

namespace {

bool isDriven( const SoftBody& body )
{
	const std::vector<Pin>& pins = body.impl().pins;
	return std::any_of( pins.begin(), pins.end(),
		[]( const Pin& pin ) { return pin.hasTarget || ( pin.kind == PinKind::FollowsBody && pin.body->isActive() ); } );
}

} // namespace

void SoftBodySystem::wakeDriven()
{
	for ( SoftBody* body : m_bodies )
	{
		if ( !body->isActive() && isDriven( *body ) )
		{
			body->activate();
		}
	}
}

void SoftBodySystem::updateActivation( btScalar h )
{
	for ( SoftBody* body : m_bodies )
	{
		const int state = body->getActivationState();
		if ( state == ISLAND_SLEEPING || state == DISABLE_SIMULATION || !isInPass( *body ) || body->isStaticOrKinematicObject() )
		{
			continue;
		}
		SoftBody::Impl& impl = body->impl();
		const double calm = kBornCalm * double( impl.shape->smallestRadius() );
		impl.slowFor = impl.meanSquareSpeed < calm * calm ? impl.slowFor + double( h ) : 0.0;
		const bool isSlow = impl.meanSquareSpeed < double( kSleepSpeed ) * double( kSleepSpeed );
		const bool maySleep = isSlow && !isDriven( *body ) && state != DISABLE_DEACTIVATION && !gDisableDeactivation && gDeactivationTime > 0;
		body->setDeactivationTime( maySleep ? body->getDeactivationTime() + h : btScalar( 0 ) );
		if ( state != DISABLE_DEACTIVATION )
		{
			body->setActivationState( maySleep && body->getDeactivationTime() > gDeactivationTime ? WANTS_DEACTIVATION : ACTIVE_TAG );
		}
	}
}

} // namespace pliant
