#include "adapt/octree/octree_update.h"

#include "adapt/octree/octree_steps.h"

namespace pliant {

namespace {

/// Returns 1 for each old node above a touched cell.
std::vector<std::uint8_t> touchedNodes( const Octree& old, const CellChange& change )
{
	std::vector<std::uint8_t> isTouched( old.parent.size(), 0 );
	for ( const std::uint32_t cell : change.touched )
	{
		for ( std::uint32_t n = old.parent[change.cellBefore[cell]]; n != kNoNode && isTouched[n] == 0; n = old.parent[n] )
		{
			isTouched[n] = 1;
		}
	}
	return isTouched;
}

/// The children of an old node of the level above become one node again, unless it is touched: then its cells' links decide.
class Rejoin
{
public:
	Rejoin( const Octree& old, const CellChange& change, std::vector<std::uint32_t>& nodeNow ) :
		m_old( old ), m_change( change ), m_isTouched( touchedNodes( old, change ) ), m_nodeNow( nodeNow )
	{}

	void operator()( const Octree& now, const std::vector<std::uint32_t>& nodeOfCell, UnionFind& parts )
	{
		number( now );
		const std::uint32_t first = now.levelStart[now.levels - 1];
		for ( std::uint32_t n = m_old.levelStart[now.levels]; n < m_old.levelStart[now.levels + 1]; ++n )
		{
			if ( m_isTouched[n] != 0 )
			{
				for ( std::uint32_t k = m_old.cellStart[n]; k < m_old.cellStart[n] + m_old.cellCount[n]; ++k )
				{
					const std::uint32_t cell = m_nodeNow[m_old.cells[k]];
					cell != kNoNode ? joinByLinks( now, m_change.now, nodeOfCell, cell, parts ) : void();
				}
				continue;
			}
			// An untouched node is part of the new lattice entirely or not at all.
			const std::uint32_t lowest = m_nodeNow[m_old.child[m_old.childStart[n]]];
			for ( std::uint32_t k = m_old.childStart[n]; lowest != kNoNode && k < m_old.childStart[n + 1]; ++k )
			{
				parts.join( lowest - first, m_nodeNow[m_old.child[k]] - first );
			}
		}
	}

	/// Numbers the untouched old nodes of the highest level.
	void number( const Octree& now )
	{
		for ( std::uint32_t n = m_old.levelStart[now.levels - 1]; now.levels > 1 && n < m_old.levelStart[now.levels]; ++n )
		{
			const std::uint32_t lowest = m_nodeNow[m_old.child[m_old.childStart[n]]];
			m_nodeNow[n] = m_isTouched[n] != 0 || lowest == kNoNode ? kNoNode : now.parent[lowest];
		}
	}

private:
	const Octree& m_old;
	const CellChange& m_change;
	const std::vector<std::uint8_t> m_isTouched;
	std::vector<std::uint32_t>& m_nodeNow;
};

} // namespace

OctreeUpdate updateOctree( const Octree& before, const CellChange& change )
{
	OctreeUpdate update;
	update.nodeNow.assign( before.parent.size(), kNoNode );
	for ( std::uint32_t c = 0; c < std::uint32_t( change.cellBefore.size() ); ++c )
	{
		update.nodeNow[change.cellBefore[c]] = c;
	}
	Rejoin rejoin( before, change, update.nodeNow );
	Octree& now = update.octree = assembleOctree( change.now, before.levels - 1, std::ref( rejoin ) );
	rejoin.number( now );
	update.nodeBefore.assign( now.parent.size(), kNoNode );
	const Vec3d shift = change.now.massCentre - change.before.massCentre;
	for ( std::uint32_t old = 0; old < std::uint32_t( before.nodeCount() ); ++old )
	{
		const std::uint32_t n = update.nodeNow[old];
		if ( n == kNoNode )
		{
			continue;
		}
		update.nodeBefore[n] = old;
		now.mass[n] = before.mass[old];
		now.spread[n] = before.spread[old];
		now.isSurface[n] = old < before.levelStart[1] ? change.now.isSurface[n] : before.isSurface[old];
		now.restCentre[n] = now.cellCount[n] == 1 ? change.now.restCentre[now.cells[now.cellStart[n]]]
												  : Vec3( ( before.restCentre[old].cast<double>() - shift ).cast<float>() );
	}
	for ( std::uint32_t n = 0; n < std::uint32_t( now.nodeCount() ); ++n )
	{
		update.nodeBefore[n] == kNoNode ? measureNode( now, change.now, n ) : void();
	}
	return update;
}

} // namespace pliant
