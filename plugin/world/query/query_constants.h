#pragma once

// Constants of the drawn surface as a shape, and of rays, sweeps and contact tests against it.

#include <LinearMath/btScalar.h>

namespace pliant {

/// A triangle whose normal differs by more than this from the mean of those around its corner, 25 degrees, is at a crease: the facets of
/// round meshes differ by up to 20, the faces of a box by 45 and more.
inline constexpr float kCreaseCosine = 0.906f;

/// An object is behind a triangle that it touches where the cosine of the angle between their normals is below the negative of this.
inline constexpr btScalar kBehindCosine = btScalar( 0.5 );

/// Contact tests divide the triangles near an object to the size of a cell, but no more often than this: of a body that has been stretched
/// or thrown to 1e24 m they would never end.
inline constexpr int kMostSurfaceSplits = 100000;

// --- Rays, sweeps and contact tests ---

/// The drawn surface is at most this many radii of the largest node beyond the nodes' spheres: corners of cubes are, sqrt( 3 ) - 1, and a
/// little for the skin, which follows several nodes.
inline constexpr double kDrawnBeyondSpheres = 0.8;
/// Corners whose normals are within this cosine of their triangle's, 40 degrees, belong to a smooth surface; others to an edge.
inline constexpr double kSmoothCosine = 0.766;
/// A ray meets a triangle up to this weight beyond its borders: rounding of points on a border that two triangles share.
inline constexpr double kTriangleBorder = 1e-9;
/// Smallest area, m^2 (squared: m^4), and length that is divided by.
inline constexpr double kNoArea = 1e-60;
/// A sphere that may penetrate deeper than its radius is swept with this fraction of its radius.
inline constexpr double kLeastSweptRadius = 1e-3;
/// Points of a surface whose distances differ by a smaller fraction are equally near: an edge seen from the triangles that share it.
inline constexpr double kEqualDistance = 1e-6;
/// A search around a point begins with a node's radius and is doubled at most so many times.
inline constexpr int kMostDoublings = 40;

} // namespace pliant
