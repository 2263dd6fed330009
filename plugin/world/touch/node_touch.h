#pragma once

// Contact of a node's sphere with an obstacle within a step: in closed form where possible, by Bullet's GJK for other convex shapes.
// Everything is in double precision and relative to the soft body's origin, so that far from the world's origin nothing changes.

#include "lattice/lattice.h"
#include "matching/node_state.h"
#include "world/constants.h"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btTransform.h>

#include <Eigen/Geometry>

#include <algorithm>

class btSphereShape;

namespace pliant {

/// Longest edge of a shape's box in its own frame, m, so that it does not depend on how the shape is turned.
btScalar largestExtent( const btCollisionShape& shape );

/// One simple shape in a soft body's coordinates; a compound consists of several.
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
	Vec3d displacement = Vec3d::Zero(); ///< of the node relative to the obstacle in this step, m
	double radius = 0.0;                ///< m
	const btSphereShape* shape = nullptr;
	double scale = 0.0;        ///< m, length scale of slack and of fast motion; 0: the radius
	double pressedReach = 0.0; ///< m, how far from the obstacle a node still touches that pressed it in the last substep

	double lengthScale() const { return scale > 0.0 ? scale : radius; }
	/// Distance of the centre up to which the sphere counts as touching.
	double touchDistance() const
	{
		return ( scale > 0.0 ? radius + kContactSlop * scale : radius * ( 1.0 + kContactSlop ) ) + pressedReach;
	}
	/// The nearest touch counts where the sphere touches it, nearly touches it, or reaches it in this step.
	bool reaches( const Vec3d& normal, double distance ) const
	{
		return distance <= touchDistance() + std::max( 0.0, -normal.dot( displacement ) );
	}
	/// It moves so far that the nearest point now need not be the point it will hit.
	bool isFast() const { return displacement.squaredNorm() > kFastFraction * kFastFraction * lengthScale() * lengthScale(); }
};

struct Touch
{
	Vec3d normal = Vec3d::Zero(); ///< out of the obstacle, towards the node
	double distance = 0.0;        ///< of the node's centre from the obstacle's surface, along the normal, m; negative inside
	Vec3d aside = Vec3d::Zero();  ///< lateral offset of the surface point from the node's line along the normal, m (contact_surface.h)
	double reach = -1.0; ///< of that point from the node's centre against the normal, m; negative: the touch is of the node's own sphere

	/// Contact points of the body and of the obstacle, from the node's centre. `radius`: of the node's own sphere, m.
	Vec3d ownPoint( double radius ) const { return aside - ( reach < 0.0 ? radius : reach ) * normal; }
	Vec3d otherPoint( double radius ) const { return aside - ( ( reach < 0.0 ? 0.0 : reach - radius ) + distance ) * normal; }
};

/// Properties of an obstacle that a test against a patch needs.
struct PatchObstacle
{
	bool isSmall = false;  ///< smaller than kEdgeThing, so that several nodes must carry it
	bool isRound = false;  ///< it touches where its own normal is: no polyhedron, or, of small objects, a sphere
	double rounding = 0.0; ///< m, radius of a small capsule

	/// `extent`: the shape's largest, in cells of the node that it touches.
	static PatchObstacle of( const btCollisionShape& shape, double extent );

	/// In front of a plane, cells.
	double planeDepth() const { return isSmall ? kSmallPlaneDepth : kPlaneDepth; }
	double planeHalfWidth() const { return isSmall ? kSmallPlaneHalfWidth : kPlaneHalfWidth; }
};

/// The point of a plane or a convex shape nearest to a sphere's centre, as a touch. False for other shapes.
bool findNearest( const Obstacle& obstacle, const MovingSphere& sphere, Touch& touch );
/// Returns the gap along an axis between a convex shape's own box, which is tight for thin hulls, and the box of two points, m: the largest
/// of the axes of the shape; below 0 where the boxes overlap.
double gapToOwnBox( const Obstacle& obstacle, const Vec3d& from, const Vec3d& to );
/// The nearest point of a triangle; corners relative to the soft body's origin.
bool findNearest( const Vec3d ( &corners )[3], const MovingSphere& sphere, Touch& touch );

/// The nearest point of a sphere of radius `radius` around `at`.
bool findNearest( double radius, const Vec3d& at, const MovingSphere& sphere, Touch& touch );

/// The touch of a sphere with a plane or a convex shape in this step. False where there is none.
bool findTouch( const Obstacle& obstacle, const MovingSphere& sphere, Touch& touch );

/// Displacement of a sphere until the step's end at its last velocity, absolute and relative to the obstacle, m.
struct Ahead
{
	Vec3d displacement = Vec3d::Zero(), relativeDisplacement = Vec3d::Zero();
};

/// Replaces a touch with a convex shape by the plane at the positions at the step's end, `then` the shape's. An edge that slides over a
/// sphere has a slanted plane in front of it until it is over the sphere's top; a contact that is solved for the step's end must not be
/// held back by that plane.
///   n, d1 of the nearest point then;   d = d1 - n . w,   w the relative displacement;   used where d, d1 >= r / 2
/// Then the plane lies between shape and centre throughout the step. False where the sphere does not reach that plane.
bool lookAhead( const Obstacle& then, const MovingSphere& sphere, const Ahead& ahead, Touch& touch );

/// A plane that rejects distant spheres at less cost than a contact test, for tests of many spheres.
class FarPlane
{
public:
	/// `plane`: of type STATIC_PLANE_PROXYTYPE.
	explicit FarPlane( const Obstacle& plane );
	/// True for no sphere that findTouch reports as touching, and for all others but for rounding error. `radius` is an upper bound. The
	/// negation of MovingSphere::reaches:   n . x - c + min( 0, n . w ) > r ( 1 + slop )
	bool isClear( const Vec3d& centre, const Vec3d& displacement, double radius ) const
	{
		return m_normal.dot( centre ) - m_constant + std::min( 0.0, m_normal.dot( displacement ) ) > radius * kGrown;
	}
	/// True only if isClear holds for each of kBlock nodes from `first` on, displaced by their velocities in a step of length `step`, s. In
	/// single precision, with a margin for its rounding.
	bool areClear( const NodeState& nodes, int first, double step, double radius ) const;
	static constexpr int kBlock = kLanes;

private:
	static const double kGrown;
	Vec3d m_normal;
	double m_constant;
};

/// A solid that rejects distant spheres by its own box, or of a ball by its centre, at less cost than a contact test.
class FarSolid
{
public:
	explicit FarSolid( const Obstacle& solid );
	/// True only if every point of the solid is farther than `reach`, m, from a point.
	bool isClear( const Vec3d& point, double reach ) const
	{
		const Vec3d p = m_basis.transpose() * ( point - m_position ) - m_middle;
		const double farthest = m_radius + reach;
		return m_radius > 0.0 ? p.squaredNorm() > farthest * farthest : ( p.cwiseAbs() - m_half ).maxCoeff() > reach;
	}

private:
	Eigen::Matrix3d m_basis;
	Vec3d m_position, m_middle = Vec3d::Zero(), m_half = Vec3d::Zero(); ///< of the box, in the solid's frame, m
	double m_radius = 0.0;                                              ///< of a ball, m
};

/// The touch with a sphere around `at`: the result of findTouch at less cost.
bool findBallTouch( double radius, const Vec3d& at, const MovingSphere& sphere, Touch& touch );

/// The touch with a triangle of a mesh; corners relative to the soft body's origin. Both sides count.
bool findTouch( const Vec3d ( &corners )[3], const MovingSphere& sphere, Touch& touch );

} // namespace pliant
