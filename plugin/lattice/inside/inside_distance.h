#pragma once

// How deep in the material each cell lies, and which way is out. Steinemann et al. 2008, section 7: "a distance field inside an object
// through a simple flooding algorithm that is seeded at the simulation nodes near the object's surface".

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// Lengths of links along one, two and three axes, tenths of a cell: 1, sqrt( 2 ), sqrt( 3 ) in whole numbers, so that a flood has one
/// result.
inline constexpr std::uint32_t kLinkTenths[4] = { 0, 10, 14, 17 };

/// Tenths of a cell along the links to the nearest surface cell (Lattice::isSurface); 0 for those. Cells that no surface cell is linked to,
/// however far off, cannot be.
std::vector<std::uint32_t> floodInside( const Lattice& lattice );

/// The same after links have gone, from the distances before (of the cells that are left): what came to the surface through such a link is
/// nearer to it than it was, and nothing is farther. `touched`: the cells that lost links. False, and nothing done, where one of them is
/// not surface (links came back), or none is named. floodInside is the slow twin.
bool followInside( const Lattice& lattice, const std::vector<std::uint32_t>& touched, std::vector<std::uint32_t>& depth );

/// Which way is out of the material at a cell, at rest; not of unit length, zero where no side is nearer than its opposite:
///   n_i = sum over links of ( D_i - D_j ) ( x_j - x_i ) / |x_j - x_i|^2 - sum over links of ( x_j - x_i ) / |x_j - x_i|
/// the flood's fall, and what is missing about the cell: on the surface the flood alone is flat.
Vec3 outwardOf( const Lattice& lattice, const std::vector<std::uint32_t>& depth, std::uint32_t cell );

} // namespace pliant
