#include "world/touch/node_touch.h"

#include "world/constants.h"
#include "world/touch/box_touch.h"
#include "world/touch/edge_constants.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSdfCollisionShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

Vec3d toEigen( const btVector3& a )
{
	return { double( a.x() ), double( a.y() ), double( a.z() ) };
}

btVector3 toBullet( const Vec3d& a )
{
	return btVector3( btScalar( a.x() ), btScalar( a.y() ), btScalar( a.z() ) );
}

/// Normal and distance of a surface that lies `round` outside a core point; `out`: from that point to the sphere's centre.
Touch fromCore( const Vec3d& out, double round )
{
	const double length = out.norm();
	// A centre exactly on the core has no direction; up is as good as any other and the same on every machine.
	return length > 0.0 ? Touch{ out / length, length - round } : Touch{ Vec3d::UnitY(), -round };
}

Touch nearestOnBox( const Vec3d& half, const Vec3d& p )
{
	const Vec3d out = p - p.cwiseMin( half ).cwiseMax( -half );
	if ( !out.isZero( 0.0 ) )
	{
		return fromCore( out, 0.0 );
	}
	// Inside: the nearest face.
	int axis = 0;
	( half - p.cwiseAbs() ).minCoeff( &axis );
	Vec3d normal = Vec3d::Zero();
	normal[axis] = p[axis] < 0.0 ? -1.0 : 1.0;
	return Touch{ normal, std::abs( p[axis] ) - half[axis] };
}

Touch nearestOnCapsule( const btCapsuleShape& capsule, const Vec3d& p )
{
	const int axis = capsule.getUpAxis();
	const double half = double( capsule.getHalfHeight() );
	Vec3d core = Vec3d::Zero();
	core[axis] = std::clamp( p[axis], -half, half );
	return fromCore( p - core, double( capsule.getRadius() ) );
}

bool nearestOnField( const btSdfCollisionShape& field, const Vec3d& p, Touch& touch )
{
	btScalar distance = 0;
	btVector3 normal( 0, 1, 0 );
	// queryPoint is not const but changes nothing.
	if ( !const_cast<btSdfCollisionShape&>( field ).queryPoint( toBullet( p ), distance, normal ) )
	{
		return false;
	}
	touch = Touch{ toEigen( normal ), double( distance ) };
	return true;
}

struct NearestPair : btDiscreteCollisionDetectorInterface::Result
{
	void setShapeIdentifiersA( int, int ) override {}
	void setShapeIdentifiersB( int, int ) override {}
	void addContactPoint( const btVector3& normalOnB, const btVector3&, btScalar depth ) override
	{
		normal = normalOnB;
		distance = depth;
		isFound = true;
	}
	btVector3 normal = btVector3( 0, 0, 0 );
	btScalar distance = 0;
	bool isFound = false;
};

bool nearestOnConvex( const Obstacle& obstacle, const MovingSphere& sphere, Touch& touch )
{
	const auto* convex = static_cast<const btConvexShape*>( obstacle.shape );
	// Bullet takes corners within a centimetre for one, and ends at a wrong corner of what is as small.
	const btScalar apart = kCornerFraction * largestExtent( *convex );
	btVoronoiSimplexSolver simplex;
	simplex.setEqualVertexThreshold( std::min( simplex.getEqualVertexThreshold(), apart * apart ) );
	btGjkEpaPenetrationDepthSolver depth;
	btGjkPairDetector detector( sphere.shape, convex, &simplex, &depth );
	btDiscreteCollisionDetectorInterface::ClosestPointInput input;
	input.m_transformA = btTransform( btMatrix3x3::getIdentity(), toBullet( sphere.centre ) );
	input.m_transformB = obstacle.transform();
	NearestPair pair;
	detector.getClosestPoints( input, pair, nullptr );
	// GJK used the shape's own radius, not the requested one.
	const double radius = sphere.scale > 0.0 ? double( sphere.shape->getRadius() ) : sphere.radius;
	touch = Touch{ toEigen( pair.normal ), double( pair.distance ) + radius };
	return pair.isFound;
}

} // namespace

