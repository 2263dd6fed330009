#pragma once

// Where the finest cells are now, and which of them may be asked about breaking: those that are nodes by themselves.

#include "adapt/cut.h"
#include "matching/node_state.h"

#include <cstdint>
#include <vector>

namespace pliant {

class CellPlaces
{
public:
	explicit CellPlaces( const NodeState& nodes ) : m_nodes( nodes ) {}
	/// `mayBreak`: 1 for each cell that may (SettledCells).
	CellPlaces( const NodeState& nodes, const Cut& cut, const std::vector<std::uint8_t>& mayBreak ) : m_nodes( nodes ), m_cut( &cut ), m_mayBreak( &mayBreak ) {}

	/// Whether the cell is a node by itself, and not a part of a bigger one.
	bool has( std::uint32_t cell ) const { return !m_cut || m_cut->node[m_cut->slotOfCell[cell]] == cell; }
	bool mayBreak( std::uint32_t cell ) const { return !m_mayBreak || ( *m_mayBreak )[cell] != 0; }
	Vec3 at( std::uint32_t cell ) const { return m_nodes.x.get( int( m_cut ? m_cut->slotOfCell[cell] : cell ) ); }

private:
	const NodeState& m_nodes;
	const Cut* m_cut = nullptr;
	const std::vector<std::uint8_t>* m_mayBreak = nullptr;
};

/// Where big nodes meet small ones strains are off by as much as half, and where a node has just been split they ring. Cells may break that have
/// been among finest ones, two links around for each coarse level there is, for a while; big nodes are split long before what is under them could break (kRefineBeforeBreak).
class SettledCells
{
public:
	/// One substep of length h further; 1 for each cell that may break. `version`: another one where the cut is another.
	const std::vector<std::uint8_t>& update( const Lattice& lattice, const Cut& cut, unsigned version, int coarseLevels, float h );
	/// Links have changed: the cells around others are no more what they were.
	void forgetLinks() { m_mayBreak.clear(); }
	/// Pieces go on where the whole was.
	void inherit( const SettledCells& from, const std::vector<std::uint32_t>& cellBefore );

private:
	std::vector<float> m_finestFor; ///< s
	unsigned m_version = 0;
	bool m_isWaiting = true; ///< some finest cells are too young
	std::vector<std::uint8_t> m_isFinest; ///< 1 for cells that have been finest ones for long enough
	std::vector<std::uint8_t> m_ring, m_mayBreak; ///< m_mayBreak: of m_isFinest as it is; empty: not known
};

} // namespace pliant
