// A contact's impulse P changes leapfrog's energy by exactly P . ( u' + u ) / 2, u' the velocity after it and u the one before the
// substep's matching and forces: with u' = - e u by P . u ( 1 - e ) / 2, a loss. Bullet bounces from the velocity after matching and
// forces, and would reflect the pressure on a node as if it were an approach; and it stops before its solution has converged, which for
// several contacts of one body at e near 1 may add as much again.

#include "world/respond/restitution.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>

namespace pliant {

namespace {

const btRigidBody* bodyOf( const btPersistentManifold& manifold, int side )
{
	return btRigidBody::upcast( side == 0 ? manifold.getBody0() : manifold.getBody1() );
}

/// Lever arm of an impulse from the body's mass centre.
btVector3 armOf( const btRigidBody& body, const btManifoldPoint& point, int side )
{
	return ( side == 0 ? point.getPositionWorldOnA() : point.getPositionWorldOnB() ) - body.getCenterOfMassPosition();
}

Vec3d velocityNow( const btPersistentManifold& manifold, const btManifoldPoint& point )
{
	Vec3d velocity = Vec3d::Zero();
	for ( int side = 0; side < 2; ++side )
	{
		const btRigidBody* const body = bodyOf( manifold, side );
		const Vec3d own = body ? toVec3d( body->getVelocityInLocalPoint( armOf( *body, point, side ) ) ) : Vec3d( Vec3d::Zero() );
		velocity += side == 0 ? own : Vec3d( -own );
	}
	return velocity;
}

/// Velocity that matching and forces have added to a node in this substep. (Bullet adds that of rigid bodies later.)
Vec3d velocityAdded( const btCollisionObject& object )
{
	if ( !ownerOfContactProxy( &object ) )
	{
		return Vec3d::Zero();
	}
	const auto& node = static_cast<const ContactProxy&>( object );
	const Body& body = *node.owner->impl().body;
	const bool hasMoved = !node.wasAsleep && node.node >= 0 && node.mass > 0;
	return hasMoved ? Vec3d( ( body.nodes().v.get( node.node ) - body.velocityBefore().get( node.node ) ).cast<double>() )
					: Vec3d( Vec3d::Zero() );
}

bool isInBlock( const btCollisionObject& object )
{
	const SoftBody* const owner = ownerOfContactProxy( &object );
	return owner && owner->impl().block >= 0;
}

Vec3d impulseOf( const btManifoldPoint& point )
{
	return double( point.m_appliedImpulse ) * toVec3d( point.m_normalWorldOnB ) +
		double( point.m_appliedImpulseLateral1 ) * toVec3d( point.m_lateralFrictionDir1 ) +
		double( point.m_appliedImpulseLateral2 ) * toVec3d( point.m_lateralFrictionDir2 );
}

} // namespace

void RestitutionCorrection::aim( btDispatcher& dispatcher, const btContactSolverInfo& info )
{
	m_bounces.clear();
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		const btCollisionObject &a = *manifold.getBody0(), &b = *manifold.getBody1();
		if ( ( !ownerOfContactProxy( &a ) && !ownerOfContactProxy( &b ) ) || isInBlock( a ) || isInBlock( b ) )
		{
			continue;
		}
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			m_bounces.push_back( Bounce{ &manifold, k, std::max( a.getIslandTag(), b.getIslandTag() ), false, Vec3d::Zero() } );
			aimAt( m_bounces.back(), info );
		}
	}
}

// Bullet's target is e' times the velocity after matching, plus the push-out velocity of a penetration.
void RestitutionCorrection::aimAt( Bounce& bounce, const btContactSolverInfo& info )
{
	const btPersistentManifold& manifold = *bounce.manifold;
	btManifoldPoint& point = bounce.manifold->getContactPoint( bounce.point );
	const Vec3d now = velocityNow( manifold, point ), normal = toVec3d( point.m_normalWorldOnB );
	bounce.before = now - velocityAdded( *manifold.getBody0() ) + velocityAdded( *manifold.getBody1() );
	if ( point.m_combinedRestitution <= 0 )
	{
		return;
	}
	const double depth = -double( point.getDistance() + info.m_linearSlop );
	const bool pushes = depth > 0.0 && ( !info.m_splitImpulse || -depth > double( info.m_splitImpulsePenetrationThreshold ) );
	const double push = pushes ? depth * double( info.m_erp2 / info.m_timeStep ) : 0.0;
	const double wanted = -double( point.m_combinedRestitution ) * normal.dot( bounce.before ) - push, approach = -normal.dot( now );
	bounce.bounces = wanted > 0.0 && approach > double( info.m_restitutionVelocityThreshold );
	point.m_combinedRestitution = bounce.bounces ? btScalar( wanted / approach ) : btScalar( 0 );
}

void RestitutionCorrection::settle()
{
	std::stable_sort( m_bounces.begin(), m_bounces.end(), []( const Bounce& a, const Bounce& b ) { return a.island < b.island; } );
	for ( std::size_t first = 0, end = 0; first < m_bounces.size(); first = end )
	{
		bool bounces = false;
		for ( end = first; end < m_bounces.size() && m_bounces[end].island == m_bounces[first].island; ++end )
		{
			bounces = bounces || m_bounces[end].bounces;
		}
		if ( bounces )
		{
			settle( Range( first, end ) );
		}
	}
}

// The impulses of all contacts of the island, scaled by s, do the work s W - s ( 1 - s ) K, K = P . A P / 2 the energy that they would give
// to bodies at rest.
void RestitutionCorrection::settle( const Range& island )
{
	const double after = doubledWork( island, false ), work = 0.5 * ( after + doubledWork( island, true ) );
	if ( !( work > 0.0 ) )
	{
		return;
	}
	applyImpulses( island, -1.0 );
	const double brought = 0.5 * ( after - doubledWork( island, false ) );
	const double fraction = brought > 0.0 ? std::max( 1.0 - work / brought, kLeastBounce ) : 1.0;
	applyImpulses( island, fraction );
	for ( std::size_t k = island.first; k < island.second; ++k )
	{
		btManifoldPoint& point = m_bounces[k].manifold->getContactPoint( m_bounces[k].point );
		point.m_appliedImpulse *= btScalar( fraction );
		point.m_appliedImpulseLateral1 *= btScalar( fraction );
		point.m_appliedImpulseLateral2 *= btScalar( fraction );
	}
}

double RestitutionCorrection::doubledWork( const Range& island, bool isBefore ) const
{
	double sum = 0.0;
	for ( std::size_t k = island.first; k < island.second; ++k )
	{
		const Bounce& bounce = m_bounces[k];
		const btManifoldPoint& point = bounce.manifold->getContactPoint( bounce.point );
		sum += impulseOf( point ).dot( isBefore ? bounce.before : velocityNow( *bounce.manifold, point ) );
	}
	return sum;
}

void RestitutionCorrection::applyImpulses( const Range& island, double fraction )
{
	for ( std::size_t k = island.first; k < island.second; ++k )
	{
		btPersistentManifold& manifold = *m_bounces[k].manifold;
		const btManifoldPoint& point = manifold.getContactPoint( m_bounces[k].point );
		const btVector3 impulse = toBt( fraction * impulseOf( point ) );
		for ( int side = 0; side < 2; ++side )
		{
			btRigidBody* const body = const_cast<btRigidBody*>( bodyOf( manifold, side ) );
			if ( body && body->getInvMass() > 0 )
			{
				body->applyImpulse( side == 0 ? impulse : -impulse, armOf( *body, point, side ) );
			}
		}
	}
}

} // namespace pliant
