#pragma once

// How far apart two neighbouring finest cells may come. Ohta et al. 2009, "Fracturing": the distance between two nodes that are neighbours
// on the finest level, over all 26.

#include "lattice/pieces.h"
#include "matching/node_state.h"

#include <cstdint>
#include <vector>

namespace pliant {

class CellPositions;

/// The links of a lattice, each once, from its lower cell: link k of cell i leads to to[k], start[i] <= k < start[i + 1].
struct LinkLimits
{
	std::vector<std::uint32_t> start, to;
	std::vector<float> toughness;     ///< share of what the settings say; empty: 1 everywhere
	std::vector<float> lengthSquared; ///< beyond this the link breaks, m^2; infinity: never
	float weakest = 1.0f;             ///< least toughness

	std::size_t bytes() const
	{
		return ( start.size() + to.size() ) * sizeof( std::uint32_t ) + ( toughness.size() + lengthSquared.size() ) * sizeof( float );
	}
};

/// Limits ( 1 + strain toughness ) L with L the links' lengths at rest. `toughness`: one a link in the order of LinkLimits; empty: 1.
LinkLimits limitLinks( const Lattice& lattice, float strain, std::vector<float> toughness );

/// Toughness for some cells of a lattice (ascending): `before` holds that of the old links; links that are new (healed) have 1.
std::vector<float> inheritToughness( const LinkLimits& before, const Lattice& part, const std::vector<std::uint32_t>& cells );

/// Limits for some cells of a lattice (ascending): those of the old links, made for `strain`, as they were; healed ones are measured.
/// limitLinks with inheritToughness is its slow twin.
LinkLimits inheritLimits( const LinkLimits& before, const Lattice& part, const std::vector<std::uint32_t>& cells, float strain );

/// All links longer than they may be, ascending. Cells are nodes.
void findOverstretched( const LinkLimits& limits, const NodeState& nodes, std::vector<CellLink>& found );
/// The same where nodes differ in size: links between two cells that may break.
void findOverstretched( const LinkLimits& limits, const CellPositions& positions, std::vector<CellLink>& found );

} // namespace pliant
