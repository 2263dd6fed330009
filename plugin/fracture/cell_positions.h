#pragma once

// Where the finest cells are now, and which of them may be asked about breaking: those that are nodes by themselves.

#include "adapt/octree/cut.h"
#include "fracture/constants.h"
#include "matching/node_state.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// What a finest cell is in the cut of now.
enum class CellRefinementState : std::uint8_t
{
	InBig, ///< a part of a bigger node: it does not break, for big nodes are split long before what is in them could (kRefineBeforeBreak)
	BesideBig, ///< a node by itself, linked to some that are not
	AmongFine  ///< a node by itself, as all are that it is linked to
};

/// The standing of all finest cells, looked at anew only where it may have changed.
class CellRefinementStates
{
public:
	/// `version`: another one where the cut is another.
	const std::vector<CellRefinementState>& update( const Lattice& lattice, const Cut& cut, unsigned version );
	/// Links have changed: the cells around others are no more what they were.
	void forget() { m_refinementState.clear(); }

private:
	std::vector<CellRefinementState> m_refinementState; ///< by cell; empty: not known
	unsigned m_version = 0;
};

class CellPositions
{
public:
	explicit CellPositions( const NodeState& nodes ) : m_nodes( nodes ) {}
	CellPositions( const NodeState& nodes, const Cut& cut, const std::vector<CellRefinementState>& standing ) :
		m_nodes( nodes ), m_cut( &cut ), m_refinementState( &standing )
	{}

	/// Whether the cell is a node by itself, and not a part of a bigger one.
	bool has( std::uint32_t cell ) const { return !m_cut || m_cut->node[m_cut->slotOfCell[cell]] == cell; }
	bool mayBreak( std::uint32_t cell ) const { return !m_refinementState || ( *m_refinementState )[cell] != CellRefinementState::InBig; }
	/// How many times the strain that was set it must be stretched by to break.
	float bears( std::uint32_t cell ) const
	{
		return m_refinementState && ( *m_refinementState )[cell] == CellRefinementState::BesideBig ? kBearsBesideBig : 1.0f;
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
