#pragma once

// Constants of the octree, its regions and their moments, each with its unit and reason.

#include <cstdint>

namespace pliant {

/// Maximum number of levels above the finest: with 8^4 cells in one node, region masses fit in 32 bits (kMassUnit).
inline constexpr int kMaxCoarseLevels = 4;

/// Time between merges of nodes, as a fraction of Adaptivity::mergeDelay: all that are due within it merge together, since each change of
/// levels costs nearly as much for a few nodes as for many.
inline constexpr float kMergeTogether = 0.5f;

/// Approximate fraction of a full finest cell's mass: 8^4 cells fit 32 bits. A cell's mass is not an integer multiple of it; the weight of
/// a node's unit is corrected per node (RegionMatrix::unit), so that its parts add up to its mass.
inline constexpr double kMassUnit = 1.0 / ( 1 << 19 );

/// Regions by intervals: eps of Steinemann et al. 2008, as they chose it; a smaller value approximates w better, a larger one needs fewer
/// summation nodes.
inline constexpr float kIntervalEps = 0.5f;
/// Searches for regions per task: enough to justify its scratch.
inline constexpr std::uint32_t kRegionsPerTask = 256;

/// Largest beta and eta: some stiffness always remains.
inline constexpr double kLargestSoftness = 0.95;
/// Eigenvalues of J below this fraction of the largest are treated as zero.
inline constexpr double kMomentFraction = 1e-2;
/// A matrix whose determinant is at least this fraction of the maximum for its trace has no eigenvalue below kMomentFraction of its
/// largest: with eigenvalues a >= b >= c, det = a b c <= a^2 c and ( tr / 3 )^3 >= ( a / 3 )^3, so c / a >= fraction / 27.
inline constexpr double kSolidFraction = 27.0 * kMomentFraction;

/// Capacity of the moments array over its size: nearly every crack adds nodes, and without a reserve each would copy all moments.
inline constexpr double kMomentsCapacity = 1.25;

} // namespace pliant
