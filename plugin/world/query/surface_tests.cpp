#include "world/query/surface_tests.h"

#include "world/bodies/soft_body_impl.h"
#include "world/query/query_constants.h"
#include "world/query/surface_shape.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>

namespace pliant {

namespace {

/// The pair of a test: a soft body's surface and the other object.
struct Tested
{
	const btCollisionObjectWrapper& soft;
	const btCollisionObjectWrapper& other;
	btManifoldResult& result;
	bool softIsFirst;
	int count = 0; ///< of contact points
	struct Touch
	{
		btVector3 point, outwards;
		btScalar distance;
		int part, index;
	};
	/// The deepest of the touches that were left to neighbouring triangles; for thin things that pierce one triangle alone.
	Touch left = { btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ), SIMD_INFINITY, -1, -1 };

	const SurfaceShape& surface() const { return static_cast<const BodyShape*>( soft.getCollisionShape() )->surface(); }
	const btConvexShape* convex() const
	{
		const btCollisionShape* const shape = other.getCollisionShape();
		return shape->isConvex() ? static_cast<const btConvexShape*>( shape ) : nullptr;
	}
	/// The point of the other object, a convex one, farthest against a direction, world, m.
	btVector3 deepestBehind( const btVector3& normal ) const
	{
		const btTransform& at = other.getWorldTransform();
		return at( convex()->localGetSupportingVertex( ( -normal ) * at.getBasis() ) );
	}
	/// Height of the lowest point of the other object, a convex one, over a plane, m.
	btScalar heightOver( const btVector3& point, const btVector3& normal ) const
	{
		return ( deepestBehind( normal ) - point ).dot( normal );
	}
	/// Whether a point is in the soft body, and then its distance from the surface, m.
	bool isInside( const btVector3& point, btScalar& distance ) const
	{
		const btVector3 local = soft.getWorldTransform().invXform( point );
		btVector3 onSurface, outwards;
		if ( !surface().contains( local, onSurface, outwards ) )
		{
			return false;
		}
		distance = ( onSurface - local ).length();
		return true;
	}
	/// A contact at a point of the surface. `outwards`: out of the soft body; `part` and `index`: of the other shape.
	void add( const btVector3& point, const btVector3& outwards, btScalar distance, int part, int index )
	{
		const int child = surface().childNear( soft.getWorldTransform().invXform( point ) );
		softIsFirst ? result.setShapeIdentifiersA( -1, child ) : result.setShapeIdentifiersB( -1, child );
		softIsFirst ? result.setShapeIdentifiersB( part, index ) : result.setShapeIdentifiersA( part, index );
		// Bullet takes the point on the second object, and the normal from there to the first.
		result.addContactPoint( softIsFirst ? -outwards : outwards, softIsFirst ? point + distance * outwards : point, distance );
		++count;
	}
};

/// Receives the contacts of one triangle. Normals of contacts with an object behind it are reversed, so that they point outwards.
struct TriangleResult : btManifoldResult
{
	TriangleResult( const btCollisionObjectWrapper& triangle, Tested& tested, const btVector3& outwards ) :
		btManifoldResult( &triangle, &tested.other ), m_tested( tested ), m_outwards( outwards )
	{
		setShapeIdentifiersA( -1, -1 );
		setShapeIdentifiersB( tested.other.m_partId, tested.other.m_index );
		m_closestPointDistanceThreshold = tested.result.m_closestPointDistanceThreshold;
	}

	void addContactPoint( const btVector3& normalOnB, const btVector3& pointOnB, btScalar depth ) override
	{
		const bool isSwapped = m_manifoldPtr->getBody0() != m_body0Wrap->getCollisionObject();
		btVector3 outwards = isSwapped ? normalOnB : -normalOnB;
		const btVector3 point = isSwapped ? pointOnB : pointOnB + depth * normalOnB;
		const btScalar cosine = outwards.dot( m_outwards );
		if ( cosine < 0 && m_tested.convex() )
		{
			const btVector3 deepest = m_tested.deepestBehind( m_outwards );
			const btScalar height = ( deepest - point ).dot( m_outwards );
			btScalar inside;
			if ( cosine > -kBehindCosine || !m_tested.isInside( deepest, inside ) )
			{
				// Touches an edge of the triangle from beside, or goes past it: the neighbour at that edge has the contact.
				if ( height < m_tested.left.distance )
				{
					m_tested.left = { point, m_outwards, height, m_partId1, m_index1 };
				}
				return;
			}
			outwards = m_outwards;
			depth = std::max( height, -inside ); // other faces may be nearer
		}
		m_tested.add( point, outwards, depth, m_partId1, m_index1 );
	}

