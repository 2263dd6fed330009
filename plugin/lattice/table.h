#pragma once

// Rows of different lengths in one array.

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace pliant {

/// Sorts items into rows by counting: row i becomes item[ start[i] ] .. item[ start[i + 1] - 1 ], in the order of the visits. `forEach(
/// visit )` calls visit( row, item ) for every item; it is called twice.
template <class Item, class ForEach>
void sortIntoRows( std::size_t rows, ForEach&& forEach, std::vector<std::uint32_t>& start, std::vector<Item>& item )
{
	start.assign( rows + 1, 0 );
	forEach( [&start]( std::size_t row, const Item& ) { ++start[row + 1]; } );
	std::partial_sum( start.begin(), start.end(), start.begin() );
	item.resize( start.back() );
	std::vector<std::uint32_t> next( start.begin(), start.end() - 1 );
	forEach( [&]( std::size_t row, const Item& each ) { item[next[row]++] = each; } );
}

/// Rows of numbers: row i is entry[ start[i] ] .. entry[ start[i + 1] - 1 ].
struct Table
{
	std::vector<std::uint32_t> start;
	std::vector<std::uint32_t> entry;

	const std::uint32_t* begin( std::size_t row ) const { return entry.data() + start[row]; }
	const std::uint32_t* end( std::size_t row ) const { return entry.data() + start[row + 1]; }
	std::uint32_t size( std::size_t row ) const { return start[row + 1] - start[row]; }
	/// Where rows ascend.
	bool has( std::size_t row, std::uint32_t wanted ) const { return std::binary_search( begin( row ), end( row ), wanted ); }
};

using NumberPair = std::pair<std::uint32_t, std::uint32_t>;

/// Makes a table from unordered pairs of row and entry. The entries of a row are ascending and unique.
inline Table makeTable( const std::vector<NumberPair>& pairs, std::size_t rows )
{
	Table all;
	const auto forPairs = [&pairs]( auto&& visit ) {
		for ( const auto& [row, entry] : pairs )
		{
			visit( row, entry );
		}
	};
	sortIntoRows( rows, forPairs, all.start, all.entry );
	// Sorts each row, removes duplicates and closes the gaps.
	std::uint32_t kept = 0;
	for ( std::size_t r = 0; r < rows; ++r )
	{
		const auto first = all.entry.begin() + all.start[r], last = all.entry.begin() + all.start[r + 1];
		std::sort( first, last );
		const auto end = std::unique( first, last );
		all.start[r] = kept;
		kept = std::uint32_t( std::move( first, end, all.entry.begin() + kept ) - all.entry.begin() );
	}
	all.start[rows] = kept;
	all.entry.resize( kept );
	return all;
}

/// The neighbours of every row, both directions, each row ascending. Each pair occurs once in `pairs`, in any order.
inline Table makeNeighbourTable( const std::vector<std::vector<NumberPair>>& pairs, std::size_t rows )
{
	Table table;
	const auto forBothDirections = [&pairs]( auto&& visit ) {
		for ( const std::vector<NumberPair>& some : pairs )
		{
			for ( const auto& [a, b] : some )
			{
				visit( a, b );
				visit( b, a );
			}
		}
	};
	sortIntoRows( rows, forBothDirections, table.start, table.entry );
	for ( std::size_t r = 0; r < rows; ++r )
	{
		std::sort( table.entry.begin() + table.start[r], table.entry.begin() + table.start[r + 1] );
	}
	return table;
}

/// The inverse table: for each entry below `rows` the rows that contain it.
inline Table turned( const Table& table, std::size_t rows )
{
	Table out;
	const auto forEntries = [&table]( auto&& visit ) {
		for ( std::uint32_t row = 0; row + 1 < table.start.size(); ++row )
		{
			std::for_each( table.begin( row ), table.end( row ), [&]( std::uint32_t entry ) { visit( entry, row ); } );
		}
	};
	sortIntoRows( rows, forEntries, out.start, out.entry );
	return out;
}

} // namespace pliant
