#pragma once

// Pairs of cells as compressed rows, for finding neighbours of neighbours.

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace pliant {

using CellPair = std::pair<std::uint32_t, std::uint32_t>;

/// Neighbours of every cell, both directions, each row ascending.
struct NeighbourRows
{
	std::vector<std::uint32_t> start;
	std::vector<std::uint32_t> to;

	const std::uint32_t* begin( std::size_t i ) const { return to.data() + start[i]; }
	const std::uint32_t* end( std::size_t i ) const { return to.data() + start[i + 1]; }
	bool has( std::size_t i, std::uint32_t j ) const { return std::binary_search( begin( i ), end( i ), j ); }
};

/// Each pair occurs once in `pairs`, in any order.
NeighbourRows makeNeighbourRows( const std::vector<std::vector<CellPair>>& pairs, std::size_t count );

} // namespace pliant
