#pragma once

// The depth of each cell in the material and the outward direction. Steinemann et al. 2008, section 7: "a distance field inside an object
// through a simple flooding algorithm that is seeded at the simulation nodes near the object's surface".

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// Lengths of links along one, two and three axes, tenths of a cell: 1, sqrt( 2 ), sqrt( 3 ) as integers, so that results are unique.
inline constexpr std::uint32_t kLinkTenths[4] = { 0, 10, 14, 17 };

/// Returns the distances along the links to the nearest surface cell (Lattice::isSurface), tenths of a cell; 0 for surface cells. Every
/// connected part has a surface cell.
std::vector<std::uint32_t> floodInside( const Lattice& lattice );

/// Updates the distances of the remaining cells after links were removed: distances can only shrink. `touched`: the cells that lost links.
/// Returns false, with `depth` unchanged, where one of them is not a surface cell (links were added) or `touched` is empty. floodInside is
/// the reference implementation.
bool updateInside( const Lattice& lattice, const std::vector<std::uint32_t>& touched, std::vector<std::uint32_t>& depth );

/// Returns the outward direction of the material at a cell at rest; not of unit length, zero where opposite sides are equally near:
///   n_i = sum over links of ( D_i - D_j ) ( x_j - x_i ) / |x_j - x_i|^2 - sum over links of ( x_j - x_i ) / |x_j - x_i|
/// the gradient of the flood and the missing neighbours: on the surface the flood alone is constant.
Vec3 outwardOf( const Lattice& lattice, const std::vector<std::uint32_t>& depth, std::uint32_t cell );

} // namespace pliant
