#pragma once

// Maximum distances of neighbouring finest cells. Ohta et al. 2009, "Fracturing": the distance between two nodes that are neighbours on the
// finest level, over all 26.

#include "fracture/thin_cells.h"
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
	std::vector<float> toughness;     ///< factor on the settings' strain; empty: 1 everywhere
	std::vector<float> lengthSquared; ///< beyond this the link breaks, m^2; infinity: never
	float weakest = 1.0f;             ///< minimum toughness
	std::vector<ThinCell> thin;       ///< cells at the faces of thin parts, ascending; limitLinks leaves it empty

	/// Number of the link between two cells.
	std::size_t linkOf( std::uint32_t a, std::uint32_t b ) const;
};

/// The toughness of a cell against a pull along `normal`: the mean over its links, weighted by their alignment with the pull.
double toughnessAlong( const Lattice& lattice, const LinkLimits& limits, std::uint32_t cell, const Vec3d& normal );

/// Returns the limits ( 1 + strain toughness ) L with rest lengths L. `toughness`: one per link in the order of LinkLimits; empty: 1.
LinkLimits limitLinks( const Lattice& lattice, float strain, std::vector<float> toughness );

/// Returns the toughness for some cells of a lattice (ascending): that of the old links in `before`; new (healed) links have 1.
std::vector<float> inheritToughness( const LinkLimits& before, const Lattice& part, const std::vector<std::uint32_t>& cells );

/// Returns the limits for some cells of a lattice (ascending): those of the old links, computed for `strain`, are kept; healed ones are
/// computed. limitLinks with inheritToughness is the reference implementation.
LinkLimits inheritLimits( const LinkLimits& before, const Lattice& part, const std::vector<std::uint32_t>& cells, float strain );

/// Square of the length beyond which a link of two cells that can break does so: farther where one of them is next to coarse nodes, m^2.
/// `limitSquared`: LinkLimits::lengthSquared of the link.
float breakingSquared( float limitSquared, const CellPositions& positions, std::uint32_t i, std::uint32_t j );

/// Finds all links beyond their limits, ascending. Cells are nodes.
void findOverstretched( const LinkLimits& limits, const NodeState& nodes, std::vector<CellLink>& found );
/// The same where nodes differ in size: links between two cells that can break.
void findOverstretched( const LinkLimits& limits, const CellPositions& positions, std::vector<CellLink>& found );

} // namespace pliant
