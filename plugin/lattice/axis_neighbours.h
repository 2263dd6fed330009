#pragma once

// Which cells lie right beside a cell along the lattice's axes, linked to it. For who asks how the material around a node is stretched and
// turned.

#include "lattice/lattice.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

/// By cell: its neighbours on the low and the high side of x, y and z; -1: nothing is linked there.
using AxisNeighbours = std::vector<std::array<std::int32_t, 6>>;

AxisNeighbours findAxisNeighbours( const Lattice& lattice );

} // namespace pliant
