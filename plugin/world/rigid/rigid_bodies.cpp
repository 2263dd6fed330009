// Soft bodies in their rigid state: when they enter and leave it, and how they are moved.

#include "body/rigid_state.h"
#include "world/bodies/manifolds.h"
#include "world/bodies/soft_body_impl.h"
#include "world/detect/pair_contacts.h"
#include "world/rigid/rigid_constants.h"
#include "world/rigid/rigid_load.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <LinearMath/btQuickprof.h>

#include <algorithm>

namespace pliant {

namespace {

/// Replaces the sides of manifolds for which `replacement( side, manifold )` is not null.
template <class Replacement>
void exchangeSides( btDispatcher& dispatcher, const Replacement& replacement )
{
	forEachManifold( dispatcher, [&replacement]( btPersistentManifold& manifold ) {
		const btCollisionObject* const first = replacement( manifold.getBody0(), manifold );
		const btCollisionObject* const second = replacement( manifold.getBody1(), manifold );
		if ( first || second )
		{
			manifold.setBodies( first ? first : manifold.getBody0(), second ? second : manifold.getBody1() );
		}
	} );
}

/// The rigid body that a side of a manifold is in the solver, or null: nothing else turns.
btRigidBody* turningSide( const btCollisionObject* side )
{
	return side->isStaticOrKinematicObject() ? nullptr : btRigidBody::upcast( const_cast<btCollisionObject*>( side ) );
}

/// Hulls touch in points, material in an area. Its friction has an arm, and its pressure moves to one side before the body rolls: a crumb
/// neither spins on a corner without end nor rolls on. Only the relative rotation changes, by two torque impulses, N m s:
///
///   about the normal: at most r mu J,   across it: at most r min( 1, kRollingArm ( r_node / R )^2 ) J
///
/// r: radius of the area, J: the manifold's normal impulse, R: radius of the body's bounding sphere. The larger values of two bodies count.
void brakeRotation( btPersistentManifold& manifold )
{
	btScalar radius = 0, arm = 0;
	for ( const SoftBody* body : { ownerOfRigidProxy( manifold.getBody0() ), ownerOfRigidProxy( manifold.getBody1() ) } )
	{
		if ( body )
		{
			btVector3 centre;
			btScalar whole;
			body->impl().rigidProxy->getCollisionShape()->getBoundingSphere( centre, whole );
			const btScalar node = body->impl().shape->smallestRadius(), size = node / whole;
			radius = btMax( radius, kContactArea * node );
			arm = btMax( arm, kContactArea * node * btMin( kRollingArm * size * size, btScalar( 1 ) ) );
		}
	}
	btScalar spin = 0, roll = 0;
	btVector3 normal( 0, 0, 0 );
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		const btManifoldPoint& point = manifold.getContactPoint( k );
		const btScalar impulse = btMax( point.m_appliedImpulse, btScalar( 0 ) );
		spin += radius * point.m_combinedFriction * impulse;
		roll += arm * impulse;
		normal += impulse * point.m_normalWorldOnB;
	}
	if ( !( normal.length2() > 0 ) ) // opposite contacts, or impulses too small to square, have no axis
	{
		return;
	}
	normal /= normal.length();
	btRigidBody *const first = turningSide( manifold.getBody0() ), *const second = turningSide( manifold.getBody1() );
	const btVector3 none( 0, 0, 0 );
	const auto brake = [&]( const btVector3& axis, btScalar limit ) {
		const auto mobility = [&axis]( const btRigidBody* side ) {
			return side ? axis.dot( side->getInvInertiaTensorWorld() * axis ) : btScalar( 0 );
		};
		const btScalar both = mobility( first ) + mobility( second );
		if ( both > 0 )
		{
			const btVector3 turn = ( second ? second->getAngularVelocity() : none ) - ( first ? first->getAngularVelocity() : none );
			const btVector3 impulse = btClamped( axis.dot( turn ) / both, -limit, limit ) * axis;
			first ? first->applyTorqueImpulse( impulse ) : void();
			second ? second->applyTorqueImpulse( -impulse ) : void();
		}
	};
	brake( normal, spin );
	const btVector3 turn = ( second ? second->getAngularVelocity() : none ) - ( first ? first->getAngularVelocity() : none );
	const btVector3 across = turn - normal.dot( turn ) * normal;
	if ( !across.fuzzyZero() )
	{
		brake( across / across.length(), roll );
	}
}

/// Whether the spins of both sides are their own: a node has none, and a link's is its joint's.
bool canBrakeSpin( const btPersistentManifold& manifold )
{
	const auto isKnown = []( const btCollisionObject* side ) {
		return side->isStaticOrKinematicObject() || ( btRigidBody::upcast( side ) && !isContactProxy( side ) );
	};
	return manifold.getNumContacts() > 0 && isKnown( manifold.getBody0() ) && isKnown( manifold.getBody1() );
}

/// Whether one of the sides can move: held bodies are static in the solver.
bool canPush( const btPersistentManifold& manifold )
{
	return !manifold.getBody0()->isStaticOrKinematicObject() || !manifold.getBody1()->isStaticOrKinematicObject();
}

/// Whether both bodies of a manifold have pins. They keep the positions at which they became neighbours.
bool isBetweenPinned( const btPersistentManifold& manifold )
{
	const auto isPinned = []( const btCollisionObject* side ) {
		const SoftBody *const rigid = ownerOfRigidProxy( side ), *const owner = rigid ? rigid : ownerOfContactProxy( side );
		return owner && !owner->impl().pins.empty();
	};
	return isPinned( manifold.getBody0() ) && isPinned( manifold.getBody1() );
}

/// Calls visit( manifold, least ) for the manifolds of bodies in their rigid state. `least`: the solver sees no distance below this, m, of
/// which it corrects a fraction in a step.
template <class Visit>
void forRigidManifolds( btDispatcher& dispatcher, const btContactSolverInfo& info, Visit&& visit )
{
	const btScalar deepest = kRigidParting * info.m_timeStep / btMax( info.m_erp2, kLeastCorrection );
	forEachManifold( dispatcher, [&visit, deepest]( btPersistentManifold& manifold ) {
		if ( ownerOfRigidProxy( manifold.getBody0() ) || ownerOfRigidProxy( manifold.getBody1() ) )
		{
			visit( manifold, isBetweenPinned( manifold ) ? btScalar( 0 ) : -deepest );
		}
	} );
}

} // namespace

