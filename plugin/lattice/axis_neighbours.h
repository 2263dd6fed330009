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

} // namespace pliant
