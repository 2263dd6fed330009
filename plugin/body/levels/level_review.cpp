// Selects the nodes to split and to merge: Ohta et al. 2009, "Changing the Subdivision Level" and "Merging".

#include "body/constants.h"
#include "body/levels/levels.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant {

namespace {

/// Strain of a node relative to its splitting thresholds; limits of 0 are ignored. The largest | s - 1 | over the singular values s of F
/// lies between the root of a third of their squares' sum and the root of it.
float loadOf( float squares, float strainLimit, float stretch, float stretchLimit )
{
	const float strained = strainLimit > 0.0f ? std::sqrt( squares ) / strainLimit : 0.0f;
	return stretchLimit > 0.0f ? std::max( strained, stretch / stretchLimit ) : strained;
}

} // namespace

// A body is reviewed in every step but its cut rarely changes: the octree, whose memory is scattered, is read once per cut.
void Levels::findReviewed()
{
	if ( m_reviewed.isKnown && m_reviewed.version == m_version )
	{
		return;
	}
	m_reviewed.isKnown = true;
	m_reviewed.version = m_version;
	m_reviewed.coarse.clear();
	m_reviewed.siblings.clear();
	const Octree& tree = octree();
	for ( std::uint32_t i = 0; i < std::uint32_t( m_cut.count() ); ++i )
	{
		const std::uint32_t node = m_cut.node[i], parent = tree.parent[node];
		if ( const int level = tree.levelOf( node ); level > 0 )
		{
			m_reviewed.coarse.push_back( { i, node, level, isTooCoarse( node ) } );
		}
		if ( parent == kNoNode )
		{
			continue;
		}
		const auto first = tree.child.begin() + tree.childStart[parent], end = tree.child.begin() + tree.childStart[parent + 1];
		const std::uint32_t children = std::uint32_t( end - first );
		if ( i + children <= m_cut.node.size() && std::equal( first, end, m_cut.node.begin() + i ) )
		{
			m_reviewed.siblings.push_back( { parent, i, children, tree.levelOf( parent ), isTooCoarse( parent ) } );
		}
	}
}

/// Whether each of its cells was last pinned through a node at least as coarse.
bool Levels::isPinnedAsOne( std::uint32_t node ) const
{
	const auto first = octree().cells.begin() + octree().cellStart[node];
	return !m_pinnedLevel.empty() && std::all_of( first, first + octree().cellCount[node], [&]( std::uint32_t cell ) {
		return int( m_pinnedLevel[cell] ) >= octree().levelOf( node );
	} );
}

void Levels::measureLoads( const AlignedArray<float>& strain, const AlignedArray<float>& stretch )
{
	m_load.resize( followsStrain() && !stretch.empty() ? m_cut.node.size() : 0 );
	const float strainLimit = m_settings.refineStrain, stretchLimit = m_refineStretch;
	for ( std::size_t i = 0; i < m_load.size(); ++i )
	{
		m_load[i] = loadOf( strain[i], strainLimit, stretch[i], stretchLimit );
	}
}

bool Levels::review( const NodeState& nodes, const AlignedArray<float>& strain, const AlignedArray<float>& stretch,
	const std::vector<ThinCell>& thin, float seconds )
{
	m_split.clear();
	m_merge.clear();
	findReviewed();
	measureLoads( strain, stretch );
	if ( !thin.empty() && !m_load.empty() && m_refineStretch > 0.0f )
	{
		findBends( nodes, thin );
		addBending( nodes );
	}
	const bool follows = followsStrain();
	for ( std::size_t i = 0; i < m_cut.node.size() && !( follows && m_load.empty() ); ++i )
	{
		const bool isQuiet = !follows || m_load[i] < m_settings.mergeFraction;
		m_quiet[i] = isQuiet && m_wasRequested[i] == 0 ? m_quiet[i] + seconds : 0.0f;
	}
	collectSplits();
	collectMerges( nodes );
	gatherMerges( seconds );
	std::fill( m_wasRequested.begin(), m_wasRequested.end(), std::uint8_t( 0 ) );
	return !m_split.empty() || !m_merge.empty();
}

// Nodes above the threshold; and, where nodes split in groups, those connected to such a node with nearly as much strain. Empty if none.
std::vector<std::uint8_t> Levels::strainedNodes() const
{
	std::vector<std::uint8_t> isStrained;
	std::vector<std::uint32_t> front;
	for ( const Reviewed::Coarse& node : m_reviewed.coarse )
	{
		if ( !m_load.empty() && m_load[node.slot] > 1.0f && node.level > m_finestLevel )
		{
			front.push_back( node.slot );
		}
	}
	if ( front.empty() )
	{
		return isStrained;
	}
	std::transform(
		m_load.begin(), m_load.end(), std::back_inserter( isStrained ), []( float load ) { return std::uint8_t( load > 1.0f ? 1 : 0 ); } );
	while ( !front.empty() && m_together < 1.0f )
	{
		const std::uint32_t node = front.back();
		front.pop_back();
		for ( std::uint32_t k = matrix().start[node]; k < matrix().start[node + 1]; ++k )
		{
			const std::uint32_t to = matrix().member[k];
			if ( isStrained[to] == 0 && m_load[to] > m_together )
			{
				isStrained[to] = 1;
				front.push_back( to );
			}
		}
	}
	return isStrained;
}

