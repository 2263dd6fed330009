#include "pliant/vehicle_raycaster.h"

#include "world/bodies/soft_body_impl.h"
#include "world/game/wheel_constants.h"

#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Vehicle/btRaycastVehicle.h>

#include <vector>

namespace pliant {

struct VehicleRaycaster::Hit
{
	SoftBody* soft = nullptr;
	const btRigidBody* rigid = nullptr;
	btScalar fraction = btScalar( 1 );
	btVector3 normal = btVector3( 0, 0, 0 );
};

namespace {

/// Objects that a wheel's ray may meet: either everything but soft bodies, or soft bodies alone, from outside.
struct WheelRay : btCollisionWorld::ClosestRayResultCallback
{
	WheelRay( const btVector3& from, const btVector3& to, bool meetsSoft ) : ClosestRayResultCallback( from, to ), isSoft( meetsSoft )
	{
		m_flags |= isSoft ? btTriangleRaycastCallback::kF_FilterBackfaces : 0U;
	}
	bool needsCollision( btBroadphaseProxy* proxy ) const override
	{
		const auto* const object = static_cast<const btCollisionObject*>( proxy->m_clientObject );
		const SoftBody* const soft = SoftBody::upcast( object );
		return ( soft != nullptr ) == isSoft && ( !soft || soft->hasContactResponse() ) &&
			ClosestRayResultCallback::needsCollision( proxy );
	}
	bool isSoft;
};

} // namespace

VehicleRaycaster::VehicleRaycaster( SoftBodyHost& world, int group, int mask ) : m_world( world ), m_group( group ), m_mask( mask ) {}

VehicleRaycaster::Hit VehicleRaycaster::nearest( const btVector3& from, const btVector3& to )
{
	Hit hit;
	if ( !isFinite( from ) || !isFinite( to ) || ( to - from ).fuzzyZero() )
	{
		return hit;
	}
	WheelRay rigid( from, to, false ), soft( from, to, true );
	for ( WheelRay* const ray : { &rigid, &soft } )
	{
		ray->m_collisionFilterGroup = m_group;
		ray->m_collisionFilterMask = m_mask;
		m_world.bulletWorld().rayTest( from, to, *ray );
	}
	if ( rigid.hasHit() )
	{
		const btRigidBody* const body = btRigidBody::upcast( rigid.m_collisionObject );
		hit.rigid = body && body->hasContactResponse() ? body : nullptr;
		hit.fraction = rigid.m_closestHitFraction;
		hit.normal = rigid.m_hitNormalWorld.normalized();
	}
	if ( soft.hasHit() && soft.m_closestHitFraction < hit.fraction )
	{
		hit.soft = const_cast<SoftBody*>( SoftBody::upcast( soft.m_collisionObject ) );
		hit.fraction = soft.m_closestHitFraction;
		const btVector3 against = ( from - to ).normalized(), normal = soft.m_hitNormalWorld.normalized();
		hit.normal = normal.dot( against ) > btScalar( kWheelSlope ) ? normal : against;
	}
	return hit;
}

void* VehicleRaycaster::castRay( const btVector3& from, const btVector3& to, btVehicleRaycasterResult& result )
{
	const Hit hit = nearest( from, to );
	if ( !hit.soft && !hit.rigid )
	{
		return nullptr;
	}
	result.m_hitPointInWorld.setInterpolate3( from, to, hit.fraction );
	result.m_hitNormalInWorld = hit.normal;
	result.m_distFraction = hit.fraction;
	return hit.soft ? &getFixedBody() : const_cast<btRigidBody*>( hit.rigid );
}

SoftBody* VehicleRaycaster::softBodyAt( const btVector3& from, const btVector3& to )
{
	return nearest( from, to ).soft;
}

// Applies to the ground the reaction of btRaycastVehicle's force on the chassis: the suspension's force times the step.
void VehicleRaycaster::updateAction( btCollisionWorld*, btScalar step )
{
	if ( !m_vehicle || !const_cast<btRaycastVehicle*>( m_vehicle )->getRigidBody()->isActive() )
	{
		return;
	}
	for ( int w = 0; w < m_vehicle->getNumWheels(); ++w )
	{
		const btWheelInfo& wheel = m_vehicle->getWheelInfo( w );
		const btWheelInfo::RaycastInfo& ray = wheel.m_raycastInfo;
		const btScalar length = wheel.getSuspensionRestLength() + wheel.m_wheelsRadius;
		SoftBody* const soft = ray.m_isInContact ? softBodyAt( ray.m_hardPointWS, ray.m_hardPointWS + length * ray.m_wheelDirectionWS )
												 : nullptr;
		if ( !soft || !( wheel.m_wheelsSuspensionForce > 0 ) )
		{
			continue;
		}
		const btScalar reach = btMax( wheel.m_wheelsRadius, 2 * soft->impl().shape->largestRadius() );
		std::vector<int> under;
		btScalar mass = 0;
		for ( int node = 0; node < soft->nodeCount(); ++node )
		{
			if ( ( soft->nodePosition( node ) - ray.m_contactPointWS ).length2() < reach * reach )
			{
				under.push_back( node );
				mass += soft->nodeMass( node );
			}
		}
		for ( const int node : under )
		{
			// An impulse that would make a node too fast is refused: that node is then not pressed.
			static_cast<void>( soft->applyImpulse(
				ray.m_contactNormalWS * ( -wheel.m_wheelsSuspensionForce * step * soft->nodeMass( node ) / mass ), node ) );
		}
	}
}

} // namespace pliant
