#include "surface/crack_shapes/table.h"

#include <algorithm>

namespace pliant {

Table makeTable( const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs, std::size_t rows )
{
	Table all;
	all.start.assign( rows + 1, 0 );
	for ( const auto& pair : pairs )
	{
		++all.start[pair.first + 1];
	}
	for ( std::size_t r = 0; r < rows; ++r )
	{
		all.start[r + 1] += all.start[r];
	}
	all.entry.resize( pairs.size() );
	std::vector<std::uint32_t> next( all.start.begin(), all.start.end() - 1 );
	for ( const auto& [row, entry] : pairs )
	{
		all.entry[next[row]++] = entry;
	}
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

Table turned( const Table& table, std::size_t rows )
{
	Table out;
	out.start.assign( rows + 1, 0 );
	out.entry.resize( table.entry.size() );
	for ( const std::uint32_t entry : table.entry )
	{
		++out.start[entry + 1];
	}
	for ( std::size_t r = 0; r < rows; ++r )
	{
		out.start[r + 1] += out.start[r];
	}
	std::vector<std::uint32_t> next( out.start.begin(), out.start.end() - 1 );
	for ( std::uint32_t row = 0; row + 1 < table.start.size(); ++row )
	{
		for ( const std::uint32_t* e = table.begin( row ); e != table.end( row ); ++e )
		{
			out.entry[next[*e]++] = row;
		}
	}
	return out;
}

} // namespace pliant
