#pragma once

// Rays and moving spheres against a triangle, in closed form.

#include "lattice/lattice.h"

namespace pliant {

/// Where something that moves meets a triangle.
struct TriangleHit
{
	double fraction = 1.0;         ///< of the path
	Vec3d point = Vec3d::Zero();   ///< on the triangle
	Vec3d normal = Vec3d::Zero();  ///< unit; of the triangle (rays), or from `point` to the sphere's centre
	Vec3d weights = Vec3d::Zero(); ///< of the corners at `point`, sum 1
};

/// A ray from `from` by `along`. Borders belong to the triangle, so that no ray passes between two that share an edge. `normal` is that of
/// the corners' order, for rays from either side. False beyond `limit`.
bool meets( const Vec3d& from, const Vec3d& along, const Vec3d ( &corner )[3], double limit, TriangleHit& hit );

/// A sphere that moves from `from` by `along`. One that overlaps the triangle already meets it at 0, unless it moves away. False beyond
/// `limit`.
bool meets( const Vec3d& from, const Vec3d& along, double radius, const Vec3d ( &corner )[3], double limit, TriangleHit& hit );

/// The point of a triangle nearest to `to`, as weights of the corners.
Vec3d nearestWeights( const Vec3d& to, const Vec3d ( &corner )[3] );

} // namespace pliant
