#include "matching/regions/connected_parts.h"

#include "lattice/table.h"
#include "lattice/union_find.h"
#include "matching/regions/region_members.h"

namespace pliant {

ConnectedParts findConnectedParts( const RegionTables& tables, const MatchView& view )
{
	const std::size_t count = std::size_t( view.nodeCount );
	const RegionMembers members( tables, view );
	UnionFind sets( count );
	for ( std::size_t i = 0; i < count; ++i )
	{
		members.visit( i, [&]( std::size_t other, std::size_t ) { sets.join( std::uint32_t( i ), std::uint32_t( other ) ); } );
	}
	ConnectedParts parts;
	parts.of.resize( count );
	std::uint32_t found = 0;
	for ( std::size_t i = 0; i < count; ++i )
	{
		const std::uint32_t lowest = sets.find( std::uint32_t( i ) ); // lowest node of the part, so it is numbered already
		parts.of[i] = lowest == i ? found++ : parts.of[lowest];
	}
	if ( found <= 1 )
	{
		return {};
	}
	const auto forNodes = [&parts]( auto&& visit ) {
		for ( std::uint32_t i = 0; i < std::uint32_t( parts.of.size() ); ++i )
		{
			visit( parts.of[i], i );
		}
	};
	sortIntoRows( found, forNodes, parts.start, parts.node );
	return parts;
}

} // namespace pliant
