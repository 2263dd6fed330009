#pragma once

// Constants of the collision shapes of bodies and of their trees.

#include <LinearMath/btScalar.h>

namespace pliant {

/// Inserting leaves one by one takes twenty times as long as building a tree: above this fraction of inserted leaves the tree is rebuilt.
inline constexpr double kMostInserted = 0.05;
/// Removing spheres one by one is faster than rebuilding as long as this fraction of a body remains.
inline constexpr double kLeastRemaining = 0.8;

/// Extents of a part of the tree that differ by a smaller fraction are equal: rounding must not decide along which axis it is divided.
inline constexpr btScalar kEqualExtents = btScalar( 1e-3 );

} // namespace pliant