bool SoftBodySystem::canBeRigid( const SoftBody& body ) const
{
	const SoftBody::Impl& impl = body.impl();
	return body.material().rigidStrain > 0.0f && arePinsStill( body ) && !impl.self && !impl.hasNodeForces && impl.newCuts.empty() &&
		!body.isStaticOrKinematicObject() && impl.isHealthy && !impl.body->hasBrokenLinks() && !impl.follower &&
		( !impl.forces || impl.forces->gas.law == GasLaw::None ) && ( attachments.isEmpty() || !attachments.contain( body ) ) &&
		!frames.has( body );
}

void SoftBodySystem::deform( SoftBody& body )
{
	for ( BlockSolve& solve : m_implicit )
	{
		solve.forget( *body.impl().rigidProxy );
	}
	body.impl().becomeDeformable( body );
}

void SoftBodySystem::deformNow( SoftBody& body )
{
	if ( body.impl().rigidProxy && !body.impl().isScenery && !isBusy() )
	{
		deform( body );
		removeContacts( body );
	}
}

// Contacts that end wake both sides, as those of objects that are removed. This body stays where it is for now: objects that are awake keep
// the time for which they have been at rest, and so does the body. Those that sleep do wake: it may be about to fall.
void SoftBodySystem::removeContacts( SoftBody& body )
{
	btBroadphaseProxy* const proxy = body.getBroadphaseHandle();
	if ( !proxy )
	{
		return;
	}
	m_restStates.clear();
	const auto note = [this]( btCollisionObject& object ) {
		object.isActive() ? m_restStates.push_back( RestState{ &object, object.getActivationState(), object.getDeactivationTime() } )
						  : void();
	};
	note( body );
	forEachManifold( m_dispatcher, [&]( const btPersistentManifold& manifold ) {
		btCollisionObject &first = ownerOf( *manifold.getBody0() ), &second = ownerOf( *manifold.getBody1() );
		&first == &body ? note( second ) : &second == &body ? note( first ) : void();
	} );
	m_world.getPairCache()->cleanProxyFromPairs( proxy, &m_dispatcher );
	m_world.updateSingleAabb( &body );
	for ( const RestState& rest : m_restStates )
	{
		rest.object->forceActivationState( rest.activation );
		rest.object->setDeactivationTime( rest.time );
	}
}

