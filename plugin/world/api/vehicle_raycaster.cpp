#include "pliant/vehicle_raycaster.h"

#include "world/api/wheel_constants.h"
#include "world/bodies/soft_body_impl.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Vehicle/btRaycastVehicle.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
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

/// A ray relative to the origin of a body's nodes, m.
struct Ray
{
	Vec3d from, direction;
	double length;
};

struct NearNode
{
	Vec3d position;
	double radius;
	double along; ///< coordinate of the node's centre along the ray, m
};

/// Returns the nodes within kWheelReach of their radii of the ray, by ascending index.
std::vector<NearNode> nodesNear( const SoftBody& body, const Ray& ray )
{
	const SoftBody::Impl& impl = body.impl();
	const double reach = kWheelReach * double( impl.shape->largestRadius() );
	const Vec3d shift = impl.shapeShift.cast<double>(), end = ray.from + ray.length * ray.direction;
	const Vec3d margin( reach, reach, reach );
	std::vector<int> found;
	impl.shape->rows().visitOverlaps(
		SphereRows::Box::of( toBt( ray.from.cwiseMin( end ) - shift - margin ), toBt( ray.from.cwiseMax( end ) - shift + margin ) ),
		[&found]( int node ) { found.push_back( node ); } );
	std::sort( found.begin(), found.end() );
	std::vector<NearNode> near;
	for ( const int node : found )
	{
		const Vec3d position = impl.body->nodes().x.get( node ).cast<double>();
		const double radius = double( impl.shape->sphereOfNode( node )->getRadius() ), along = ( position - ray.from ).dot( ray.direction );
		if ( along > -radius && ( position - ray.from - along * ray.direction ).norm() < kWheelReach * radius )
		{
			near.push_back( NearNode{ position, radius, along } );
		}
	}
	return near;
}

/// Returns the normal, against the ray, of the plane fitted to the nodes that the ray meets first.
Vec3d normalOf( const std::vector<NearNode>& near, const Ray& ray, double first )
{
	Vec3d mean = Vec3d::Zero();
	std::vector<Vec3d> top;
	for ( const NearNode& node : near )
	{
		if ( node.along - node.radius < first + kWheelDepth * node.radius )
		{
			top.push_back( node.position );
			mean += node.position;
		}
	}
	mean /= double( top.size() );
	Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
	for ( const Vec3d& position : top )
	{
		spread += ( position - mean ) * ( position - mean ).transpose();
	}
	Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
	axes.computeDirect( spread );
	const Vec3d normal = axes.eigenvectors().col( 0 ) * ( axes.eigenvectors().col( 0 ).dot( ray.direction ) > 0.0 ? -1.0 : 1.0 );
	const bool isFlat = top.size() >= 3 && axes.eigenvalues()[0] < kWheelFlat * axes.eigenvalues()[1];
	return isFlat && -normal.dot( ray.direction ) > kWheelSlope ? normal : Vec3d( -ray.direction );
}

/// Computes the distance along the ray to the body's surface and the outward normal there. Returns false if the ray ends before it.
bool cast( const SoftBody& body, const Ray& ray, double& along, Vec3d& normal )
{
	const std::vector<NearNode> near = nodesNear( body, ray );
	bool isHit = false;
	along = ray.length;
	for ( const NearNode& node : near )
	{
		// Like a disc as wide as the gaps between nodes: nodes closer to the ray than that support the wheel.
		const bool isUnder = ( node.position - ray.from - node.along * ray.direction ).norm() < kWheelGap * node.radius;
		if ( isUnder && node.along - node.radius < along )
		{
			along = std::max( 0.0, node.along - node.radius );
			isHit = true;
		}
	}
	normal = isHit ? normalOf( near, ray, along ) : Vec3d( -ray.direction );
	return isHit;
}

} // namespace

VehicleRaycaster::VehicleRaycaster( SoftBodyHost& world, int group, int mask ) : m_world( world ), m_group( group ), m_mask( mask ) {}

VehicleRaycaster::Hit VehicleRaycaster::nearest( const btVector3& from, const btVector3& to )
{
	Hit hit;
	if ( !isFinite( from ) || !isFinite( to ) || ( to - from ).fuzzyZero() )
	{
		return hit;
	}
	struct RigidOnly : btCollisionWorld::ClosestRayResultCallback
	{
		using ClosestRayResultCallback::ClosestRayResultCallback;
		bool needsCollision( btBroadphaseProxy* proxy ) const override
		{
			const btCollisionObject* const object = static_cast<const btCollisionObject*>( proxy->m_clientObject );
			return !SoftBody::upcast( object ) && ClosestRayResultCallback::needsCollision( proxy );
		}
	} rigid( from, to );
	rigid.m_collisionFilterGroup = m_group;
	rigid.m_collisionFilterMask = m_mask;
	m_world.bulletWorld().rayTest( from, to, rigid );
	if ( rigid.hasHit() )
	{
		const btRigidBody* const body = btRigidBody::upcast( rigid.m_collisionObject );
		hit.rigid = body && body->hasContactResponse() ? body : nullptr;
		hit.fraction = rigid.m_closestHitFraction;
		hit.normal = rigid.m_hitNormalWorld.normalized();
	}
	for ( int k = 0; k < m_world.softBodyCount(); ++k )
	{
		SoftBody& body = *m_world.softBody( k );
		const btBroadphaseProxy* const proxy = body.getBroadphaseHandle();
		if ( !body.hasContactResponse() || ( proxy->m_collisionFilterGroup & m_mask ) == 0 ||
			( m_group & proxy->m_collisionFilterMask ) == 0 )
		{
			continue;
		}
		const Vec3d displacement = toVec3d( to - from );
		const Ray ray{
			toVec3d( from ) - body.impl().body->nodes().origin, displacement.normalized(), double( hit.fraction ) * displacement.norm() };
		double along = 0.0;
		Vec3d normal;
		if ( cast( body, ray, along, normal ) )
		{
			hit.soft = &body;
			hit.fraction = btScalar( along / displacement.norm() );
			hit.normal = toBt( normal );
		}
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

// Applies to the ground the reaction of what btRaycastVehicle applies to the chassis: the suspension's force times the step.
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
			// What would make a node too fast is refused: that node is then not pressed on.
			static_cast<void>( soft->applyImpulse(
				ray.m_contactNormalWS * ( -wheel.m_wheelsSuspensionForce * step * soft->nodeMass( node ) / mass ), node ) );
		}
	}
}

} // namespace pliant
