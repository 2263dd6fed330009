#include "fracture/cell_positions.h"

#include <algorithm>

namespace pliant {

const std::vector<CellRefinementState>& CellRefinementStates::update( const Lattice& lattice, const Cut& cut, unsigned version )
{
	const std::size_t count = std::size_t( lattice.cellCount() );
	if ( m_refinementState.size() == count && m_version == version )
	{
		return m_refinementState;
	}
	m_version = version;
	m_refinementState.resize( count );
	const auto isNode = [&cut]( std::uint32_t cell ) { return cut.node[cut.slotOfCell[cell]] == cell; };
	for ( std::uint32_t i = 0; i < std::uint32_t( count ); ++i )
	{
		const auto first = lattice.linkTo.begin() + lattice.linkStart[i], last = lattice.linkTo.begin() + lattice.linkStart[i + 1];
		const bool isAmongFine = isNode( i ) && std::all_of( first, last, isNode );
		m_refinementState[i] = isAmongFine ? CellRefinementState::AmongFine
			: isNode( i )                  ? CellRefinementState::NextToCoarse
										   : CellRefinementState::InCoarse;
	}
	return m_refinementState;
}

} // namespace pliant