// At the start of a game step.
void SoftBodySystem::deformLoaded( btScalar gameStep )
{
	const bool isAny = std::any_of(
		m_bodies.begin(), m_bodies.end(), []( const SoftBody* body ) { return body->impl().rigidProxy != nullptr; } );
	if ( !isAny )
	{
		return;
	}
	BT_PROFILE( "pliant: rigid states" );
	forecastImpacts( gameStep );
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		if ( impl.rigidProxy && !impl.isScenery &&
			( impl.mustDeform || !canBeRigid( *body ) || hasLoadChanged( *body, gravityOf( *body ) ) ) )
		{
			deform( *body );
			removeContacts( *body );
			body->isActive() ? void() : body->activate();
		}
	}
}

void SoftBodySystem::leaveScenery( SoftBody& body )
{
	body.impl().isScenery = false;
	body.impl().asleepTime = 0.0;
	body.impl().followRigidState( body );
	removeContacts( body );
	body.activate();
}

double SoftBodySystem::loadOn( const SoftBody& body ) const
{
	double impulse = 0.0;
	forEachManifold( m_dispatcher, [&]( const btPersistentManifold& manifold ) {
		const bool isOn = ownerOfContactProxy( manifold.getBody0() ) == &body || ownerOfContactProxy( manifold.getBody1() ) == &body;
		impulse += isOn ? impulseOf( manifold ) : 0.0;
	} );
	return impulse / double( m_gameStep );
}

// At the end of a game step.
void SoftBodySystem::makeRigid( btScalar gameStep )
{
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		if ( impl.rigidProxy )
		{
			RigidLoad& load = impl.rigidLoad;
			load.now = body->isActive() ? load.impulse / double( gameStep ) : load.now;
			load.first = load.first < 0.0 ? load.now : load.first;
			const double newPart = impl.restTime > kLoadRest ? std::min( double( gameStep ) / kMeanLoadTime, 1.0 ) : 1.0;
			load.mean += newPart * ( load.now - load.mean );
			load.impulse = 0.0;
			impl.rigidWait -= impl.rigidWait <= 0 && impl.rigidWait > -kBrieflyRigid ? 1 : 0;
			continue;
		}
		if ( body->material().rigidStrain <= 0.0f || !moves( *body ) || --impl.rigidWait > 0 )
		{
			continue;
		}
		impl.rigidWait = impactsPass( *body, double( gameStep ) ) ? 1 : kRigidRetry;
		const double restTime = impl.pins.empty() ? impl.restTime : double( body->getDeactivationTime() );
		if ( canBeRigid( *body ) && impl.body->canBecomeRigid( restTime > kBentRest ) )
		{
			becomeRigid( *body );
		}
	}
}

void SoftBodySystem::becomeRigid( SoftBody& body )
{
	SoftBody::Impl& impl = body.impl();
	const double load = loadOn( body );
	impl.rigidLoad = RigidLoad{ 0.0, load, load, impl.pins.empty() ? load : -1.0, accelerationOn( body, gravityOf( body ) ) };
	impl.becomeRigid( body );
	removeContacts( body );
}

void SoftBodySystem::stiffen( SoftBody& body )
{
	if ( body.material().rigidStrain > 0.0f && impactsPass( body, double( m_gameStep ) ) && canBeRigid( body ) &&
		body.impl().body->canBecomeRigid( false ) )
	{
		becomeRigid( body );
	}
}

// v += h ( g + f / m )
void SoftBodySystem::accelerateRigid( btScalar h )
{
	const ForceFields::Acting acting( fields );
	for ( SoftBody* body : m_rigid )
	{
		SoftBody::Impl& impl = body->impl();
		impl.isImplicit = false;
		impl.lastSubstep = double( h );
		impl.body->restLinks( float( h ) );
		impl.gravityShare = 1.0; // Bullet moves it
		fields.push( *body, gravityOf( *body ), double( h ) );
		if ( !impl.body->rigidState()->isHeld )
		{
			impl.body->applyRigidForces( float( h ), ownAcceleration( *body ).cast<double>() );
		}
	}
}

