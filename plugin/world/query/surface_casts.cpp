// Rays and sweeps of Bullet's against the drawn surface. Bullet passes them to a concave shape as callbacks for triangles.

#include "world/bodies/soft_body_impl.h"
#include "world/query/query_constants.h"
#include "world/query/surface_shape.h"

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>

#include <algorithm>
#include <cstring>

namespace pliant {

namespace {

/// The class of a callback, by its table of virtual functions: Bullet may be built without run-time type information.
const void* classOf( const btTriangleCallback& callback )
{
	const void* table = nullptr;
	std::memcpy( &table, static_cast<const void*>( &callback ), sizeof table );
	return table;
}

/// A concave shape that remembers the class of the last callback.
struct ProbeShape : btConcaveShape
{
	ProbeShape() { m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE; }
	void processAllTriangles( btTriangleCallback* callback, const btVector3&, const btVector3& ) const override
	{
		seen = classOf( *callback );
	}
	void getAabb( const btTransform&, btVector3& low, btVector3& high ) const override
	{
		low.setValue( -1, -1, -1 );
		high = -low;
	}
	void setLocalScaling( const btVector3& ) override {}
	const btVector3& getLocalScaling() const override { return scaling; }
	void calculateLocalInertia( btScalar, btVector3& ) const override {}
	const char* getName() const override { return "PliantProbe"; }

	btVector3 scaling = btVector3( 1, 1, 1 );
	mutable const void* seen = nullptr;
};

/// The classes by which Bullet casts rays and sweeps at a concave shape, which are private to it: found out by a cast of each kind.
struct CastClasses
{
	CastClasses()
	{
		ProbeShape probe;
		btCollisionObject object;
		object.setCollisionShape( &probe );
		const btVector3 from( 0, 2, 0 ), to( 0, -2, 0 );
		const btTransform still = btTransform::getIdentity(), start( still.getBasis(), from ), end( still.getBasis(), to );
		btCollisionWorld::ClosestRayResultCallback closestRay( from, to );
		btCollisionWorld::rayTestSingle( start, end, &object, &probe, still, closestRay );
		ray = probe.seen;
		const btSphereShape ball( btScalar( 0.1 ) );
		btCollisionWorld::ClosestConvexResultCallback closestSweep( from, to );
		btCollisionWorld::objectQuerySingle( &ball, start, end, &object, &probe, still, closestSweep, 0 );
		sweep = probe.seen;
	}
	const void* ray = nullptr;
	const void* sweep = nullptr;
};

const CastClasses& castClasses()
{
	static const CastClasses classes;
	return classes;
}

} // namespace

void SurfaceShape::processAllTriangles( btTriangleCallback* callback, const btVector3& low, const btVector3& high ) const
{
	now();
	const void* const kind = classOf( *callback );
	if ( kind == castClasses().ray )
	{
		castRay( *static_cast<btTriangleRaycastCallback*>( callback ) );
	}
	else if ( kind == castClasses().sweep )
	{
		castConvex( *static_cast<btTriangleConvexcastCallback*>( callback ) );
	}
	else
	{
		for ( Piece& piece : piecesIn( low, high ) )
		{
			callback->processTriangle( piece.corner, -1, childNear( ( piece.corner[0] + piece.corner[1] + piece.corner[2] ) / 3 ) );
		}
	}
}

void SurfaceShape::castRay( btTriangleRaycastCallback& ray ) const
{
	const Vec3d from = inNodes( ray.m_from ), along = toVec3d( ray.m_to - ray.m_from );
	double limit = double( ray.m_hitFraction );
	m_surface.tree.visitPath( BoxPath{ from, along, Vec3d::Zero() }, limit, [&]( int triangle ) {
		Vec3d corner[3];
		cornersOf( triangle, corner );
		TriangleHit hit;
		if ( !meets( from, along, corner, limit, hit ) )
		{
			return;
		}
		const bool isFromBehind = along.dot( hit.normal ) > 0.0;
		if ( isFromBehind && ( ray.m_flags & btTriangleRaycastCallback::kF_FilterBackfaces ) != 0 )
		{
			return;
		}
		const Vec3d smooth = smoothNormal( triangle, hit.weights, hit.normal );
		const bool turns = isFromBehind && ( ray.m_flags & btTriangleRaycastCallback::kF_KeepUnflippedNormal ) == 0;
		const btVector3 normal = toBt( ( turns ? -1.0 : 1.0 ) * smooth );
		ray.m_hitFraction = ray.reportHit( normal, btScalar( hit.fraction ), -1, childNear( fromNodes( hit.point ) ) );
		limit = double( ray.m_hitFraction );
	} );
}

/// Receives the hits of a sweep on one triangle, in the world, and passes them on with the surface's normal and node.
struct SweepCall : btTriangleConvexcastCallback
{
	SweepCall( const SurfaceShape& ofSurface, btTriangleConvexcastCallback& toSweep ) :
		btTriangleConvexcastCallback( toSweep.m_convexShape, toSweep.m_convexShapeFrom, toSweep.m_convexShapeTo, toSweep.m_triangleToWorld,
			toSweep.m_triangleCollisionMargin ),
		surface( ofSurface ), sweep( toSweep ), limit( double( toSweep.m_hitFraction ) )
	{
		m_hitFraction = toSweep.m_hitFraction;
		m_allowedPenetration = toSweep.m_allowedPenetration;
	}

