#pragma once

// Second and fourth moments of the finest regions under each node of the octree. An extension of Ohta et al. 2009, eq. 7-10, which depend
// on size alone.

#include "adapt/regions/region_matrix.h"

#include <array>

namespace pliant {

/// Sums over the finest regions under each octree node. Lengths in cells, masses in full cells.
struct FineMoments
{
	/// Covariance of the nine monomials x, y, z, xx, yy, zz, yz, xz, xy about the node's rest centre, each finest region about its own
	/// mean, summed: the lower triangle row by row. Its first three rows are J_fine.
	std::vector<std::array<float, 45>> covariance;
};

FineMoments buildFineMoments( const Octree& octree, const Lattice& lattice, const FineRegions& fine );

/// Compute the moments of one finest region, and those of a node above from its children: the steps of buildFineMoments.
void measureFineRegion( const Lattice& lattice, const FineRegions& fine, std::uint32_t cell, FineMoments& moments );
void sumFineMoments( const Octree& octree, const Lattice& lattice, std::uint32_t node, FineMoments& moments );

} // namespace pliant