// Bullet's solver moves the proxies instead of the soft bodies.
void SoftBodySystem::showRigidProxies( btDispatcher& dispatcher )
{
	m_hasRigidProxies = false;
	for ( SoftBody* body : m_bodies )
	{
		if ( body->impl().rigidProxy )
		{
			m_hasRigidProxies = true;
			body->impl().rigidProxy->follow();
		}
	}
	if ( m_hasRigidProxies )
	{
		exchangeSides( dispatcher, []( const btCollisionObject* side, const btPersistentManifold& ) {
			SoftBody* const soft = asSoftBody( const_cast<btCollisionObject*>( side ) );
			return soft ? static_cast<const btCollisionObject*>( soft->impl().rigidProxy.get() ) : nullptr;
		} );
		// A hull finds one contact a step: a body on one that loses the others falls onto its other side, and so through the floor.
		const btContactSolverInfo& info = m_world.getSolverInfo();
		const btScalar lasting = kLastingFall * m_world.getGravity().length() * info.m_timeStep * info.m_timeStep;
		forRigidManifolds( dispatcher, info, [lasting]( btPersistentManifold& manifold, btScalar least ) {
			manifold.setContactBreakingThreshold( btMax( manifold.getContactBreakingThreshold(), lasting ) );
			for ( int k = 0; k < manifold.getNumContacts(); ++k )
			{
				btManifoldPoint& point = manifold.getContactPoint( k );
				point.m_distance1 = btMax( point.m_distance1, least );
			}
		} );
	}
}

// A body that turns by more than a fraction of a turn in a step meets the floor with another side than its contacts are on, and gains
// energy from each.
void SoftBodySystem::brakeRigidProxies( btDispatcher& dispatcher )
{
	const btScalar fastest = kFarthestTurn / m_world.getSolverInfo().m_timeStep;
	const auto brake = [fastest]( const btCollisionObject* side ) {
		if ( ownerOfRigidProxy( side ) )
		{
			btRigidBody& body = *btRigidBody::upcast( const_cast<btCollisionObject*>( side ) );
			const btScalar speed = body.getAngularVelocity().length();
			body.setAngularVelocity( body.getAngularVelocity() * btMin( btScalar( 1 ), fastest / btMax( speed, fastest ) ) );
		}
	};
	forEachManifold( dispatcher, [&brake]( btPersistentManifold& manifold ) {
		const SoftBody *const first = ownerOfRigidProxy( manifold.getBody0() ), *const second = ownerOfRigidProxy( manifold.getBody1() );
		if ( !first && !second )
		{
			return;
		}
		if ( canBrakeSpin( manifold ) )
		{
			brakeRotation( manifold );
		}
		if ( impulseOf( manifold ) > 0.0 )
		{
			brake( manifold.getBody0() );
			brake( manifold.getBody1() );
		}
	} );
}

void SoftBodySystem::hideRigidProxies( btDispatcher& dispatcher )
{
	if ( !m_hasRigidProxies )
	{
		return;
	}
	forRigidManifolds( dispatcher, m_world.getSolverInfo(), []( btPersistentManifold& manifold, btScalar least ) {
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			btManifoldPoint& point = manifold.getContactPoint( k );
			const bool isRaised = point.m_distance1 == least;
			point.m_distance1 = isRaised ? ( point.m_positionWorldOnA - point.m_positionWorldOnB ).dot( point.m_normalWorldOnB )
										 : point.m_distance1;
		}
	} );
	brakeRigidProxies( dispatcher );
	exchangeSides( dispatcher, []( const btCollisionObject* side, const btPersistentManifold& manifold ) {
		SoftBody* const owner = ownerOfRigidProxy( side );
		if ( owner )
		{
			owner->impl().rigidLoad.impulse += canPush( manifold ) ? impulseOf( manifold ) : 0.0;
		}
		return static_cast<const btCollisionObject*>( owner );
	} );
	for ( SoftBody* body : m_bodies ) // bodies of the other pass may have been touched too
	{
		if ( const RigidProxy* const rigidProxy = body->impl().rigidProxy.get(); rigidProxy && body->isActive() )
		{
			body->impl().body->setRigidVelocities(
				toVec3d( rigidProxy->getLinearVelocity() ), toVec3d( rigidProxy->getAngularVelocity() ) );
		}
	}
}

void SoftBodySystem::integrateRigid( btScalar h )
{
	for ( SoftBody* body : m_rigid )
	{
		SoftBody::Impl& impl = body->impl();
		const RigidState& state = *impl.body->rigidState();
		if ( !moves( *body ) || state.isHeld )
		{
			continue; // fell asleep in this substep, or is held
		}
		impl.body->moveAsRigid( advanced( state, impl.rigidProxy->pushed( state.motion ), double( h ) ) );
		impl.placeRigid( *body );
		impl.skin.nodesMoved();
	}
}

} // namespace pliant
