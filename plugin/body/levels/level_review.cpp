// Which nodes are to be split and which merged: Ohta et al. 2009, "Changing the Subdivision Level" and "Merging".

#include "body/levels/levels.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant {

namespace {

/// How much of what splits it a node is strained by; limits at 0 do not count. Largest | s - 1 | over the singular values s of F lies
/// between the root of a third of their squares' sum and the root of it.
float loadOf( float squares, float strainLimit, float stretch, float stretchLimit )
{
	const float strained = strainLimit > 0.0f ? std::sqrt( squares ) / strainLimit : 0.0f;
	return stretchLimit > 0.0f ? std::max( strained, stretch / stretchLimit ) : strained;
}

} // namespace

// A body is reviewed in every step and its cut stays the same for many: the octree, which lies anywhere, is asked once a cut.
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
			m_reviewed.coarse.push_back( { i, node, level, isTooBig( node ) } );
		}
		if ( parent == kNoNode )
		{
			continue;
		}
		const auto first = tree.child.begin() + tree.childStart[parent], end = tree.child.begin() + tree.childStart[parent + 1];
		const std::uint32_t children = std::uint32_t( end - first );
		if ( i + children <= m_cut.node.size() && std::equal( first, end, m_cut.node.begin() + i ) )
		{
			m_reviewed.siblings.push_back( { parent, i, children, tree.levelOf( parent ), isTooBig( parent ) } );
		}
	}
}

/// Whether each of its cells was held by a node at least as big, while it was held last.
bool Levels::isHeldAsOne( std::uint32_t node ) const
{
	const auto first = octree().cells.begin() + octree().cellStart[node];
	return !m_heldOn.empty() && std::all_of( first, first + octree().cellCount[node], [&]( std::uint32_t cell ) {
		return int( m_heldOn[cell] ) >= octree().levelOf( node );
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

bool Levels::review( const NodeState& nodes, const AlignedArray<float>& strain, const AlignedArray<float>& stretch, float seconds )
{
	m_split.clear();
	m_merge.clear();
	findReviewed();
	measureLoads( strain, stretch );
	const bool follows = followsStrain();
	for ( std::size_t i = 0; i < m_cut.node.size() && !( follows && m_load.empty() ); ++i )
	{
		const bool isQuiet = !follows || m_load[i] < m_settings.mergeFraction;
		m_quiet[i] = isQuiet && m_isWanted[i] == 0 ? m_quiet[i] + seconds : 0.0f;
	}
	collectSplits();
	collectMerges( nodes );
	gatherMerges( seconds );
	std::fill( m_isWanted.begin(), m_isWanted.end(), std::uint8_t( 0 ) );
	return !m_split.empty() || !m_merge.empty();
}

// Above the threshold; and, where nodes are to be split together, all that hang together with such a one and are nearly as strained. Empty
// where none is.
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
	// What was asked for comes first, then what only the finest level allowed had kept merged, then the most strained.
	constexpr float kAsked = -std::numeric_limits<float>::infinity(), kTooBig = -std::numeric_limits<float>::max();
	std::vector<std::pair<float, std::uint32_t>> wanted;
	std::sort( m_asked.begin(), m_asked.end() );
	std::vector<std::uint32_t> waiting;
	const std::vector<std::uint8_t> isStrained = strainedNodes();
	for ( const auto& [slot, node, level, isTooBig] : m_reviewed.coarse )
	{
		if ( level <= m_finestLevel )
		{
			continue;
		}
		if ( std::binary_search( m_asked.begin(), m_asked.end(), node ) )
		{
			wanted.emplace_back( kAsked, node );
			waiting.push_back( node );
		}
		else if ( isTooBig )
		{
			wanted.emplace_back( kTooBig, node );
		}
		else if ( !isStrained.empty() && isStrained[slot] != 0 )
		{
			wanted.emplace_back( -m_load[slot], node );
		}
	}
	std::stable_sort( wanted.begin(), wanted.end(), []( const auto& a, const auto& b ) { return a.first < b.first; } );
	int left = m_budget == kNoBudget ? m_settings.nodesPerStep : m_budget;
	m_hasBacklog = false;
	for ( const auto& [order, node] : wanted )
	{
		const int children = int( octree().childStart[node + 1] - octree().childStart[node] );
		m_hasBacklog = children > left;
		if ( m_hasBacklog )
		{
			left = 0; // what waits, waits together: a second change for a few nodes would cost nearly as much as one for all
			break;
		}
		left -= children;
		m_split.push_back( node );
	}
	m_budget = m_budget == kNoBudget ? kNoBudget : left;
	std::sort( m_split.begin(), m_split.end() );
	const auto isDone = [this]( std::uint32_t node ) { return std::binary_search( m_split.begin(), m_split.end(), node ); };
	waiting.erase( std::remove_if( waiting.begin(), waiting.end(), isDone ), waiting.end() );
	m_asked = std::move( waiting ); // each once, and only what is there: requests come again and again
}

bool Levels::mayMerge( const NodeState& nodes, const Reviewed::Siblings& of ) const
{
	const bool isFiner = of.parentLevel <= m_finestLevel, isHeld = nodes.freedom[of.first] == 0.0f;
	for ( std::size_t slot = of.first; slot < std::size_t( of.first ) + of.count; ++slot )
	{
		const bool isQuiet = isFiner || ( m_quiet[slot] > 0.0f && m_quiet[slot] >= m_settings.mergeDelay );
		const bool isAlike = ( nodes.freedom[slot] == 0.0f ) == isHeld; // a pin holds one node, not what surrounds it
		if ( !isQuiet || !isAlike || std::binary_search( m_split.begin(), m_split.end(), m_cut.node[slot] ) )
		{
			return false;
		}
	}
	return ( isFiner || !of.isParentTooBig ) && ( !isHeld || isHeldAsOne( of.parent ) );
}

void Levels::collectMerges( const NodeState& nodes )
{
	for ( const Reviewed::Siblings& of : m_reviewed.siblings )
	{
		if ( mayMerge( nodes, of ) )
		{
			m_merge.push_back( of.parent );
		}
	}
}

} // namespace pliant
