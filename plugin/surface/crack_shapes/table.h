#pragma once

// Rows of numbers of different lengths in one array.

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

/// Makes a table from unordered pairs of row and entry. The entries of a row are ascending and unique.
Table makeTable( const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs, std::size_t rows );

/// The inverse table: for each entry below `rows` the rows that contain it.
Table turned( const Table& table, std::size_t rows );

} // namespace pliant
