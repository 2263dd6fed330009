// When soft bodies fall asleep and what wakes them, by Bullet's own clock.
//
// What is slow is measured by the body's size and its gravity: v^2 against 2 g r, r the radius of its smallest node. Contacts that a solver
// of few iterations leaves a little off push what lies still to and fro, a heap of single cells most of all, and one of two hundred is
// always faster than a limit that is to tell moving from lying: so what is not quite as slow may sleep too, as long as none of its nodes
// goes anywhere.

#include "matching/step/lattice_matcher.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"

#include <algorithm>

namespace pliant {

namespace {

bool isDriven( const SoftBody& body )
{
	const std::vector<Pin>& pins = body.impl().pins;
	return std::any_of( pins.begin(), pins.end(),
		[]( const Pin& pin ) { return pin.hasTarget || ( pin.kind == PinKind::FollowsBody && pin.body->isActive() ); } );
}

/// Whether no node is further than `way` from where it was when this was last not so, or when the body began to be looked at. If one is:
/// from now on, from here.
bool hasStayed( SoftBody::Impl& impl, double way )
{
	const NodeState& nodes = impl.body->nodes();
	RestPosition& rest = impl.rest;
	const Vec3 shift = ( nodes.origin - rest.origin ).cast<float>();
	const float limit = float( way * way );
	bool isThere = rest.place.size() == std::size_t( nodes.count ) && rest.numbering == impl.numbering;
	for ( int i = 0; isThere && i < nodes.count; ++i )
	{
		isThere = ( nodes.x.get( i ) + shift - rest.place[std::size_t( i )] ).squaredNorm() <= limit;
	}
	if ( isThere )
	{
		return true;
	}
	rest.place.resize( std::size_t( nodes.count ) );
	for ( int i = 0; i < nodes.count; ++i )
	{
		rest.place[std::size_t( i )] = nodes.x.get( i );
	}
	rest.origin = nodes.origin;
	rest.numbering = impl.numbering;
	return false;
}

/// Mean over the mass of | v |^2, m^2/s^2; of a body in several parts that nothing links, that of the fastest: one that falls among a
/// thousand that lie is not at rest.
double squareVelocity( const SoftBody::Impl& impl )
{
	if ( impl.body->material().method != Method::Lattice )
	{
		return impl.meanSquareSpeed;
	}
	const ConnectedParts& parts = static_cast<const LatticeMatcher&>( impl.body->matcher() ).parts();
	const NodeState& nodes = impl.body->nodes();
	if ( !parts.areSeveral() || parts.of.size() != std::size_t( nodes.count ) )
	{
		return impl.meanSquareSpeed;
	}
	double fastest = 0.0;
	for ( int p = 0; p < parts.count(); ++p )
	{
		double mass = 0.0, square = 0.0;
		parts.forNodes( p, nodes.count, [&]( int i ) {
			mass += double( nodes.mass[i] );
			square += double( nodes.mass[i] ) * nodes.v.get( i ).cast<double>().squaredNorm();
		} );
		fastest = std::max( fastest, square / mass );
	}
	return fastest;
}

/// Whether the body as it moves now may be on its way to sleep.
bool isAtRest( SoftBody::Impl& impl, double gravity )
{
	const double radius = double( impl.shape->smallestRadius() ), way = kRestDisplacement * radius;
	const double fallen = 2.0 * gravity * radius, square = squareVelocity( impl );
	const double drift = way / double( gDeactivationTime ); // where there is no gravity
	const bool mayStay = square < std::max( fallen * double( kContactSlop ), drift * drift );
	if ( !mayStay )
	{
		impl.rest.place.clear();
		return false;
	}
	const bool stays = hasStayed( impl, way );
	return stays || square < fallen * kSleepFraction * kSleepFraction;
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
		const double calm = kAllowanceCalm * double( impl.shape->smallestRadius() );
		impl.slowFor = impl.meanSquareSpeed < calm * calm ? impl.slowFor + double( h ) : 0.0;
		const bool canSleep = state != DISABLE_DEACTIVATION && !gDisableDeactivation && gDeactivationTime > 0;
		const btVector3 gravity = impl.hasOwnGravity ? impl.gravity : m_world.getGravity();
		const bool maySleep = canSleep && isAtRest( impl, double( gravity.length() ) ) && !isDriven( *body );
		body->setDeactivationTime( maySleep ? body->getDeactivationTime() + h : btScalar( 0 ) );
		if ( state != DISABLE_DEACTIVATION )
		{
			body->setActivationState( maySleep && body->getDeactivationTime() > gDeactivationTime ? WANTS_DEACTIVATION : ACTIVE_TAG );
		}
	}
}

} // namespace pliant
