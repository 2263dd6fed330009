#pragma once

// Finds the cells that are adjacent and linked to a cell along the lattice axes. Used to measure stretch and rotation around a node.

#include "lattice/lattice.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

/// Per cell: its neighbours on the low and the high side of x, y and z; -1 where no linked neighbour exists.
using AxisNeighbours = std::vector<std::array<std::int32_t, 6>>;

AxisNeighbours findAxisNeighbours( const Lattice& lattice );

/// Whether two cells are adjacent along an axis, linked or not.
inline bool shareFace( const Lattice& lattice, std::uint32_t a, std::uint32_t b )
{
	return ( lattice.coordinate[a].cast<int>() - lattice.coordinate[b].cast<int>() ).cwiseAbs().sum() == 1;
}

} // namespace pliant
