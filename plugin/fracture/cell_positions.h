#pragma once

// Positions of the finest cells, and which of them can break: those that are nodes by themselves.

#include "adapt/octree/cut.h"
#include "fracture/constants.h"
#include "matching/node_state.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// State of a finest cell in the current cut.
enum class CellRefinementState : std::uint8_t
{
	InCoarse, ///< part of a coarse node: it cannot break, since coarse nodes are split long before their cells could (kRefineBeforeBreak)
	NextToCoarse, ///< a node by itself, linked to some cells that are not
	AmongFine     ///< a node by itself, as are all linked cells
};

/// The states of all finest cells, updated only where they may have changed.
class CellRefinementStates
{
public:
	/// `version`: changes with every change of the cut.
	const std::vector<CellRefinementState>& update( const Lattice& lattice, const Cut& cut, unsigned version );
	/// Links have changed: all states are outdated.
	void forget() { m_refinementState.clear(); }

private:
	std::vector<CellRefinementState> m_refinementState; ///< by cell; empty: outdated
	unsigned m_version = 0;
};

class CellPositions
{
public:
	explicit CellPositions( const NodeState& nodes ) : m_nodes( nodes ) {}
	CellPositions( const NodeState& nodes, const Cut& cut, const std::vector<CellRefinementState>& states ) :
		m_nodes( nodes ), m_cut( &cut ), m_refinementState( &states )
	{}

	/// True where the cell is a node by itself, and not part of a coarse one.
	bool isNode( std::uint32_t cell ) const { return !m_cut || m_cut->node[m_cut->slotOfCell[cell]] == cell; }
	bool mayBreak( std::uint32_t cell ) const
	{
		return !m_refinementState || ( *m_refinementState )[cell] != CellRefinementState::InCoarse;
	}
	/// Factor on the break strain at which the cell breaks.
	float strainFactor( std::uint32_t cell ) const
	{
		return m_refinementState && ( *m_refinementState )[cell] == CellRefinementState::NextToCoarse ? kStrainFactorNextToCoarse : 1.0f;
	}
	Vec3 at( std::uint32_t cell ) const { return m_nodes.x.get( nodeOf( cell ) ); }
	/// At rest, in the body's own frame.
	Vec3 restOf( std::uint32_t cell ) const { return m_nodes.x0.get( nodeOf( cell ) ); }

private:
	int nodeOf( std::uint32_t cell ) const { return int( m_cut ? m_cut->slotOfCell[cell] : cell ); }

	const NodeState& m_nodes;
	const Cut* m_cut = nullptr;
	const std::vector<CellRefinementState>* m_refinementState = nullptr;
};

} // namespace pliant
