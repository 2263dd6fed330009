#include "world/respond/rolling_friction.h"

#include "world/bodies/soft_body_impl.h"
#include "world/shape/rigid_motion_proxy.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>

namespace pliant {

namespace {

/// The body that a contact belongs to: a proxy's soft body.
btCollisionObject* bodyOf( const btCollisionObject* object )
{
	SoftBody* const owner = ownerOfContactProxy( object );
	return owner ? owner : const_cast<btCollisionObject*>( object );
}

/// Brakes their relative rotation about an axis of unit length, by at most `limit`, N m s.
void brakeAbout( RigidMotionProxy& a, RigidMotionProxy& b, const Vec3d& axis, double limit )
{
	const double inverseMoment = axis.dot( ( a.inverseInertia + b.inverseInertia ) * axis );
	if ( inverseMoment > 0.0 && limit > 0.0 )
	{
		// The impulse that would stop the rotation is never exceeded, so that energy can only decrease.
		const double wanted = -axis.dot( a.angularVelocity - b.angularVelocity ) / inverseMoment;
		const Vec3d impulse = std::clamp( wanted, -limit, limit ) * axis;
		a.turn( impulse );
		b.turn( -impulse );
	}
}

} // namespace

void RollingFriction::hide( const std::vector<btPersistentManifold*>& manifolds )
{
	m_hidden.clear();
	for ( btPersistentManifold* const manifold : manifolds )
	{
		for ( int k = 0; k < manifold->getNumContacts(); ++k )
		{
			btManifoldPoint& point = manifold->getContactPoint( k );
			if ( point.m_combinedRollingFriction != 0 || point.m_combinedSpinningFriction != 0 )
			{
				m_hidden.push_back( Hidden{ manifold, k, point.m_combinedRollingFriction, point.m_combinedSpinningFriction } );
				point.m_combinedRollingFriction = point.m_combinedSpinningFriction = 0;
			}
		}
	}
}

RollingFriction::Pair& RollingFriction::pairOf( btCollisionObject* first, btCollisionObject* second )
{
	for ( Pair& pair : m_pairs )
	{
		if ( pair.first == first && pair.second == second )
		{
			return pair;
		}
	}
	m_pairs.push_back( Pair{ first, second, Vec3d::Zero() } );
	return m_pairs.back();
}

void RollingFriction::apply()
{
	m_pairs.clear();
	for ( const Hidden& hidden : m_hidden )
	{
		btManifoldPoint& point = hidden.manifold->getContactPoint( hidden.point );
		point.m_combinedRollingFriction = hidden.rolling;
		point.m_combinedSpinningFriction = hidden.spinning;
		btCollisionObject* const first = bodyOf( hidden.manifold->getBody0() );
		btCollisionObject* const second = bodyOf( hidden.manifold->getBody1() );
		const double normalImpulse = double( point.m_appliedImpulse );
		if ( normalImpulse <= 0.0 || !areSolved( *first, *second ) )
		{
			continue;
		}
		Pair& pair = pairOf( first, second );
		pair.normalImpulse += normalImpulse * toVec3d( point.m_normalWorldOnB );
		pair.rolling += normalImpulse * double( hidden.rolling );
		pair.spinning += normalImpulse * double( hidden.spinning );
	}
	for ( const Pair& pair : m_pairs )
	{
		brake( pair );
	}
}

void RollingFriction::brake( const Pair& pair )
{
	if ( pair.normalImpulse.isZero( 0.0 ) )
	{
		return;
	}
	const Vec3d normal = pair.normalImpulse.normalized();
	RigidMotionProxy a( pair.first ), b( pair.second );
	brakeAbout( a, b, normal, pair.spinning );
	const Vec3d turning = a.angularVelocity - b.angularVelocity, rolling = turning - normal.dot( turning ) * normal;
	if ( !rolling.isZero( 0.0 ) )
	{
		brakeAbout( a, b, rolling.normalized(), pair.rolling );
	}
}

} // namespace pliant
