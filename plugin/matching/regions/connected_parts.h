#pragma once

// A body whose cells form several unlinked parts: quantities that are conserved or removed for a whole body (rigid motion, momentum,
// damping) are conserved and removed for each part separately.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

struct MatchView;
struct RegionTables;

/// The nodes of each part. Empty for a body in one part, the common case.
struct ConnectedParts
{
	std::vector<std::uint32_t> start; ///< nodes of part p: node[ start[p] .. start[p + 1] ); empty: one part
	std::vector<std::uint32_t> node;  ///< ascending within a part; parts in the order of their lowest nodes
	std::vector<std::uint32_t> of;    ///< part of each node

	bool areSeveral() const { return !start.empty(); }
	int count() const { return start.empty() ? 1 : int( start.size() ) - 1; }
	/// Part of a node.
	int partOf( int i ) const { return of.empty() ? 0 : int( of[std::size_t( i )] ); }
	/// Nodes of a part of a body that has `all` of them.
	int size( int part, int all ) const { return start.empty() ? all : int( start[std::size_t( part ) + 1] - start[std::size_t( part )] ); }
	/// work( node ) for the nodes of a part of a body that has `all` of them, ascending.
	template <class Work>
	void forNodes( int part, int all, Work&& work ) const
	{
		for ( int i = 0; start.empty() && i < all; ++i )
		{
			work( i );
		}
		for ( std::uint32_t k = start.empty() ? 0 : start[std::size_t( part )]; !start.empty() && k < start[std::size_t( part ) + 1]; ++k )
		{
			work( int( node[k] ) );
		}
	}
};

/// The parts that are connected by regions.
ConnectedParts findConnectedParts( const RegionTables& tables, const MatchView& view );

} // namespace pliant
