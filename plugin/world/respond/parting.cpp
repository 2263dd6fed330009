#include "world/respond/parting.h"

#include "archive/archive.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/search/node_search.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant {

namespace {

constexpr double kUnbounded = HUGE_VAL;

/// Support distance of a shape in a direction, m from the world's origin; `kUnbounded` where it is unbounded or unknown.
double reachOf( const btCollisionShape& shape, const btTransform& at, const Vec3d& direction )
{
	if ( shape.isCompound() )
	{
		const auto& compound = static_cast<const btCompoundShape&>( shape );
		double most = -kUnbounded;
		for ( int k = 0; k < compound.getNumChildShapes(); ++k )
		{
			most = std::max( most, reachOf( *compound.getChildShape( k ), at * compound.getChildTransform( k ), direction ) );
		}
		return most;
	}
	if ( shape.getShapeType() == STATIC_PLANE_PROXYTYPE )
	{
		const auto& plane = static_cast<const btStaticPlaneShape&>( shape );
		const Vec3d normal = toVec3d( at.getBasis() * plane.getPlaneNormal() );
		return normal.dot( direction ) > 1.0 - kParallel ? double( plane.getPlaneConstant() ) + normal.dot( toVec3d( at.getOrigin() ) )
														 : kUnbounded;
	}
	if ( !shape.isConvex() )
	{
		return kUnbounded;
	}
	const btVector3 local = toBt( direction ) * at.getBasis();
	return direction.dot( toVec3d( at * static_cast<const btConvexShape&>( shape ).localGetSupportingVertex( local ) ) );
}

/// Support distance of a body's node spheres.
double reachOf( const SoftBody& soft, const Vec3d& direction )
{
	const NodeState& nodes = soft.impl().body->nodes();
	double most = -kUnbounded;
	for ( int i = 0; i < nodes.count; ++i )
	{
		most = std::max( most, direction.dot( nodes.x.get( i ).cast<double>() ) + double( soft.nodeRadius( i ) ) );
	}
	return most + direction.dot( nodes.origin );
}

/// Distance that the first body must move in a direction to be clear of the other.
double exitDisplacement( const SoftBody& soft, const btCollisionObject& other, const SoftBody* otherSoft, const Vec3d& direction )
{
	const double end = otherSoft ? reachOf( *otherSoft, direction )
								 : reachOf( *other.getCollisionShape(), other.getWorldTransform(), direction );
	return end + reachOf( soft, -direction );
}

/// The direction of the shortest exit among candidates: the axes of both objects, a plane's normal, and from centre to centre.
Vec3d shortestExit( const SoftBody& soft, const btCollisionObject& other, const SoftBody* otherSoft )
{
	std::array<Vec3d, 14> directions;
	std::size_t count = 0;
	const Eigen::Matrix3d axes[2] = { toMatrix3d( soft.bestFitTransform().getBasis() ),
		toMatrix3d( otherSoft ? otherSoft->bestFitTransform().getBasis() : other.getWorldTransform().getBasis() ) };
	for ( int axis : { 1, 0, 2 } ) // of equal exits the upward one, in most games' convention
	{
		for ( const double sign : { 1.0, -1.0 } )
		{
			for ( const Eigen::Matrix3d& of : axes )
			{
				directions[count++] = sign * of.col( axis );
			}
		}
	}
	if ( !otherSoft && other.getCollisionShape()->getShapeType() == STATIC_PLANE_PROXYTYPE )
	{
		const auto& plane = static_cast<const btStaticPlaneShape&>( *other.getCollisionShape() );
		directions[count++] = toVec3d( other.getWorldTransform().getBasis() * plane.getPlaneNormal() );
	}
	const Vec3d apart = toVec3d( soft.massCentre() - ( otherSoft ? otherSoft->massCentre() : other.getWorldTransform().getOrigin() ) );
	if ( apart.norm() > double( soft.bodyTemplate().cellSize() ) * kParallel )
	{
		directions[count++] = apart.normalized();
	}
	Vec3d shortest = Vec3d::Zero();
	double least = kUnbounded;
	for ( std::size_t k = 0; k < count; ++k )
	{
		const double distance = exitDisplacement( soft, other, otherSoft, directions[k] );
		if ( distance < least * ( 1.0 - kParallel ) )
		{
			least = distance;
			shortest = directions[k];
		}
	}
	return shortest;
}

double fastestNode( const SoftBody& soft )
{
	const Vec3Array& v = soft.impl().body->nodes().v;
	float most = 0.0f;
	for ( int i = 0; i < soft.nodeCount(); ++i )
	{
		most = std::max( most, v.get( i ).squaredNorm() );
	}
	return std::sqrt( double( most ) );
}

} // namespace

void Parting::follow(
	const SoftBody& soft, const btCollisionObject& other, const SoftBody* otherSoft, bool isNew, double step, std::vector<NodeHit>& hits )
{
	const auto radiusOf = [&soft]( const NodeHit& hit ) { return double( soft.nodeRadius( hit.node() ) ); };
	const unsigned placementCount = soft.impl().placements + ( otherSoft ? otherSoft->impl().placements : 0u );
	const bool isPlaced = isNew ? !soft.impl().family && !( otherSoft && otherSoft->impl().family ) : placementCount != m_placementCount;
	m_placementCount = placementCount;
	if ( !m_isParting && isPlaced )
	{
		const btRigidBody* const rigid = btRigidBody::upcast( &other );
		const double displacement = step *
			( fastestNode( soft ) +
				( otherSoft     ? fastestNode( *otherSoft )
						: rigid ? double( rigid->getLinearVelocity().length() )
								: 0.0 ) );
		m_isParting = std::any_of( hits.begin(), hits.end(),
			[&]( const NodeHit& hit ) { return radiusOf( hit ) - hit.touch.distance > kPartedDepth * radiusOf( hit ) + displacement; } );
		m_direction = m_isParting ? shortestExit( soft, other, otherSoft ) : m_direction;
		m_isParting = m_isParting && !m_direction.isZero();
	}
	if ( !m_isParting )
	{
		return;
	}
	m_isParting = !hits.empty() &&
		exitDisplacement( soft, other, otherSoft, m_direction ) > double( kContactSlop ) * double( soft.impl().shape->smallestRadius() );
	for ( const SoftBody* const each : { &soft, otherSoft } )
	{
		if ( each && m_isParting )
		{
			each->impl().partingPhases = kPartingPhases;
		}
	}
	for ( NodeHit& hit : hits )
	{
		if ( m_isParting && hit.touch.distance < radiusOf( hit ) )
		{
			hit.touch.normal = m_direction;
			hit.touch.distance = radiusOf( hit ) - kPartingSpeed * step / kUsualPush;
		}
	}
}

void Parting::archive( Archive& archive )
{
	archive( m_isParting, m_placementCount, m_direction );
	archive.requireFinite( m_direction, 3 );
}

} // namespace pliant