bool findNearest( const Obstacle& obstacle, const MovingSphere& sphere, Touch& touch )
{
	const Vec3d p = obstacle.toLocal( sphere.centre );
	switch ( obstacle.shape->getShapeType() )
	{
		case STATIC_PLANE_PROXYTYPE: {
			const auto& plane = *static_cast<const btStaticPlaneShape*>( obstacle.shape );
			touch = Touch{
				toEigen( plane.getPlaneNormal() ), toEigen( plane.getPlaneNormal() ).dot( p ) - double( plane.getPlaneConstant() ) };
			break;
		}
		case SPHERE_SHAPE_PROXYTYPE:
			touch = fromCore( p, double( static_cast<const btSphereShape*>( obstacle.shape )->getRadius() ) );
			break;
		case BOX_SHAPE_PROXYTYPE:
			touch = nearestOnBox( toEigen( static_cast<const btBoxShape*>( obstacle.shape )->getHalfExtentsWithMargin() ), p );
			break;
		case CAPSULE_SHAPE_PROXYTYPE: touch = nearestOnCapsule( *static_cast<const btCapsuleShape*>( obstacle.shape ), p ); break;
		case SDF_SHAPE_PROXYTYPE:
			if ( !nearestOnField( *static_cast<const btSdfCollisionShape*>( obstacle.shape ), p, touch ) )
			{
				return false;
			}
			break;
		default: return obstacle.shape->isConvex() && nearestOnConvex( obstacle, sphere, touch );
	}
	touch.normal = obstacle.basis * touch.normal;
	return true;
}

namespace {

/// The point of a triangle nearest to p (Ericson, Real-Time Collision Detection, section 5.1.5: which of the seven regions p lies in).
Vec3d nearestInTriangle( const Vec3d ( &c )[3], const Vec3d& p )
{
	const Vec3d ab = c[1] - c[0], ac = c[2] - c[0], ap = p - c[0];
	const double d1 = ab.dot( ap ), d2 = ac.dot( ap );
	if ( d1 <= 0.0 && d2 <= 0.0 )
	{
		return c[0];
	}
	const Vec3d bp = p - c[1];
	const double d3 = ab.dot( bp ), d4 = ac.dot( bp );
	if ( d3 >= 0.0 && d4 <= d3 )
	{
		return c[1];
	}
	const double vc = d1 * d4 - d3 * d2;
	if ( vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 )
	{
		return c[0] + d1 / ( d1 - d3 ) * ab;
	}
	const Vec3d cp = p - c[2];
	const double d5 = ab.dot( cp ), d6 = ac.dot( cp );
	if ( d6 >= 0.0 && d5 <= d6 )
	{
		return c[2];
	}
	const double vb = d5 * d2 - d1 * d6;
	if ( vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 )
	{
		return c[0] + d2 / ( d2 - d6 ) * ac;
	}
	const double va = d3 * d6 - d5 * d4;
	if ( va <= 0.0 && d4 >= d3 && d5 >= d6 )
	{
		return c[1] + ( d4 - d3 ) / ( ( d4 - d3 ) + ( d5 - d6 ) ) * ( c[2] - c[1] );
	}
	const double area = va + vb + vc;
	return area > 0.0 ? Vec3d( c[0] + ( vb * ab + vc * ac ) / area ) : c[0];
}

/// Where a sphere in straight motion first meets a convex shape: the plane there represents the shape in this step. Conservative
/// advancement (Mirtich 1996, section 2.3.2): the sphere repeatedly advances up to the plane at the nearest point, behind which the shape
/// lies. Any of these planes that the sphere does not reach proves that it misses the shape, so that the result is valid after any
/// iteration. `find( sphere, touch )`: the nearest touch at the sphere's position.
template <class Find>
bool sweep( const MovingSphere& sphere, Touch& touch, const Find& find )
{
	MovingSphere now = sphere;
	double fraction = 0.0; // fraction of the displacement
	for ( int step = 0; step < kMostAdvances; ++step )
	{
		now.centre = sphere.centre + fraction * sphere.displacement;
		if ( !find( now, touch ) )
		{
			return false;
		}
		const double approach = -sphere.displacement.dot( touch.normal ), gap = touch.distance - sphere.radius;
		if ( gap <= kContactSlop * sphere.lengthScale() )
		{
			break;
		}
		if ( approach <= 0.0 || fraction + gap / approach > 1.0 )
		{
			return false;
		}
		fraction += gap / approach;
	}
	touch.distance -= fraction * sphere.displacement.dot( touch.normal );
	return true;
}

/// A slow or touching sphere meets the nearest plane of a convex shape; others meet the plane at the first contact.
template <class Find>
bool findConvexTouch( const MovingSphere& sphere, Touch& touch, const Find& find )
{
	if ( !find( sphere, touch ) )
	{
		return false;
	}
	if ( touch.distance <= sphere.touchDistance() || !sphere.isFast() )
	{
		return sphere.reaches( touch.normal, touch.distance );
	}
	return sweep( sphere, touch, find );
}

/// Returns a lower bound of the distance between a hull and a point, m: from the hull's middle on the point of the hull goes to the one
/// nearest on the way to its support, as in GJK, whose supports bound the distance too (Frank and Wolfe 1956). Ends above `enough`.
double leastDistance( const btConvexHullShape& hull, const btVector3& point, double enough )
{
	btVector3 low, high;
	hull.getAabb( btTransform::getIdentity(), low, high );
	btVector3 at = ( low + high ) / 2;
	double least = 0.0;
	for ( int k = 0; k < kHullProbes && least <= enough; ++k )
	{
		const btVector3 away = point - at;
		const btScalar length = away.length();
		if ( length == 0 )
		{
			break;
		}
		const btVector3 support = hull.localGetSupportingVertexWithoutMargin( away );
		least = std::max( least, double( away.dot( point - support ) / length - hull.getMargin() ) );
		const btVector3 along = support - at;
		at += along * btClamped( away.dot( along ) / btMax( along.length2(), SIMD_EPSILON ), btScalar( 0 ), btScalar( 1 ) );
	}
	return least;
}

/// Whether a sphere stays clear of a hull, or of its own box, by more than rounding: GJK is not needed then.
bool isClearOfHull( const Obstacle& obstacle, const MovingSphere& sphere )
{
	const double far = sphere.touchDistance() + sphere.displacement.norm() + double( kContactSlop ) * sphere.radius;
	return gapToOwnBox( obstacle, sphere.centre, sphere.centre ) > far ||
		leastDistance( *static_cast<const btConvexHullShape*>( obstacle.shape ), toBullet( obstacle.toLocal( sphere.centre ) ), far ) > far;
}

} // namespace

