// Counting sort of pairs into rows.

#include "lattice/neighbour_rows.h"

namespace pliant {

NeighbourRows makeNeighbourRows( const std::vector<std::vector<CellPair>>& pairs, std::size_t count )
{
	NeighbourRows rows;
	rows.start.assign( count + 1, 0 );
	for ( const auto& some : pairs )
	{
		for ( const auto& [a, b] : some )
		{
			++rows.start[a + 1];
			++rows.start[b + 1];
		}
	}
	for ( std::size_t i = 0; i < count; ++i )
	{
		rows.start[i + 1] += rows.start[i];
	}
	rows.to.resize( rows.start.back() );
	std::vector<std::uint32_t> next( rows.start.begin(), rows.start.end() - 1 );
	for ( const auto& some : pairs )
	{
		for ( const auto& [a, b] : some )
		{
			rows.to[next[a]++] = b;
			rows.to[next[b]++] = a;
		}
	}
	for ( std::size_t i = 0; i < count; ++i )
	{
		std::sort( rows.to.begin() + rows.start[i], rows.to.begin() + rows.start[i + 1] );
	}
	return rows;
}

} // namespace pliant
