#pragma once

// Where a node's sphere meets an obstacle within a step: closed forms where there are any, Bullet's GJK for other convex shapes.
// Everything is relative to the soft body's origin and in double: a kilometre out a float world still rests where it rests at home.

#include "lattice/lattice.h"
#include "world/constants.h"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btTransform.h>

#include <Eigen/Geometry>

#include <algorithm>

class btSphereShape;

namespace pliant {

/// One simple shape as a soft body sees it; a compound is several of them.
struct Obstacle
{
	const btCollisionShape* shape = nullptr;
	Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();
	Vec3d position = Vec3d::Zero(); ///< relative to the soft body's origin, m
	int part = -1;                  ///< Bullet's identifiers of the shape, for contact callbacks
	int index = -1;

	Vec3d toLocal( const Vec3d& p ) const { return basis.transpose() * ( p - position ); }
	btTransform transform() const; ///< relative to the soft body's origin
};

struct MovingSphere
{
	Vec3d centre = Vec3d::Zero();
	Vec3d way = Vec3d::Zero(); ///< what the node moves in this step against the obstacle, m
	double radius = 0.0;       ///< m
	const btSphereShape* shape = nullptr;
	double scale = 0.0; ///< m, that slack and fast motion are measured by; 0: the radius

	double measure() const { return scale > 0.0 ? scale : radius; }
	/// So near counts as touching.
	double touching() const { return scale > 0.0 ? radius + kContactSlop * scale : radius * ( 1.0 + kContactSlop ); }
	/// The nearest touch counts when the sphere touches it, nearly touches it, or comes that far in this step.
	bool reaches( const Vec3d& normal, double distance ) const { return distance <= touching() + std::max( 0.0, -normal.dot( way ) ); }
	/// It moves so far that the place it is nearest to now need not be the place it hits.
	bool isFast() const { return way.squaredNorm() > kFastFraction * kFastFraction * measure() * measure(); }
};

struct Touch
{
	Vec3d normal = Vec3d::Zero(); ///< out of the obstacle, towards the node
	double distance = 0.0;        ///< of the node's centre from the surface it meets, along the normal, m; negative inside
	Vec3d aside =
		Vec3d::Zero();   ///< from the node's line along the normal to the point of the body's surface that touches, m (contact_surface.h)
	double reach = -1.0; ///< of that point from the node's centre against the normal, m; negative: it is the node's own sphere's

	/// From the node's centre to the points that touch, of the body and of what it meets. `radius`: of the node's own sphere, m.
	Vec3d ownPoint( double radius ) const { return aside - ( reach < 0.0 ? radius : reach ) * normal; }
	Vec3d otherPoint( double radius ) const { return aside - ( ( reach < 0.0 ? 0.0 : reach - radius ) + distance ) * normal; }
};

/// The point of a plane or a convex shape nearest to a sphere's centre, as a touch. False where the shape is neither.
bool findNearest( const Obstacle& obstacle, const MovingSphere& sphere, Touch& touch );
/// The same of a triangle; corners relative to the soft body's origin.
bool findNearest( const Vec3d ( &corners )[3], const MovingSphere& sphere, Touch& touch );

/// The same of a sphere of radius `radius` around `at`.
bool findNearest( double radius, const Vec3d& at, const MovingSphere& sphere, Touch& touch );

/// The touch of a sphere with a plane or a convex shape in this step. False when it meets nothing.
bool findTouch( const Obstacle& obstacle, const MovingSphere& sphere, Touch& touch );

/// Where a sphere will be at the step's end by how it moved last, m: `to` from where it is, and by `way` against the obstacle.
struct Ahead
{
	Vec3d to = Vec3d::Zero(), way = Vec3d::Zero();
};

/// Of a touch with a convex shape that findTouch has found: the plane where the sphere will be, with the shape as it will be, `then`. An
/// edge that slides over a sphere has a slanted plane in front of it as long as it is not over it, and a contact that is solved for the
/// step's end must not be held back by it.
///   n, d1 of the nearest point then;   d = d1 - n . way;   taken where d, d1 >= r / 2: so the plane lies between shape and centre all the
///   way
/// False when the sphere does not come to touch that plane.
bool lookAhead( const Obstacle& then, const MovingSphere& sphere, const Ahead& ahead, Touch& touch );

/// A plane to those who ask it for many spheres: most are far from it, and that takes less to say than where they would touch.
class FarPlane
{
public:
	/// `plane`: of type STATIC_PLANE_PROXYTYPE.
	explicit FarPlane( const Obstacle& plane );
	/// Never of a sphere that findTouch finds to touch; of all others, but for rounding. It has a centre, a way, and `radius` at most. What
	/// MovingSphere::reaches asks, the other way round:   n . x - c + min( 0, n . w ) > r ( 1 + slop )
	bool isClear( const Vec3d& centre, const Vec3d& way, double radius ) const
	{
		return m_normal.dot( centre ) - m_constant + std::min( 0.0, m_normal.dot( way ) ) > radius * kGrown;
	}

private:
	static const double kGrown;
	Vec3d m_normal;
	double m_constant;
};

/// The touch with a sphere around `at`: what findTouch would say of it, sooner.
bool findBallTouch( double radius, const Vec3d& at, const MovingSphere& sphere, Touch& touch );

/// The touch with a triangle of a mesh; corners relative to the soft body's origin. Both sides count.
bool findTouch( const Vec3d ( &corners )[3], const MovingSphere& sphere, Touch& touch );

} // namespace pliant
