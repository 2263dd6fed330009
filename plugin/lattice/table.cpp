#include "lattice/table.h"

namespace pliant {

Table makeTable( const std::vector<NumberPair>& pairs, std::size_t rows )
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

Table makeNeighbourTable( const std::vector<std::vector<NumberPair>>& pairs, std::size_t rows )
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

Table turned( const Table& table, std::size_t rows )
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
