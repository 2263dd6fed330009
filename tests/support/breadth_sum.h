#pragma once

#include "adapt/regions/hierarchical_sum.h"

#include <algorithm>
#include <functional>

namespace pliant::test {

/// Writes the sum of each region's records to sums + r kSumFloats: what the step's kernels do as they read them.
inline void breadthSum( const SumPlan& plan, const float* records, float* sums )
{
	for ( std::size_t r = 0; r < std::size_t( plan.slots ); ++r )
	{
		float* const sum = sums + r * kSumFloats;
		std::fill_n( sum, kSumFloats, 0.0f );
		for ( std::uint32_t k = plan.start[r]; k < plan.start[r + 1]; ++k )
		{
			const float* const term = records + plan.term[k] * std::size_t( kSumFloats );
			std::transform( term, term + kSumFloats, sum, sum, std::plus<>() );
		}
	}
}

} // namespace pliant::test