double gapToOwnBox( const Obstacle& obstacle, const Vec3d& from, const Vec3d& to )
{
	btVector3 low, high;
	obstacle.shape->getAabb( btTransform::getIdentity(), low, high );
	const Vec3d a = obstacle.toLocal( from ), b = obstacle.toLocal( to );
	return ( toEigen( low ) - a.cwiseMax( b ) ).cwiseMax( a.cwiseMin( b ) - toEigen( high ) ).maxCoeff();
}

btScalar largestExtent( const btCollisionShape& shape )
{
	btVector3 low, high;
	shape.getAabb( btTransform::getIdentity(), low, high );
	const btVector3 extent = high - low;
	return extent[extent.maxAxis()];
}

PatchObstacle PatchObstacle::of( const btCollisionShape& shape, double extent )
{
	PatchObstacle obstacle;
	const int type = shape.getShapeType();
	obstacle.isSmall = extent < kEdgeThing;
	obstacle.isRound = obstacle.isSmall ? type == SPHERE_SHAPE_PROXYTYPE : !shape.isPolyhedral();
	obstacle.rounding = type == CAPSULE_SHAPE_PROXYTYPE ? double( shape.getMargin() ) : 0.0;
	return obstacle;
}

btTransform Obstacle::transform() const
{
	const Eigen::Matrix3d& m = basis;
	return btTransform(
		btMatrix3x3( btScalar( m( 0, 0 ) ), btScalar( m( 0, 1 ) ), btScalar( m( 0, 2 ) ), btScalar( m( 1, 0 ) ), btScalar( m( 1, 1 ) ),
			btScalar( m( 1, 2 ) ), btScalar( m( 2, 0 ) ), btScalar( m( 2, 1 ) ), btScalar( m( 2, 2 ) ) ),
		toBullet( position ) );
}

bool findTouch( const Obstacle& obstacle, const MovingSphere& sphere, Touch& touch )
{
	const auto find = [&obstacle]( const MovingSphere& at, Touch& found ) { return findNearest( obstacle, at, found ); };
	if ( !obstacle.shape->isConvex() )
	{
		return find( sphere, touch ) && sphere.reaches( touch.normal, touch.distance );
	}
	if ( obstacle.shape->getShapeType() == CONVEX_HULL_SHAPE_PROXYTYPE && isClearOfHull( obstacle, sphere ) )
	{
		return false;
	}
	return findConvexTouch( sphere, touch, find );
}

