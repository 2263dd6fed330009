#include "world/respond/parting.h"

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

constexpr double kNever = HUGE_VAL;

/// How far a shape reaches in a direction, m from the world's origin; `kNever` where that has no end or is not known.
double reachOf( const btCollisionShape& shape, const btTransform& at, const Vec3d& direction )
{
	if ( shape.isCompound() )
	{
		const auto& compound = static_cast<const btCompoundShape&>( shape );
		double most = -kNever;
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
														 : kNever;
	}
	if ( !shape.isConvex() )
	{
		return kNever;
	}
	const btVector3 local = toBt( direction ) * at.getBasis();
	return direction.dot( toVec3d( at * static_cast<const btConvexShape&>( shape ).localGetSupportingVertex( local ) ) );
}

/// How far its nodes' spheres reach.
double reachOf( const SoftBody& soft, const Vec3d& direction )
{
	const NodeState& nodes = soft.impl().body->nodes();
	double most = -kNever;
	for ( int i = 0; i < nodes.count; ++i )
	{
		most = std::max( most, direction.dot( nodes.x.get( i ).cast<double>() ) + double( soft.nodeRadius( i ) ) );
	}
	return most + direction.dot( nodes.origin );
}

/// How far the first has to go in a direction to be clear of the other.
double exitDisplacement( const SoftBody& soft, const btCollisionObject& other, const SoftBody* otherSoft, const Vec3d& direction )
{
	const double end = otherSoft ? reachOf( *otherSoft, direction )
								 : reachOf( *other.getCollisionShape(), other.getWorldTransform(), direction );
	return end + reachOf( soft, -direction );
}

/// Directions that may be the shortest: the axes of both as they stand, a plane's normal, and from middle to middle.
Vec3d shortestWay( const SoftBody& soft, const btCollisionObject& other, const SoftBody* otherSoft )
{
	std::array<Vec3d, 14> ways;
	std::size_t count = 0;
	const Eigen::Matrix3d axes[2] = { toMatrix3d( soft.bestFitTransform().getBasis() ),
		toMatrix3d( otherSoft ? otherSoft->bestFitTransform().getBasis() : other.getWorldTransform().getBasis() ) };
	for ( int axis : { 1, 0, 2 } ) // of ways of one length the one upwards, as most games have it
	{
		for ( const double sign : { 1.0, -1.0 } )
		{
			for ( const Eigen::Matrix3d& of : axes )
			{
				ways[count++] = sign * of.col( axis );
			}
		}
	}
	if ( !otherSoft && other.getCollisionShape()->getShapeType() == STATIC_PLANE_PROXYTYPE )
	{
		const auto& plane = static_cast<const btStaticPlaneShape&>( *other.getCollisionShape() );
		ways[count++] = toVec3d( other.getWorldTransform().getBasis() * plane.getPlaneNormal() );
	}
	const Vec3d apart = toVec3d( soft.massCentre() - ( otherSoft ? otherSoft->massCentre() : other.getWorldTransform().getOrigin() ) );
	if ( apart.norm() > double( soft.bodyTemplate().cellSize() ) * kParallel )
	{
		ways[count++] = apart.normalized();
	}
	Vec3d shortest = Vec3d::Zero();
	double least = kNever;
	for ( std::size_t k = 0; k < count; ++k )
	{
		const double way = exitDisplacement( soft, other, otherSoft, ways[k] );
		if ( way < least * ( 1.0 - kParallel ) )
		{
			least = way;
			shortest = ways[k];
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
	const unsigned placed = soft.impl().placements + ( otherSoft ? otherSoft->impl().placements : 0u );
	const bool isPlaced = isNew ? !soft.impl().family && !( otherSoft && otherSoft->impl().family ) : placed != m_placed;
	m_placed = placed;
	if ( !m_isParting && isPlaced )
	{
		const btRigidBody* const rigid = btRigidBody::upcast( &other );
		const double way = step *
			( fastestNode( soft ) +
				( otherSoft     ? fastestNode( *otherSoft )
						: rigid ? double( rigid->getLinearVelocity().length() )
								: 0.0 ) );
		m_isParting = std::any_of( hits.begin(), hits.end(),
			[&]( const NodeHit& hit ) { return radiusOf( hit ) - hit.touch.distance > kPartedDepth * radiusOf( hit ) + way; } );
		m_direction = m_isParting ? shortestWay( soft, other, otherSoft ) : m_direction;
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

} // namespace pliant
