#include "archive/archive.h"
#include "body/levels/levels.h"

#include <algorithm>

namespace pliant {

Cut Levels::readCut( Archive& archive, const Octree& octree, std::vector<std::uint32_t> nodes )
{
	Cut cut;
	cut.node = std::move( nodes );
	const auto exists = [count = std::uint32_t( octree.nodeCount() )]( std::uint32_t node ) { return node < count; };
	if ( archive.require( std::all_of( cut.node.begin(), cut.node.end(), exists ), "A node of a level does not exist." ) )
	{
		cut.slotOfCell.assign( octree.cells.size(), 0 );
		numberCells( octree, cut );
		archive.require( pliant::validate( cut, octree ).ok(), "The nodes of the levels do not cover the body." );
	}
	return cut;
}

// The last review's result is applied in the same substep, and rows are skipped only within one: both are empty between substeps. Loads
// are measured before each review.
void Levels::archive( Archive& archive )
{
	const std::size_t cells = m_cut.slotOfCell.size();
	archive( m_version, m_finestLevel, m_refineStretch, m_together, m_sinceMerge, m_budget, m_hasBacklog );
	archive.sameLength( m_coarsest );
	archive.sameLength( m_quiet );
	archive.sameLength( m_wasRequested );
	std::vector<std::uint32_t> requested = m_requested; // in the order of the contacts, which no use of them depends on
	std::sort( requested.begin(), requested.end() );
	archive( m_pinnedLevel, requested );
	archive.require( ( m_pinnedLevel.empty() || m_pinnedLevel.size() == cells ) && m_finestLevel >= 0 && m_finestLevel <= kMaxCoarseLevels,
		"The levels of detail are those of another body." );
	archive.require( requested.empty() || requested.back() < std::uint32_t( octree().nodeCount() ), "A requested node does not exist." );
	if ( archive.isReading() )
	{
		m_requested = std::move( requested );
		m_reviewed.isKnown = m_bends.isKnown = false;
	}
}

void Levels::archiveTables( Archive& archive )
{
	m_ownsBase = true;
	std::const_pointer_cast<RegionTables>( m_tables )->archiveNumbers( archive );
}

} // namespace pliant
