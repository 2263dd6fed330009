#pragma once

// Numbers of the preprocessing, each with its reason.

namespace pliant {

/// Cells around a cell: 3^3 - 1.
inline constexpr unsigned kNeighbours = 26;

/// Lattice positions along an axis: coordinates are 16-bit.
inline constexpr int kMaxExtent = 32767;

/// What float rounding of positions may amount to, as a share of the lattice's size: 8 units in the last place.
inline constexpr double kRoundingShare = 1e-6;

} // namespace pliant
