#include "world/respond/stiff_bounce.h"

#include "matching/step/lattice_matcher.h"
#include "world/bodies/soft_body_impl.h"
#include "world/respond/constants.h"
#include "world/shape/rigid_motion_proxy.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Bodies that break or flow need the strain of their impacts; held ones and those in several parts have no rigid motion.
bool isTooSoft( const SoftBody& body )
{
	const SoftBody::Impl& impl = body.impl();
	const Material& material = body.material();
	return !impl.plan.reachable && impl.plan.reachedModulus < kRestitutionReach * material.youngsModulus && !impl.isImplicit &&
		impl.block < 0 && body.isActive() && body.isHealthy() && body.hasContactResponse() && material.method == Method::Lattice &&
		material.yieldStrain == 0.0f && impl.body->fracture().rule == BreakRule::Never &&
		!static_cast<const LatticeMatcher&>( impl.body->matcher() ).parts().areSeveral();
}

const ContactProxy* proxyOf( const btCollisionObject* object )
{
	return ownerOfContactProxy( object ) ? static_cast<const ContactProxy*>( object ) : nullptr;
}

/// The rigid body on the other side; null: one that nothing moves.
btRigidBody* rigidOf( const btPersistentManifold& manifold )
{
	const btCollisionObject* const other = proxyOf( manifold.getBody0() ) ? manifold.getBody1() : manifold.getBody0();
	return const_cast<btRigidBody*>( btRigidBody::upcast( other ) );
}

const ContactProxy& nodeOf( const btPersistentManifold& manifold )
{
	const ContactProxy* const first = proxyOf( manifold.getBody0() );
	return first ? *first : *proxyOf( manifold.getBody1() );
}

/// The position at which a contact acts on both sides, relative to the rigid body's centre of mass.
btVector3 armOf( const btRigidBody& rigid, const ContactProxy& node )
{
	return node.owner->impl().position( node.node ) - rigid.getCenterOfMassPosition();
}

} // namespace

/// The rigid motion of a body, and its change by the normal impulses of its contacts.
struct StiffBounce::RigidMotion
{
	double mass = 0.0;
	Eigen::Matrix3d inverseInertia = Eigen::Matrix3d::Zero();
	Vec3d velocity = Vec3d::Zero(), turn = Vec3d::Zero();
	Vec3d change = Vec3d::Zero(), turnChange = Vec3d::Zero();

	Vec3d at( const Vec3d& arm ) const { return velocity + turn.cross( arm ); }
	Vec3d changeAt( const Vec3d& arm ) const { return change + turnChange.cross( arm ); }
};

void StiffBounce::note( btDispatcher& dispatcher, const std::vector<SoftBody*>& bodies )
{
	m_contacts.clear();
	if ( std::none_of( bodies.begin(), bodies.end(), []( const SoftBody* body ) { return isTooSoft( *body ); } ) )
	{
		return;
	}
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		const btCollisionObject &a = *manifold.getBody0(), &b = *manifold.getBody1();
		const ContactProxy *const first = proxyOf( &a ), *const second = proxyOf( &b );
		if ( !first == !second || !isTooSoft( *( first ? first : second )->owner ) )
		{
			continue; // two soft bodies rebound by their elasticity
		}
		const btCollisionObject& other = first ? b : a;
		if ( ( !btRigidBody::upcast( &other ) && !other.isStaticOrKinematicObject() ) || !other.hasContactResponse() )
		{
			continue;
		}
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			const btManifoldPoint& point = manifold.getContactPoint( k );
			// A node's restitution acts once per touch, a body's until it separates.
			const btScalar restitution = point.m_appliedImpulse > 0 ? gCalculateCombinedRestitutionCallback( &a, &b )
																	: point.m_combinedRestitution;
			m_contacts.push_back( Contact{ &manifold, k, ( first ? first : second )->owner, double( restitution ) } );
		}
	}
}

void StiffBounce::apply( const btContactSolverInfo& info )
{
	for ( std::size_t k = 0; k < m_contacts.size(); ++k )
	{
		SoftBody& body = *m_contacts[k].body;
		const auto isOf = [&]( const Contact& contact ) { return contact.body == &body; };
		if ( std::none_of( m_contacts.begin(), m_contacts.begin() + std::ptrdiff_t( k ), isOf ) )
		{
			bounce( body, double( info.m_restitutionVelocityThreshold ) );
		}
	}
}

