#include "world/respond/friction_torque_correction.h"

#include "world/bodies/prefetch.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/shape/rigid_motion_proxy.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btUnionFind.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

namespace pliant {

namespace {

/// Impulse on the first body in the last solve, N s.
Vec3d appliedImpulse( const btManifoldPoint& point )
{
	return toVec3d( point.m_normalWorldOnB * point.m_appliedImpulse + point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
		point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2 );
}

double radiusOf( const btCollisionObject* node )
{
	return double( static_cast<const ContactProxy*>( node )->radius() );
}

bool isHidden( const btPersistentManifold& manifold )
{
	return manifold.getContactProcessingThreshold() <= btScalar( kHiddenThreshold );
}

} // namespace

void FrictionTorqueCorrection::choose( btUnionFind& islands )
{
	if ( m_rubbing.empty() )
	{
		return;
	}
	for ( int& index : m_grounded )
	{
		index = islands.find( index );
	}
	std::sort( m_grounded.begin(), m_grounded.end() );
	const auto isGrounded = [&]( int& index ) {
		index = islands.find( index );
		return std::binary_search( m_grounded.begin(), m_grounded.end(), index );
	};
	m_rubbing.erase( std::remove_if( m_rubbing.begin(), m_rubbing.end(), isGrounded ), m_rubbing.end() );
	std::sort( m_rubbing.begin(), m_rubbing.end() );
}

// Friction acts on the slip velocity  u = v0 + w0 x r0 - v1 - w1 x r1,  r from a node's centre to the contact point and w its body's
// angular velocity: then J.u dissipates what T.w, applied later, adds. Friction on the centres' velocities would drive the rotation of
// bodies of a dozen coarse nodes. Proxies have no rotational inertia: Bullet's solvers read w and leave it. Other contacts of the node act
// at its centre.
void FrictionTorqueCorrection::aim( btDispatcher& dispatcher )
{
	if ( m_rubbing.empty() )
	{
		return;
	}
	forEachManifold( dispatcher, prefetchEnd, [this]( btPersistentManifold& manifold ) {
		const btCollisionObject* const objects[] = { manifold.getBody0(), manifold.getBody1() };
		SoftBody* const owners[] = { ownerOfContactProxy( objects[0] ), ownerOfContactProxy( objects[1] ) };
		const SoftBody* const any = owners[0] ? owners[0] : owners[1];
		if ( !any || !std::binary_search( m_rubbing.begin(), m_rubbing.end(), any->getIslandTag() ) || isHidden( manifold ) )
		{
			return;
		}
		const bool rubs = owners[0] && owners[1] && owners[0] != owners[1];
		btVector3 touch( 0, 0, 0 );
		if ( rubs )
		{
			const btScalar r0 = btScalar( radiusOf( objects[0] ) ), r1 = btScalar( radiusOf( objects[1] ) );
			touch = ( r1 * objects[0]->getWorldTransform().getOrigin() + r0 * objects[1]->getWorldTransform().getOrigin() ) / ( r0 + r1 );
		}
		for ( int side = 0; side < 2; ++side )
		{
			if ( !owners[side] )
			{
				continue;
			}
			auto* const node = const_cast<ContactProxy*>( static_cast<const ContactProxy*>( objects[side] ) );
			if ( rubs )
			{
				node->setAngularVelocity( turnOf( *owners[side] ).angularVelocity );
				m_turning.push_back( node );
			}
			for ( int k = 0; k < manifold.getNumContacts(); ++k )
			{
				btManifoldPoint& point = manifold.getContactPoint( k );
				movePoint(
					side == 0 ? point.m_positionWorldOnA : point.m_positionWorldOnB, rubs ? touch : node->getWorldTransform().getOrigin() );
			}
		}
	} );
}

void FrictionTorqueCorrection::movePoint( btVector3& point, const btVector3& at )
{
	m_movedPoints.push_back( MovedPoint{ &point, point } );
	point = at;
}

// The spheres touch at  p = ( r1 x0 + r0 x1 ) / ( r0 + r1 ),  so that with d = x0 - x1
//   T0 = ( p - x0 ) x J = - r0 / ( r0 + r1 ) d x J,   T1 = - ( p - x1 ) x J = - r1 / ( r0 + r1 ) d x J
// Only in islands without contacts to static objects: others pass spin on to the ground. The spin lost there lets stacks of soft bodies
// fall asleep: with the correction a stack of four cubes sways forever, since the solver pushes compressed bodies apart.
void FrictionTorqueCorrection::sum( btDispatcher& dispatcher )
{
	if ( m_rubbing.empty() )
	{
		return;
	}
	for ( const MovedPoint& moved : m_movedPoints )
	{
		*moved.point = moved.original;
	}
	for ( ContactProxy* node : m_turning )
	{
		node->setAngularVelocity( btVector3( 0, 0, 0 ) );
	}
	m_movedPoints.clear();
	m_turning.clear();
	forEachManifold( dispatcher, prefetchEnd, [this]( const btPersistentManifold& manifold ) {
		SoftBody *const first = ownerOfContactProxy( manifold.getBody0() ), *const second = ownerOfContactProxy( manifold.getBody1() );
		if ( !first || !second || first == second || !std::binary_search( m_rubbing.begin(), m_rubbing.end(), first->getIslandTag() ) ||
			isHidden( manifold ) || !areSolved( *first, *second ) )
		{
			return;
		}
		const btVector3 apart = manifold.getBody0()->getWorldTransform().getOrigin() - manifold.getBody1()->getWorldTransform().getOrigin();
		const double r0 = radiusOf( manifold.getBody0() ), r1 = radiusOf( manifold.getBody1() );
		Vec3d impulse = Vec3d::Zero();
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			impulse += appliedImpulse( manifold.getContactPoint( k ) );
		}
		const Vec3d correction = -toVec3d( apart ).cross( impulse ) / ( r0 + r1 );
		turnOf( *first ).impulse += r0 * correction;
		turnOf( *second ).impulse += r1 * correction;
	} );
}

void FrictionTorqueCorrection::give()
{
	for ( const Turn& turn : m_turns )
	{
		RigidMotionProxy( turn.body ).turn( turn.impulse );
		turn.body->impl().frictionTorque = -1;
	}
	m_turns.clear();
}

FrictionTorqueCorrection::Turn& FrictionTorqueCorrection::turnOf( SoftBody& body )
{
	int& index = body.impl().frictionTorque;
	if ( index < 0 )
	{
		index = int( m_turns.size() );
		m_turns.push_back( Turn{ &body, Vec3d::Zero(), toBt( RigidMotionProxy( &body ).angularVelocity ) } );
	}
	return m_turns[std::size_t( index )];
}

} // namespace pliant