	btScalar reportHit( const btVector3& normal, const btVector3& point, btScalar fraction, int, int index ) override
	{
		const btTransform toLocal = m_triangleToWorld.inverse();
		const btVector3 at = toLocal * point;
		Vec3d corner[3];
		surface.cornersOf( index, corner );
		const Vec3d face = ( corner[1] - corner[0] ).cross( corner[2] - corner[0] ).normalized(),
					smooth = surface.smoothNormal( index, nearestWeights( surface.inNodes( at ), corner ), face );
		const btVector3 outwards = m_triangleToWorld.getBasis() * toBt( smooth );
		const btScalar cosine = outwards.dot( normal );
		// A smooth surface has one normal; Bullet's for small triangles can be far off. At an edge there are all those between its faces.
		const bool isEdge = !isSmooth( index, face ) && btFabs( cosine ) < btScalar( kSmoothCosine );
		const bool isFromBehind = cosine < 0;
		const btVector3 shown = isEdge ? normal : isFromBehind ? btVector3( -outwards ) : outwards;
		m_hitFraction = btMin( m_hitFraction, sweep.reportHit( shown, point, fraction, -1, surface.childNear( at ) ) );
		limit = double( m_hitFraction );
		return m_hitFraction;
	}

	bool isSmooth( int triangle, const Vec3d& face ) const
	{
		const std::uint32_t* const vertex = surface.m_surface.view.indices + 3 * std::size_t( triangle );
		return !surface.m_surface.normals.empty() &&
			std::all_of( vertex, vertex + 3, [&]( std::uint32_t corner ) { return surface.isSmoothAt( corner, face ); } );
	}

	const SurfaceShape& surface;
	btTriangleConvexcastCallback& sweep;
	double limit;
};

namespace {

/// The path of the box around a convex shape, in the coordinates of `toLocal`. A rotating shape gets the box of the sphere around it.
BoxPath pathOf( const btTriangleConvexcastCallback& sweep, const btTransform& toLocal )
{
	const btTransform from = toLocal * sweep.m_convexShapeFrom, to = toLocal * sweep.m_convexShapeTo;
	btVector3 low, high;
	if ( from.getBasis() == to.getBasis() )
	{
		sweep.m_convexShape->getAabb( btTransform( from.getBasis() ), low, high );
	}
	else
	{
		btScalar radius = 0;
		sweep.m_convexShape->getBoundingSphere( low, radius );
		radius += low.length();
		high.setValue( radius, radius, radius );
		low = -high;
	}
	const btScalar margin = sweep.m_triangleCollisionMargin;
	const Vec3d middle = toVec3d( low + high ) / 2.0;
	return BoxPath{ toVec3d( from.getOrigin() ) + middle, toVec3d( to.getOrigin() - from.getOrigin() ),
		toVec3d( high - low ) / 2.0 + Vec3d::Constant( double( margin ) ) };
}

} // namespace

void SurfaceShape::castConvex( btTriangleConvexcastCallback& sweep ) const
{
	const btTransform toLocal = sweep.m_triangleToWorld.inverse();
	BoxPath path = pathOf( sweep, toLocal );
	path.from = inNodes( toBt( path.from ) );
	SweepCall call( *this, sweep );
	const bool isBall = sweep.m_convexShape->getShapeType() == SPHERE_SHAPE_PROXYTYPE;
	const double own = isBall ? double( static_cast<const btSphereShape*>( sweep.m_convexShape )->getRadius() ) : 0.0;
	const double radius = std::max( own - double( sweep.m_allowedPenetration ), kLeastSweptRadius * own );
	m_surface.tree.visitPath( path, call.limit, [&]( int triangle ) {
		if ( !isBall )
		{
			btVector3 corner[3];
			cornersOf( triangle, corner );
			call.processTriangle( corner, -1, triangle );
			return;
		}
		Vec3d corner[3];
		cornersOf( triangle, corner );
		TriangleHit hit;
		if ( meets( path.from, path.along, radius, corner, call.limit, hit ) )
		{
			const btVector3 normal = sweep.m_triangleToWorld.getBasis() * toBt( hit.normal );
			call.reportHit( normal, sweep.m_triangleToWorld * fromNodes( hit.point ), btScalar( hit.fraction ), -1, triangle );
		}
	} );
	sweep.m_hitFraction = call.m_hitFraction;
}

} // namespace pliant