/// Sets velocities and responses of the pressing contacts.
void StiffBounce::measure( const RigidMotion& motion )
{
	for ( Contact* const contact : m_pressing )
	{
		contact->velocity = contact->normal.dot( motion.at( contact->arm ) );
		contact->response = contact->normal.dot( motion.changeAt( contact->arm ) );
		btRigidBody* const rigid = rigidOf( *contact->manifold );
		if ( !rigid )
		{
			continue;
		}
		const btVector3 own = armOf( *rigid, nodeOf( *contact->manifold ) );
		contact->velocity -= contact->normal.dot( toVec3d( rigid->getVelocityInLocalPoint( own ) ) );
		for ( const Contact* const other : m_pressing )
		{
			if ( rigid->getInvMass() > 0 && rigidOf( *other->manifold ) == rigid )
			{
				const btVector3 impulse = toBt( other->impulse * other->normal ), at = armOf( *rigid, nodeOf( *other->manifold ) );
				const btVector3 turn = rigid->getInvInertiaTensorWorld() * at.cross( impulse );
				contact->response += contact->normal.dot( toVec3d( impulse * rigid->getInvMass() + turn.cross( own ) ) );
			}
		}
	}
}

/// Lists the body's contacts that press. Returns its rigid motion; without inertia where it is held.
StiffBounce::RigidMotion StiffBounce::listPressing( SoftBody& body )
{
	const NodeState& nodes = body.impl().body->nodes();
	const BodySums sums = body.impl().body->sums();
	const RigidMotionProxy proxy( &body );
	m_pressing.clear();
	RigidMotion motion{ sums.mass, proxy.inverseInertia, sums.momentum / sums.mass, proxy.angularVelocity, Vec3d::Zero(), Vec3d::Zero() };
	for ( Contact& contact : m_contacts )
	{
		const btManifoldPoint& point = contact.manifold->getContactPoint( contact.point );
		if ( contact.body != &body || !( point.m_appliedImpulse > 0 ) )
		{
			continue;
		}
		contact.impulse = double( point.m_appliedImpulse );
		contact.normal = ( proxyOf( contact.manifold->getBody0() ) ? 1.0 : -1.0 ) * toVec3d( point.m_normalWorldOnB );
		contact.arm = nodes.x.get( nodeOf( *contact.manifold ).node ).cast<double>() - sums.centre;
		motion.change += contact.impulse / sums.mass * contact.normal;
		motion.turnChange += motion.inverseInertia * contact.arm.cross( contact.impulse * contact.normal );
		m_pressing.push_back( &contact );
	}
	return motion;
}

// With the velocities U of the rigid motions after the solver, and R their change by the impulses P, the impulses are raised by the
// fraction s with which   sum P ( n . ( U + s R ) - e u ) = 0,   u = - n . ( U - R ) the velocity of approach before the solver.
//
// The nodes of the contacts have bounced already and do not follow, so that several rounds are needed.
void StiffBounce::bounce( SoftBody& body, double threshold )
{
	RigidMotion motion = listPressing( body );
	measure( motion );
	double press = 0.0, approach = 0.0, response = 0.0;
	for ( Contact* const contact : m_pressing )
	{
		const double before = contact->response - contact->velocity;
		contact->target = contact->restitution * before;
		press += contact->impulse;
		approach += contact->impulse * before;
		response += contact->impulse * contact->response;
	}
	if ( motion.inverseInertia.isZero( 0.0 ) || !( approach > press * threshold ) || !( response > 0.0 ) )
	{
		return;
	}
	double raised = 0.0;
	for ( int round = 0; round < kBounceRounds; ++round )
	{
		double lack = 0.0;
		for ( const Contact* const contact : m_pressing )
		{
			lack += contact->impulse * ( contact->target - contact->velocity );
		}
		if ( !( lack > kBounceError * approach ) )
		{
			break;
		}
		raise( body, motion, lack / response );
		raised += press * lack / response;
		const RigidMotionProxy proxy( &body );
		motion.velocity = body.impl().body->sums().momentum / motion.mass;
		motion.turn = proxy.angularVelocity;
		measure( motion );
	}
	rub( body, motion, raised );
}

