#include "adapt/octree/visibility_graph.h"

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

/// Builds rows of edges one after the other.
class Rows
{
public:
	Rows( const Lattice& lattice, const Octree& octree, const Cut& cut, VisibilityGraph& graph ) :
		m_lattice( lattice ), m_octree( octree ), m_cut( cut ), m_graph( graph ), m_seenFrom( cut.node.size(), kNoNode )
	{
		m_blocks.reserve( cut.node.size() );
		for ( const std::uint32_t node : cut.node )
		{
			m_blocks.push_back( blockOf( octree, node ) );
		}
		graph.start.reserve( cut.node.size() + 1 );
		graph.start.push_back( 0 );
	}

	/// Appends the row of a slot, from the links of its cells.
	void appendFromLinks( std::uint32_t slot )
	{
		const std::uint32_t node = m_cut.node[slot];
		m_seenFrom[slot] = slot;
		for ( std::uint32_t k = m_octree.cellStart[node]; k < m_octree.cellStart[node] + m_octree.cellCount[node]; ++k )
		{
			const std::uint32_t cell = m_octree.cells[k];
			for ( std::uint32_t l = m_lattice.linkStart[cell]; l < m_lattice.linkStart[cell + 1]; ++l )
			{
				const std::uint32_t other = m_cut.slotOfCell[m_lattice.linkTo[l]];
				if ( std::exchange( m_seenFrom[other], slot ) != slot )
				{
					add( slot, other );
				}
			}
		}
		sortAndClose();
	}

	void add( std::uint32_t slot, std::uint32_t other )
	{
		m_row.emplace_back( std::uint16_t( distance( m_blocks[slot], m_blocks[other] ) ), other );
	}

	void sortAndClose()
	{
		std::sort( m_row.begin(), m_row.end() );
		for ( const auto& [length, to] : m_row )
		{
			m_graph.length.push_back( length );
			m_graph.to.push_back( to );
		}
		m_row.clear();
		close();
	}

	void close()
	{
		if ( m_graph.to.size() > m_graph.start.back() )
		{
			m_graph.longest = std::max( m_graph.longest, int( m_graph.length.back() ) );
		}
		m_graph.start.push_back( std::uint32_t( m_graph.to.size() ) );
	}

private:
	const Lattice& m_lattice;
	const Octree& m_octree;
	const Cut& m_cut;
	VisibilityGraph& m_graph;
	std::vector<NodeBlock> m_blocks;
	std::vector<std::uint32_t> m_seenFrom; ///< of each slot: the last slot from which it was visited
	std::vector<std::pair<std::uint16_t, std::uint32_t>> m_row;
};

/// An edge from a kept node to a new one.
struct NewEdge
{
	std::uint32_t from, to;
};

/// Returns the edges from kept nodes to new ones, by slot, given the rows of new nodes.
std::vector<NewEdge> edgesToNewNodes( const VisibilityGraph& fresh, const std::vector<std::uint32_t>& before )
{
	std::vector<NewEdge> edges;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( before.size() ); ++slot )
	{
		for ( std::uint32_t e = fresh.start[slot]; e < fresh.start[slot + 1]; ++e )
		{
			if ( before[fresh.to[e]] != kNoNode )
			{
				edges.push_back( { fresh.to[e], slot } );
			}
		}
	}
	std::sort(
		edges.begin(), edges.end(), []( const NewEdge& a, const NewEdge& b ) { return a.from != b.from ? a.from < b.from : a.to < b.to; } );
	return edges;
}

} // namespace

NodeBlock blockOf( const Octree& octree, std::uint32_t node )
{
	const int level = octree.levelOf( node );
	// Block c spans the cells c 2^l to ( c + 1 ) 2^l: its centre is at ( 2 c + 1 ) 2^l half cells.
	return { ( octree.coordinate[node].cast<int>() * 2 + Eigen::Vector3i::Ones() ) * ( 1 << level ), 1 << level };
}

VisibilityGraph buildVisibilityGraph( const Lattice& lattice, const Octree& octree, const Cut& cut )
{
	VisibilityGraph graph;
	Rows rows( lattice, octree, cut, graph );
	for ( std::uint32_t slot = 0; slot < std::uint32_t( cut.count() ); ++slot )
	{
		rows.appendFromLinks( slot );
	}
	return graph;
}

CutChange compareCuts( const Octree& octree, const Cut& from, const Cut& to )
{
	CutChange change;
	change.before.assign( to.node.size(), kNoNode );
	change.after.assign( from.node.size(), kNoNode );
	const auto endOf = [&octree]( std::uint32_t node ) { return octree.cellStart[node] + octree.cellCount[node]; };
	for ( std::size_t i = 0, j = 0; i < from.node.size() && j < to.node.size(); )
	{
		const std::uint32_t old = from.node[i], now = to.node[j];
		if ( old == now )
		{
			change.after[i] = std::uint32_t( j );
			change.before[j] = std::uint32_t( i );
		}
		i += endOf( old ) <= endOf( now ) ? 1 : 0;
		j += endOf( now ) <= endOf( old ) ? 1 : 0;
	}
	return change;
}

VisibilityUpdate updateVisibilityGraph(
	const Lattice& lattice, const Octree& octree, const Cut& from, const VisibilityGraph& graph, const Cut& to )
{
	VisibilityUpdate update;
	update.change = compareCuts( octree, from, to );
	const std::vector<std::uint32_t>& before = update.change.before;
	const std::uint32_t count = std::uint32_t( to.count() );

	VisibilityGraph fresh; // rows of new nodes; the rows of others are empty
	Rows freshRows( lattice, octree, to, fresh );
	for ( std::uint32_t slot = 0; slot < count; ++slot )
	{
		before[slot] == kNoNode ? freshRows.appendFromLinks( slot ) : freshRows.close();
	}
	const std::vector<NewEdge> toNew = edgesToNewNodes( fresh, before );

	VisibilityGraph& result = update.graph;
	result.to.reserve( graph.to.size() + fresh.to.size() );
	result.length.reserve( graph.to.size() + fresh.to.size() );
	Rows rows( lattice, octree, to, result );
	auto next = toNew.begin();
	for ( std::uint32_t slot = 0; slot < count; ++slot )
	{
		const bool isNew = before[slot] == kNoNode;
		const VisibilityGraph& source = isNew ? fresh : graph;
		const std::uint32_t row = isNew ? slot : before[slot];
		if ( isNew || next == toNew.end() || next->from != slot ) // unchanged: new numbers keep the order of the old ones
		{
			for ( std::uint32_t e = source.start[row]; e < source.start[row + 1]; ++e )
			{
				result.to.push_back( isNew ? source.to[e] : update.change.after[source.to[e]] );
				result.length.push_back( source.length[e] );
			}
			rows.close();
			continue;
		}
		for ( std::uint32_t e = source.start[row]; e < source.start[row + 1]; ++e )
		{
			if ( const std::uint32_t other = update.change.after[source.to[e]]; other != kNoNode )
			{
				rows.add( slot, other );
			}
		}
		for ( ; next != toNew.end() && next->from == slot; ++next )
		{
			rows.add( slot, next->to );
		}
		rows.sortAndClose();
	}
	return update;
}

} // namespace pliant
