#pragma once

// Rows of numbers of different lengths, one after the other.

#include <cstdint>
#include <utility>
#include <vector>

namespace pliant {

/// Row i is entry[ start[i] ] .. entry[ start[i + 1] - 1 ].
struct Table
{
	std::vector<std::uint32_t> start;
	std::vector<std::uint32_t> entry;

	const std::uint32_t* begin( std::size_t row ) const { return entry.data() + start[row]; }
	const std::uint32_t* end( std::size_t row ) const { return entry.data() + start[row + 1]; }
	std::uint32_t size( std::size_t row ) const { return start[row + 1] - start[row]; }
};

/// Pairs of row and entry, in any order, as rows of ascending entries, each once.
Table makeTable( const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs, std::size_t rows );

/// The other way round: by entry, below `rows`, the rows it stands in.
Table turned( const Table& table, std::size_t rows );

} // namespace pliant
