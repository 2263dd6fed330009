#include "archive/archive.h"
#include "body/levels/levels.h"

namespace pliant {

// What the last review found is applied in the same substep, and rows are skipped only within one: both are empty between substeps. Loads
// are measured before each review.
void Levels::archive( Archive& archive )
{
	const std::size_t cells = m_cut.slotOfCell.size();
	archive( m_version, m_finestLevel, m_refineStretch, m_together, m_sinceMerge, m_budget, m_hasBacklog );
	archive.sameLength( m_coarsest );
	archive.sameLength( m_quiet );
	archive.sameLength( m_wasRequested );
	archive( m_pinnedLevel, m_requested );
	archive.require( ( m_pinnedLevel.empty() || m_pinnedLevel.size() == cells ) && m_finestLevel >= 0 && m_finestLevel <= kMaxCoarseLevels,
		"The levels of detail are those of another body." );
	if ( archive.isReading() )
	{
		m_reviewed.isKnown = false;
	}
}

void Levels::archiveTables( Archive& archive )
{
	m_ownsBase = true;
	std::const_pointer_cast<RegionTables>( m_tables )->archiveNumbers( archive );
}

} // namespace pliant