	Tested& m_tested;
	btVector3 m_outwards;
};

/// Whether a triangle, in the world, is farther above a plane than `reach`. False for other shapes.
bool isAbovePlane( const btCollisionObjectWrapper& other, const btVector3 ( &corner )[3], btScalar reach )
{
	if ( other.getCollisionShape()->getShapeType() != STATIC_PLANE_PROXYTYPE )
	{
		return false;
	}
	const auto& plane = static_cast<const btStaticPlaneShape&>( *other.getCollisionShape() );
	return std::all_of( std::begin( corner ), std::end( corner ), [&]( const btVector3& at ) {
		return plane.getPlaneNormal().dot( other.getWorldTransform().invXform( at ) ) - plane.getPlaneConstant() > reach;
	} );
}

void testTriangle( btDispatcher& dispatcher, Tested& tested, const btDispatcherInfo& info, const btVector3 ( &corner )[3] )
{
	const btTransform& at = tested.soft.getWorldTransform();
	btTriangleShape shape( corner[0], corner[1], corner[2] );
	shape.setMargin( 0 );
	btVector3 outwards = at.getBasis() * ( corner[1] - corner[0] ).cross( corner[2] - corner[0] );
	if ( !( outwards.length2() > 0 ) )
	{
		return;
	}
	const btCollisionObjectWrapper triangle( &tested.soft, &shape, tested.soft.getCollisionObject(), at, -1, -1 );
	TriangleResult result( triangle, tested, outwards.normalized() );
	btCollisionAlgorithm* const algorithm = dispatcher.findAlgorithm( &triangle, &tested.other, nullptr, BT_CLOSEST_POINT_ALGORITHMS );
	algorithm->processCollision( &triangle, &tested.other, info, &result );
	algorithm->~btCollisionAlgorithm();
	dispatcher.freeCollisionAlgorithm( algorithm );
}

/// Something wholly inside touches no triangle.
void testInside( Tested& tested )
{
	if ( tested.count > 0 || !tested.convex() )
	{
		return;
	}
	const btTransform& at = tested.soft.getWorldTransform();
	btVector3 low, high, onSurface, outwards;
	tested.convex()->getAabb( tested.other.getWorldTransform(), low, high );
	if ( tested.surface().contains( at.invXform( ( low + high ) / 2 ), onSurface, outwards ) )
	{
		const btVector3 point = at( onSurface ), normal = at.getBasis() * outwards;
		tested.add( point, normal, tested.heightOver( point, normal ), tested.other.m_partId, tested.other.m_index );
	}
}

} // namespace

bool SurfaceTest::isSurface( const btCollisionObjectWrapper& wrapper )
{
	const SoftBody* const soft = asSoftBody( const_cast<btCollisionObject*>( wrapper.getCollisionObject() ) );
	return soft && !soft->impl().rigidProxy && wrapper.getCollisionShape() == soft->getCollisionShape(); // rigid states have hulls
}

void SurfaceTest::processCollision(
	const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1, const btDispatcherInfo& info, btManifoldResult* result )
{
	const bool softIsFirst = isSurface( *body0 );
	Tested tested{ softIsFirst ? *body0 : *body1, softIsFirst ? *body1 : *body0, *result, softIsFirst };
	const btTransform& at = tested.soft.getWorldTransform();
	const btScalar reach = gContactBreakingThreshold + result->m_closestPointDistanceThreshold;
	btVector3 low, high;
	tested.other.getCollisionShape()->getAabb( at.inverse() * tested.other.getWorldTransform(), low, high );
	const btVector3 around( reach, reach, reach );
	btPersistentManifold* const manifold = m_dispatcher->getNewManifold( body0->getCollisionObject(), body1->getCollisionObject() );
	result->setPersistentManifold( manifold );
	for ( const SurfaceShape::Piece& piece : tested.surface().piecesIn( low - around, high + around ) )
	{
		const btVector3 world[3] = { at( piece.corner[0] ), at( piece.corner[1] ), at( piece.corner[2] ) };
		if ( !isAbovePlane( tested.other, world, reach ) )
		{
			testTriangle( *m_dispatcher, tested, info, piece.corner );
		}
	}
	if ( tested.count == 0 && tested.left.distance < 0 )
	{
		tested.add( tested.left.point, tested.left.outwards, tested.left.distance, tested.left.part, tested.left.index );
	}
	testInside( tested );
	result->setPersistentManifold( nullptr );
	m_dispatcher->releaseManifold( manifold );
}

} // namespace pliant