void Levels::collectSplits()
{
	// Requested nodes come first, then nodes that only the finest level allowed had kept merged, then the most strained.
	constexpr float kRequested = -std::numeric_limits<float>::infinity(), kTooCoarse = -std::numeric_limits<float>::max();
	std::vector<std::pair<float, std::uint32_t>> wanted;
	std::sort( m_requested.begin(), m_requested.end() );
	std::vector<std::uint32_t> waiting;
	const std::vector<std::uint8_t> isStrained = strainedNodes();
	for ( const auto& [slot, node, level, isTooCoarse] : m_reviewed.coarse )
	{
		if ( level <= m_finestLevel )
		{
			continue;
		}
		if ( std::binary_search( m_requested.begin(), m_requested.end(), node ) )
		{
			wanted.emplace_back( kRequested, node );
			waiting.push_back( node );
		}
		else if ( isTooCoarse )
		{
			wanted.emplace_back( kTooCoarse, node );
		}
		else if ( !isStrained.empty() && isStrained[slot] != 0 )
		{
			wanted.emplace_back( -m_load[slot], node );
		}
	}
	std::stable_sort( wanted.begin(), wanted.end(), []( const auto& a, const auto& b ) { return a.first < b.first; } );
	int budget = m_budget == kNoBudget ? m_settings.nodesPerStep : m_budget;
	m_hasBacklog = false;
	for ( const auto& [order, node] : wanted )
	{
		const int children = int( octree().childStart[node + 1] - octree().childStart[node] );
		m_hasBacklog = children > budget;
		if ( m_hasBacklog )
		{
			budget = 0; // postponed splits wait for one common change, as a change for a few nodes costs nearly as much as one for all
			break;
		}
		budget -= children;
		m_split.push_back( node );
	}
	m_budget = m_budget == kNoBudget ? kNoBudget : budget;
	std::sort( m_split.begin(), m_split.end() );
	keepRequests( std::move( waiting ) );
}

// Without duplicates, and only current nodes and those under them, as requests repeat. `current`: requested nodes of the cut.
void Levels::keepRequests( std::vector<std::uint32_t> current )
{
	std::sort( current.begin(), current.end() );
	const auto isCurrent = [&current]( std::uint32_t node ) { return std::binary_search( current.begin(), current.end(), node ); };
	const auto isDropped = [&]( std::uint32_t node ) {
		if ( isCurrent( node ) )
		{
			return std::binary_search( m_split.begin(), m_split.end(), node );
		}
		std::uint32_t above = octree().parent[node];
		while ( above != kNoNode && !isCurrent( above ) )
		{
			above = octree().parent[above];
		}
		return above == kNoNode;
	};
	m_requested.erase( std::unique( m_requested.begin(), m_requested.end() ), m_requested.end() );
	m_requested.erase( std::remove_if( m_requested.begin(), m_requested.end(), isDropped ), m_requested.end() );
}

bool Levels::mayMerge( const NodeState& nodes, const Reviewed::Siblings& siblings ) const
{
	const bool isFiner = siblings.parentLevel <= m_finestLevel, isPinned = nodes.freedom[siblings.first] == 0.0f;
	for ( std::size_t slot = siblings.first; slot < std::size_t( siblings.first ) + siblings.count; ++slot )
	{
		const bool isQuiet = isFiner || ( m_quiet[slot] > 0.0f && m_quiet[slot] >= m_settings.mergeDelay );
		const bool isAlike = ( nodes.freedom[slot] == 0.0f ) == isPinned; // a pin holds one node, not its surroundings
		if ( !isQuiet || !isAlike || std::binary_search( m_split.begin(), m_split.end(), m_cut.node[slot] ) )
		{
			return false;
		}
	}
	return ( isFiner || !siblings.isParentTooCoarse ) && ( !isPinned || isPinnedAsOne( siblings.parent ) );
}

// Small pieces would merge into nodes that neither rotate nor rest as their cells do, and split again for it; a game may ask for it
// (setFinestLevel).
void Levels::collectMerges( const NodeState& nodes )
{
	const bool isLarge = octree().cells.size() >= kLeastMergedCells;
	for ( const Reviewed::Siblings& siblings : m_reviewed.siblings )
	{
		if ( ( isLarge || siblings.parentLevel <= m_finestLevel ) && mayMerge( nodes, siblings ) )
		{
			m_merge.push_back( siblings.parent );
		}
	}
}

} // namespace pliant
