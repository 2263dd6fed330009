// Deactivation and wake-up of soft bodies, with Bullet's timers.
//
// Velocities are compared with the body's size and gravity: v^2 with 2 g r, r the radius of its smallest node. The residual errors of a
// solver with few iterations push resting bodies to and fro, most of all in heaps of single cells: one of two hundred is always faster than
// any limit that separates moving from resting. A somewhat faster body may therefore sleep too if none of its nodes leaves its position.

#include "body/rigid_state.h"
#include "matching/step/lattice_matcher.h"
#include "world/bodies/manifolds.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"

#include <algorithm>

namespace pliant {

namespace {

bool isDriven( const SoftBody& body )
{
	if ( body.impl().follower && body.impl().follower->isMoving && body.impl().follower->blend > 0.0 )
	{
		return true;
	}
	const std::vector<Pin>& pins = body.impl().pins;
	return std::any_of( pins.begin(), pins.end(),
		[]( const Pin& pin ) { return pin.hasTarget || ( pin.kind == PinKind::FollowsBody && pin.body->isActive() ); } );
}

/// Returns true if no node is further than `displacement` from its reference position. Otherwise makes the current positions the reference.
bool hasStayed( SoftBody::Impl& impl, double displacement )
{
	const NodeState& nodes = impl.body->nodes();
	RestPositions& rest = impl.rest;
	const Vec3 shift = ( nodes.origin - rest.origin ).cast<float>();
	const float limit = float( displacement * displacement );
	bool areNear = rest.positions.size() == std::size_t( nodes.count ) && rest.numbering == impl.numbering;
	for ( int i = 0; areNear && i < nodes.count; ++i )
	{
		areNear = ( nodes.x.get( i ) + shift - rest.positions[std::size_t( i )] ).squaredNorm() <= limit;
	}
	if ( areNear )
	{
		return true;
	}
	rest.positions.resize( std::size_t( nodes.count ) );
	for ( int i = 0; i < nodes.count; ++i )
	{
		rest.positions[std::size_t( i )] = nodes.x.get( i );
	}
	rest.origin = nodes.origin;
	rest.numbering = impl.numbering;
	return false;
}

/// The same for a body in its rigid state, of three points on it at the distance `reach` from its centre of mass.
bool hasStayed( SoftBody::Impl& impl, const RigidMotion& motion, double reach, double displacement )
{
	RestPositions& rest = impl.rest;
	const Eigen::Matrix3d axes = reach * motion.rotation.toRotationMatrix();
	bool areNear = rest.positions.size() == 3 && rest.numbering == impl.numbering;
	for ( int k = 0; areNear && k < 3; ++k )
	{
		const Vec3d away = motion.centre - rest.origin + axes.col( k ) - rest.positions[std::size_t( k )].cast<double>();
		areNear = away.squaredNorm() <= displacement * displacement;
	}
	if ( !areNear )
	{
		rest.positions.resize( 3 );
		for ( int k = 0; k < 3; ++k )
		{
			rest.positions[std::size_t( k )] = axes.col( k ).cast<float>();
		}
		rest.origin = motion.centre;
		rest.numbering = impl.numbering;
	}
	return areNear;
}

/// Returns the mass-weighted mean of | v |^2, m^2/s^2; for a body of several connected parts that of the fastest part, since one that falls
/// among a thousand at rest is not at rest.
double largestMeanSquareSpeed( const SoftBody::Impl& impl )
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

/// Whether a body in its rigid state moves by no more than one that slips or tips in a heap: no point is faster than Bullet's threshold.
/// What flies, or has been hit, is faster.
bool isNearlySlow( const SoftBody& body )
{
	const RigidProxy& proxy = *body.impl().rigidProxy;
	const RigidMotion& motion = body.impl().body->rigidState()->motion;
	btVector3 centre;
	btScalar radius;
	proxy.getCollisionShape()->getBoundingSphere( centre, radius );
	const double fastest = double( proxy.getLinearSleepingThreshold() );
	return motion.velocity.norm() < fastest && double( radius ) * motion.angularVelocity.norm() < fastest;
}

/// Returns the time for which a body has been at rest, s. Small motions do not end that of bodies in their rigid state, but use it up at
/// kRestLoss times the rate: in a heap one of them slips or tips by a millimetre at any time, and all would have to lie still at once.
/// `mayForget`: else every motion ends it. `gravity`: m/s^2.
btScalar timeAtRest( const SoftBody& body, btScalar h, bool rests, bool mayForget, btScalar gravity )
{
	btScalar before = body.getDeactivationTime();
	if ( !body.impl().rigidProxy )
	{
		return rests ? before + h : btScalar( 0 );
	}
	// Bullet sets WANTS_DEACTIVATION and a time of 0 when it wakes a sleeping island; activate() sets ACTIVE_TAG instead.
	if ( before == 0 && body.getActivationState() == WANTS_DEACTIVATION )
	{
		// A body whose support has gone is fast within v / g.
		const btScalar falls = kWokenFalls * body.impl().rigidProxy->getLinearSleepingThreshold() / btMax( gravity, SIMD_EPSILON );
		before = btMax( btScalar( 0 ), gDeactivationTime - btMax( kWokenRest, falls ) );
	}
	if ( rests )
	{
		return btMin( before + h, gDeactivationTime + kMostRest );
	}
	return mayForget && isNearlySlow( body ) ? btMax( before - kRestLoss * h, btScalar( 0 ) ) : btScalar( 0 );
}

/// Returns true if the body's deactivation timer may run.
bool isAtRest( SoftBody::Impl& impl, double gravity )
{
	// As Bullet's rigid bodies, but small bodies may rotate faster, and bodies that stay may be pushed: a shard in a heap loses one of
	// Bullet's contacts and is hit by the next every few seconds.
	if ( impl.rigidProxy )
	{
		const RigidMotion& motion = impl.body->rigidState()->motion;
		btVector3 centre;
		btScalar radius;
		impl.rigidProxy->getCollisionShape()->getBoundingSphere( centre, radius );
		const double turn = std::max( double( impl.rigidProxy->getAngularSleepingThreshold() ), kSleepTurn / double( radius ) );
		const bool isSlow = motion.velocity.norm() < double( impl.rigidProxy->getLinearSleepingThreshold() ) &&
			motion.angularVelocity.norm() < turn;
		const double displacement = kHeldDisplacement * double( impl.shape->smallestRadius() );
		return hasStayed( impl, motion, double( radius ), displacement ) || isSlow;
	}
	const bool isHeld = !impl.pins.empty() && impl.body->material().rigidStrain > 0.0f; // a pinned body does not drift
	const double radius = double( impl.shape->smallestRadius() );
	const double displacement = ( isHeld ? kHeldDisplacement : kRestDisplacement ) * radius;
	const double fallSquare = 2.0 * gravity * radius, square = largestMeanSquareSpeed( impl );
	const double drift = displacement / double( gDeactivationTime ); // limit without gravity
	const bool mayStay = isHeld || square < std::max( fallSquare * double( kContactSlop ), drift * drift );
	if ( !mayStay )
	{
		impl.rest.positions.clear();
		return false;
	}
	const bool stays = hasStayed( impl, displacement );
	return stays || square < fallSquare * kSleepFraction * kSleepFraction;
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
	for ( Frame& frame : frames.all() ) // the game has woken it, for example to start a motor
	{
		if ( frame.body && frame.rigid->isActive() && !frame.body->isActive() )
		{
			frame.body->activate();
		}
	}
}

void SoftBodySystem::wakeUnsupported()
{
	for ( SoftBody* body : m_bodies )
	{
		const SoftBody::Impl& impl = body->impl();
		// Contacts of a rigid proxy are Bullet's, and `touched` lists nodes.
		if ( body->getActivationState() == WANTS_DEACTIVATION && impl.wasTouched && impl.touched.empty() && !impl.rigidProxy )
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
		impl.wasTouched = !impl.touched.empty();
		const double calm = kAllowanceCalm * double( impl.shape->smallestRadius() );
		impl.slowTime = impl.meanSquareSpeed < calm * calm ? impl.slowTime + double( h ) : 0.0;
		const bool canSleep = state != DISABLE_DEACTIVATION && !gDisableDeactivation && gDeactivationTime > 0;
		const btVector3 gravity = gravityOf( *body ) + impl.fieldAcceleration;
		const double fallSquare = 2.0 * double( gravity.length() * impl.shape->largestRadius() );
		impl.restTime = impl.meanSquareSpeed < fallSquare ? impl.restTime + double( h ) : 0.0;
		const bool maySleep = canSleep && isAtRest( impl, double( gravity.length() ) ) && !isDriven( *body );
		body->setDeactivationTime( timeAtRest( *body, h, maySleep, canSleep && !isDriven( *body ), gravity.length() ) );
		if ( state != DISABLE_DEACTIVATION )
		{
			body->setActivationState( maySleep && body->getDeactivationTime() > gDeactivationTime ? WANTS_DEACTIVATION : ACTIVE_TAG );
		}
	}
}

/// Wakes a body after its forces of this pass.
void SoftBodySystem::wakeLate( SoftBody& body )
{
	body.activate();
	body.impl().isHit = true;
	body.impl().isImplicit = false; // its forces start with the next substep
	body.impl().body->joinAtRest();
}

// Bullet's islands would wake them while they are solved. They would then have no equations in this pass, and the impulses that their
// contact proxies receive would be lost. What sleeps in contact with them wakes too.
bool SoftBodySystem::wakeHit()
{
	bool isAny = false;
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		impl.isHit = impl.isHit && body->getActivationState() == ISLAND_SLEEPING && !impl.rigidProxy &&
			!body->isStaticOrKinematicObject() && isInPass( *body );
		impl.isHit ? wakeLate( *body ) : void();
		isAny = isAny || impl.isHit;
	}
	if ( !isAny )
	{
		return false;
	}
	for ( bool isChanged = true; isChanged; )
	{
		isChanged = false;
		forEachManifold( m_dispatcher, [&]( btPersistentManifold& manifold ) {
			SoftBody* const soft[2] = { ownerOfContactProxy( manifold.getBody0() ), ownerOfContactProxy( manifold.getBody1() ) };
			for ( int k = 0; manifold.getNumContacts() > 0 && soft[0] && soft[1] && k < 2; ++k )
			{
				SoftBody& other = *soft[1 - k];
				const bool canWake = !other.isStaticOrKinematicObject() && other.getActivationState() == ISLAND_SLEEPING;
				if ( soft[k]->impl().isHit && canWake && isInPass( other ) )
				{
					wakeLate( other );
					isChanged = true;
				}
			}
		} );
	}
	for ( SoftBody* body : m_bodies )
	{
		body->impl().isHit = false;
	}
	gatherAwake();
	return true;
}

void SoftBodySystem::wakeTouched()
{
	for ( SoftBody* body : m_bodies )
	{
		const std::vector<ContactProxy*>& touched = body->impl().touched;
		bool wakes = false;
		for ( ContactProxy* const proxy : touched )
		{
			wakes = wakes || ( proxy->wasAsleep && proxy->isActive() );
			if ( !body->isActive() )
			{
				proxy->forceActivationState( body->getActivationState() );
				proxy->wasAsleep = true;
			}
		}
		if ( wakes )
		{
			body->activate();
		}
	}
}

} // namespace pliant
