#include "adapt/octree/octree_update.h"

#include "adapt/octree/octree_steps.h"
#include "lattice/union_find.h"

#include <algorithm>

namespace pliant {

namespace {

/// Level by level: blocks without a touched cell keep their nodes under new numbers; in the others, the cells of touched nodes are joined
/// again by the remaining links.
class Updater
{
public:
	Updater( const Octree& old, const CellChange& change ) : m_old( old ), m_change( change ) {}

	OctreeUpdate run()
	{
		copyCells();
		markTouched();
		for ( int level = 1; level < m_old.levels; ++level )
		{
			listLevel( level );
			addLevel();
		}
		orderOctree( m_now );
		measure();
		return OctreeUpdate{ std::move( m_now ), std::move( m_nodeBefore ), std::move( m_nodeNow ) };
	}

private:
	/// A node of the level under construction.
	struct Entry
	{
		std::uint32_t lowest; ///< its first child
		std::uint32_t old;    ///< kNoNode: its children are m_child[ first ] to m_child[ last - 1 ]
		std::size_t first, last;
	};

	void copyCells()
	{
		const std::uint32_t cells = std::uint32_t( m_change.now.cellCount() );
		m_now.levelStart = { 0, cells };
		m_now.coordinate = m_change.now.coordinate;
		m_now.parent.assign( cells, kNoNode );
		m_nodeBefore = m_change.cellBefore;
		m_nodeNow.assign( m_old.parent.size(), kNoNode );
		for ( std::uint32_t c = 0; c < cells; ++c )
		{
			m_nodeNow[m_nodeBefore[c]] = c;
		}
	}

	void markTouched()
	{
		m_isTouched.assign( m_old.parent.size(), 0 );
		for ( const std::uint32_t cell : m_change.touched )
		{
			for ( std::uint32_t n = m_old.parent[m_change.cellBefore[cell]]; n != kNoNode && m_isTouched[n] == 0; n = m_old.parent[n] )
			{
				m_isTouched[n] = 1;
			}
		}
	}

	void listLevel( int level )
	{
		m_entries.clear();
		m_child.clear();
		const std::uint32_t last = m_old.levelStart[level + 1];
		std::vector<std::uint32_t> touched;
		for ( std::uint32_t n = m_old.levelStart[level]; n < last; )
		{
			const std::size_t first = m_entries.size();
			touched.clear();
			std::uint32_t end = n;
			for ( ; end < last && m_old.coordinate[end] == m_old.coordinate[n]; ++end )
			{
				const std::uint32_t lowest = m_nodeNow[m_old.child[m_old.childStart[end]]];
				if ( m_isTouched[end] != 0 )
				{
					touched.push_back( end );
				}
				else if ( lowest != kNoNode ) // an untouched node is part of the new lattice entirely or not at all
				{
					m_entries.push_back( Entry{ lowest, end, 0, 0 } );
				}
			}
			if ( !touched.empty() )
			{
				addParts( touched, level );
				std::sort( m_entries.begin() + std::ptrdiff_t( first ), m_entries.end(),
					[]( const Entry& a, const Entry& b ) { return a.lowest < b.lowest; } );
			}
			n = end;
		}
	}

	/// Adds the parts formed by those cells of touched nodes of one block that are in the new lattice.
	void addParts( const std::vector<std::uint32_t>& touched, int level )
	{
		m_cells.clear();
		for ( const std::uint32_t node : touched )
		{
			for ( std::uint32_t k = m_old.cellStart[node]; k < m_old.cellStart[node] + m_old.cellCount[node]; ++k )
			{
				if ( const std::uint32_t cell = m_nodeNow[m_old.cells[k]]; cell != kNoNode )
				{
					m_cells.push_back( cell );
				}
			}
		}
		std::vector<std::uint32_t> children;
		for ( const std::uint32_t cell : m_cells )
		{
			children.push_back( above( cell, level - 1 ) );
		}
		std::sort( children.begin(), children.end() );
		children.erase( std::unique( children.begin(), children.end() ), children.end() );
		UnionFind parts( children.size() );
		joinParts( children, level, parts );
		listParts( children, parts );
	}