// The nodes of the contacts have bounced already: they follow the body's rigid motion, but are not thrown off the ground into the body.
void StiffBounce::raise( SoftBody& body, const RigidMotion& motion, double fraction )
{
	NodeState& nodes = body.impl().body->nodes();
	const Vec3d centre = body.impl().body->sums().centre;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d arm = nodes.x.get( i ).cast<double>() - centre;
		nodes.v.set( i, nodes.v.get( i ) + ( fraction * motion.changeAt( arm ) ).cast<float>() );
	}
	for ( Contact* const contact : m_pressing )
	{
		const int node = nodeOf( *contact->manifold ).node;
		const Vec3d rigidVelocity = motion.at( contact->arm ) + fraction * motion.changeAt( contact->arm );
		const double excess = std::max( 0.0, contact->normal.dot( nodes.v.get( node ).cast<double>() - rigidVelocity ) );
		nodes.v.set( node, nodes.v.get( node ) - ( excess * contact->normal ).cast<float>() );
		const double impulse = fraction * contact->impulse - excess * double( nodes.mass[node] );
		contact->manifold->getContactPoint( contact->point ).m_appliedImpulse += btScalar( impulse );
		btRigidBody* const rigid = rigidOf( *contact->manifold );
		if ( rigid && rigid->getInvMass() > 0 )
		{
			rigid->applyImpulse( toBt( -impulse * contact->normal ), armOf( *rigid, nodeOf( *contact->manifold ) ) );
		}
	}
}

// The raised impulses rub too, at their centre: as far as Coulomb's limit, and not beyond the stop of the rigid motion there.
void StiffBounce::rub( SoftBody& body, const RigidMotion& motion, double impulse )
{
	Vec3d arm = Vec3d::Zero(), normal = Vec3d::Zero();
	double press = 0.0, friction = 0.0;
	const Contact* strongest = m_pressing.front();
	for ( const Contact* const contact : m_pressing )
	{
		press += contact->impulse;
		arm += contact->impulse * contact->arm;
		normal += contact->impulse * contact->normal;
		friction += contact->impulse * double( contact->manifold->getContactPoint( contact->point ).m_combinedFriction );
		strongest = contact->impulse > strongest->impulse ? contact : strongest;
	}
	arm /= press;
	normal.normalize();
	btRigidBody* const rigid = rigidOf( *strongest->manifold );
	const btVector3 other = rigid ? armOf( *rigid, nodeOf( *strongest->manifold ) ) : btVector3( 0, 0, 0 );
	const Vec3d slip = motion.at( arm ) - ( rigid ? toVec3d( rigid->getVelocityInLocalPoint( other ) ) : Vec3d( Vec3d::Zero() ) );
	const Vec3d along = slip - slip.dot( normal ) * normal;
	if ( !normal.allFinite() || along.isZero( 0.0 ) )
	{
		return;
	}
	const Vec3d direction = along.normalized();
	double response = 1.0 / motion.mass + direction.dot( ( motion.inverseInertia * arm.cross( direction ) ).cross( arm ) );
	response += rigid && rigid->getInvMass() > 0
		? double( rigid->computeImpulseDenominator( rigid->getCenterOfMassPosition() + other, toBt( direction ) ) )
		: 0.0;
	const Vec3d rubbing = -std::min( friction / press * impulse, along.norm() / response ) * direction;
	const Vec3d change = rubbing / motion.mass, turn = motion.inverseInertia * arm.cross( rubbing );
	NodeState& nodes = body.impl().body->nodes();
	const Vec3d centre = body.impl().body->sums().centre;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d own = nodes.x.get( i ).cast<double>() - centre;
		nodes.v.set( i, nodes.v.get( i ) + ( change + turn.cross( own ) ).cast<float>() );
	}
	if ( rigid && rigid->getInvMass() > 0 )
	{
		rigid->applyImpulse( toBt( -rubbing ), other );
	}
}

// The next substep of the solver starts from the impulses of this one, which moved the nodes alone.
void StiffBounce::restore()
{
	for ( const Contact& contact : m_contacts )
	{
		if ( contact.impulse > 0.0 && contact.point < contact.manifold->getNumContacts() )
		{
			contact.manifold->getContactPoint( contact.point ).m_appliedImpulse = btScalar( contact.impulse );
		}
	}
	m_contacts.clear();
}

} // namespace pliant
