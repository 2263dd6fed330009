#include "fracture/cell_places.h"

#include "fracture/constants.h"

#include <algorithm>

namespace pliant {

namespace {

/// 1 for the cells that, with all they are linked to, have a 1 in `inner`.
void shrink( const Lattice& lattice, const std::vector<std::uint8_t>& inner, std::vector<std::uint8_t>& outer )
{
	outer.resize( inner.size() );
	for ( std::size_t i = 0; i < inner.size(); ++i )
	{
		const auto first = lattice.linkTo.begin() + lattice.linkStart[i], last = lattice.linkTo.begin() + lattice.linkStart[i + 1];
		outer[i] = inner[i] != 0 && std::all_of( first, last, [&inner]( std::uint32_t j ) { return inner[j] != 0; } ) ? 1 : 0;
	}
}

} // namespace

const std::vector<std::uint8_t>& SettledCells::update( const Lattice& lattice, const Cut& cut, unsigned version, int coarseLevels, float h )
{
	const std::size_t count = std::size_t( lattice.cellCount() );
	if ( m_mayBreak.size() == count && m_version == version && !m_isWaiting )
	{
		return m_mayBreak; // time makes no difference any more
	}
	m_version = version;
	m_isWaiting = false;
	if ( m_finestFor.size() != count )
	{
		m_finestFor.assign( count, kSettleTime ); // as made: nothing has been split yet
	}
	m_isFinest.resize( count );
	bool isKnown = m_mayBreak.size() == count;
	for ( std::uint32_t i = 0; i < std::uint32_t( count ); ++i )
	{
		const bool isNode = cut.node[cut.slotOfCell[i]] == i;
		m_finestFor[i] = isNode ? m_finestFor[i] + h : 0.0f;
		const std::uint8_t isFinest = m_finestFor[i] >= kSettleTime ? 1 : 0;
		m_isWaiting = m_isWaiting || ( isNode && isFinest == 0 );
		isKnown = isKnown && isFinest == m_isFinest[i];
		m_isFinest[i] = isFinest;
	}
	if ( isKnown ) // in most substeps nothing has changed, and the rings below are most of the work
	{
		return m_mayBreak;
	}
	m_mayBreak = m_isFinest;
	for ( int ring = 0; ring < 2 * coarseLevels; ++ring )
	{
		shrink( lattice, m_mayBreak, m_ring );
		m_mayBreak.swap( m_ring );
	}
	return m_mayBreak;
}

void SettledCells::inherit( const SettledCells& from, const std::vector<std::uint32_t>& cellBefore )
{
	for ( const std::uint32_t cell : cellBefore )
	{
		m_finestFor.push_back( cell < from.m_finestFor.size() ? from.m_finestFor[cell] : kSettleTime );
	}
}

} // namespace pliant