	/// All children are of one block. Most are still in one part, which a few links suffice to show.
	void joinParts( const std::vector<std::uint32_t>& children, int level, UnionFind& parts )
	{
		m_index.resize( m_now.parent.size(), kNoNode );
		for ( std::uint32_t i = 0; i < std::uint32_t( children.size() ); ++i )
		{
			m_index[children[i]] = i;
		}
		const Lattice& lattice = m_change.now;
		std::size_t apart = children.size();
		for ( std::size_t c = 0; apart > 1 && c < m_cells.size(); ++c )
		{
			const std::uint32_t cell = m_cells[c], own = above( cell, level - 1 );
			for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
			{
				const std::uint32_t other = above( lattice.linkTo[k], level - 1 );
				// Untouched nodes of the block have unchanged links, so no link leads to them.
				if ( other > own && m_index[other] != kNoNode && parts.find( m_index[own] ) != parts.find( m_index[other] ) )
				{
					parts.join( m_index[own], m_index[other] );
					--apart;
				}
			}
		}
		for ( const std::uint32_t child : children )
		{
			m_index[child] = kNoNode;
		}
	}

	void listParts( const std::vector<std::uint32_t>& children, UnionFind& parts )
	{
		for ( std::uint32_t root = 0; root < std::uint32_t( children.size() ); ++root )
		{
			if ( parts.find( root ) != root )
			{
				continue;
			}
			const std::size_t first = m_child.size();
			for ( std::uint32_t i = root; i < std::uint32_t( children.size() ); ++i )
			{
				if ( parts.find( i ) == root )
				{
					m_child.push_back( children[i] );
				}
			}
			m_entries.push_back( Entry{ children[root], kNoNode, first, m_child.size() } );
		}
	}

	std::uint32_t above( std::uint32_t node, int levels ) const
	{
		for ( ; levels > 0; --levels )
		{
			node = m_now.parent[node];
		}
		return node;
	}

	void addLevel()
	{
		for ( const Entry& entry : m_entries )
		{
			const std::uint32_t node = std::uint32_t( m_now.coordinate.size() );
			m_now.coordinate.push_back( blockAbove( m_now.coordinate[entry.lowest] ) );
			m_nodeBefore.push_back( entry.old );
			for ( std::size_t k = entry.first; k < entry.last; ++k )
			{
				m_now.parent[m_child[k]] = node;
			}
			if ( entry.old != kNoNode )
			{
				m_nodeNow[entry.old] = node;
				for ( std::uint32_t k = m_old.childStart[entry.old]; k < m_old.childStart[entry.old + 1]; ++k )
				{
					m_now.parent[m_nodeNow[m_old.child[k]]] = node;
				}
			}
		}
		m_now.parent.resize( m_now.coordinate.size(), kNoNode );
		m_now.levelStart.push_back( std::uint32_t( m_now.parent.size() ) );
		++m_now.levels;
	}

	void measure()
	{
		allocateMeasures( m_now );
		const Lattice& lattice = m_change.now;
		const std::uint32_t cells = m_now.levelStart[1];
		for ( std::uint32_t c = 0; c < cells; ++c )
		{
			m_now.mass[c] = m_old.mass[m_nodeBefore[c]];
			m_now.spread[c] = m_old.spread[m_nodeBefore[c]];
		}
		std::copy( lattice.isSurface.begin(), lattice.isSurface.end(), m_now.isSurface.begin() );
		std::copy( lattice.restCentre.begin(), lattice.restCentre.end(), m_now.restCentre.begin() );
		const Vec3d shift = lattice.massCentre - m_change.before.massCentre;
		for ( std::uint32_t n = cells; n < std::uint32_t( m_now.nodeCount() ); ++n )
		{
			const std::uint32_t old = m_nodeBefore[n];
			if ( old == kNoNode )
			{
				measureNode( m_now, lattice, n );
				continue;
			}
			const std::uint32_t first = m_now.cells[m_now.cellStart[n]];
			m_now.mass[n] = m_old.mass[old];
			m_now.spread[n] = m_old.spread[old];
			m_now.isSurface[n] = m_old.isSurface[old];
			m_now.restCentre[n] = m_now.cellCount[n] == 1 ? lattice.restCentre[first]
														  : Vec3( ( m_old.restCentre[old].cast<double>() - shift ).cast<float>() );
		}
	}

	const Octree& m_old;
	const CellChange& m_change;
	Octree m_now;
	std::vector<std::uint32_t> m_nodeBefore, m_nodeNow;
	std::vector<std::uint8_t> m_isTouched; ///< of each old node above the cells
	std::vector<Entry> m_entries;
	std::vector<std::uint32_t> m_child, m_cells;
	std::vector<std::uint32_t> m_index; ///< of each node of the level below: its index among those being joined, or kNoNode
};

} // namespace

OctreeUpdate updateOctree( const Octree& before, const CellChange& change )
{
	return Updater( before, change ).run();
}

} // namespace pliant