bool lookAhead( const Obstacle& then, const MovingSphere& sphere, const Ahead& ahead, Touch& touch )
{
	MovingSphere there = sphere;
	there.centre += ahead.displacement;
	Touch found;
	if ( !findNearest( then, there, found ) )
	{
		return true;
	}
	const double least = kAheadFraction * sphere.radius, distance = found.distance - ahead.relativeDisplacement.dot( found.normal );
	if ( found.distance < least || distance < least )
	{
		return true;
	}
	touch = Touch{ found.normal, distance };
	return sphere.reaches( touch.normal, touch.distance );
}

FarPlane::FarPlane( const Obstacle& plane )
{
	const auto& shape = *static_cast<const btStaticPlaneShape*>( plane.shape );
	m_normal = plane.basis * toEigen( shape.getPlaneNormal() );
	m_constant = m_normal.dot( plane.position ) + double( shape.getPlaneConstant() );
}

bool FarPlane::areClear( const NodeState& nodes, int first, double step, double radius ) const
{
	using Block = Eigen::Array<float, kBlock, 1>;
	const auto block = [first]( const AlignedArray<float>& all ) { return Eigen::Map<const Block>( all.data() + first ); };
	const Vec3 normal = m_normal.cast<float>(), moved = normal * float( step );
	const auto x = block( nodes.x.x ), y = block( nodes.x.y ), z = block( nodes.x.z );
	const auto u = block( nodes.v.x ), v = block( nodes.v.y ), w = block( nodes.v.z );
	const Block height = x * normal.x() + y * normal.y() + z * normal.z();
	const Block rise = u * moved.x() + v * moved.y() + w * moved.z();
	const float lowest = ( height + rise.min( 0.0f ) ).minCoeff();
	const float size = ( x.abs() + y.abs() + z.abs() + float( step ) * ( u.abs() + v.abs() + w.abs() ) ).maxCoeff();
	return double( lowest ) - m_constant - kBlockRounding * double( size ) > radius * kGrown;
}

FarSolid::FarSolid( const Obstacle& solid ) : m_basis( solid.basis ), m_position( solid.position )
{
	if ( solid.shape->getShapeType() == SPHERE_SHAPE_PROXYTYPE )
	{
		m_radius = double( static_cast<const btSphereShape*>( solid.shape )->getRadius() );
		return;
	}
	btVector3 low, high;
	solid.shape->getAabb( btTransform::getIdentity(), low, high );
	m_middle = toEigen( low + high ) / 2.0;
	m_half = toEigen( high - low ) / 2.0;
}

BoxTouch::BoxTouch( const Obstacle& box ) :
	m_box( box ), m_half( toEigen( static_cast<const btBoxShape*>( box.shape )->getHalfExtentsWithMargin() ) )
{}

const double FarPlane::kGrown = ( 1.0 + kContactSlop ) * ( 1.0 + kFarSlack );

bool findBallTouch( double radius, const Vec3d& at, const MovingSphere& sphere, Touch& touch )
{
	const Vec3d apart = sphere.centre - at;
	const double touchDistance = sphere.touchDistance() + radius;
	const double square = apart.squaredNorm();
	if ( square > touchDistance * touchDistance )
	{
		// Out of reach for any direction of motion, without a root.
		const double farthest = touchDistance + std::sqrt( sphere.displacement.squaredNorm() );
		if ( square > farthest * farthest )
		{
			return false;
		}
	}
	return findConvexTouch( sphere, touch, [&]( const MovingSphere& now, Touch& found ) { return findNearest( radius, at, now, found ); } );
}

bool findNearest( double radius, const Vec3d& at, const MovingSphere& sphere, Touch& touch )
{
	touch = fromCore( sphere.centre - at, radius );
	return true;
}

bool findTouch( const Vec3d ( &corners )[3], const MovingSphere& sphere, Touch& touch )
{
	return findConvexTouch(
		sphere, touch, [&corners]( const MovingSphere& now, Touch& found ) { return findNearest( corners, now, found ); } );
}

bool findNearest( const Vec3d ( &corners )[3], const MovingSphere& sphere, Touch& touch )
{
	touch = fromCore( sphere.centre - nearestInTriangle( corners, sphere.centre ), 0.0 );
	return true;
}

} // namespace pliant
