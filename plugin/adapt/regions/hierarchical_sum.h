#pragma once

// Sums over regions through the octree. Steinemann et al. 2008, section 4.3: the operator HF, a depth pass and a breadth pass. It serves
// both directions: regions gather from nodes (eq. 6 and 7), and, membership being symmetric, nodes gather from regions (eq. 8).

#include "adapt/regions/interval_regions.h"

namespace pliant {

/// Floats in a record: 12 of payload (a 3 x 3 matrix and a vector), padded to a cache line as in the step's kernels.
inline constexpr int kSumFloats = 16;

/// The order of summation. Records of the slots come first, then those of the virtual nodes in regions and of all virtual nodes below them,
/// children before parents.
struct SumPlan
{
	int slots = 0;
	int virtualNodes = 0;
	std::vector<std::uint32_t> childStart, child; ///< of virtual node v, record slots + v: the records it is the sum of
	std::vector<std::uint32_t> start, term;       ///< of region r: the records of its summation nodes

	int records() const { return slots + virtualNodes; }
};

SumPlan planSums( const Octree& octree, const Cut& cut, const IntervalRegions& intervals );

/// Fills the records of virtual nodes from those of the slots. `records`: plan.records() of kSumFloats floats.
void depthSum( const SumPlan& plan, float* records );
/// The same for records of half as many floats.
void depthSumHalf( const SumPlan& plan, float* records );

} // namespace pliant
