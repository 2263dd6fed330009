#pragma once

// Which cells a region holds: all that can be reached from its owner in at most w links.
// Rivers and James 2007, section 3; Ohta et al. 2009, "Preprocessing". In a full neighbourhood this is the cube of edge 2w + 1;
// cracks, gaps and concave corners cut it down.

#include "lattice/lattice.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

class TaskRunner;

/// Regions of half-width w over a lattice: region r belongs to cell r. Membership is symmetric: i is in region j when j is in region i,
/// so that one table serves the gather (cells of a region) and the scatter (regions of a cell).
struct RegionSet
{
	int halfWidth = 1;

	/// Region r holds member[ start[r] .. start[r + 1] ), ascending, r itself among them. Empty when `isFullCubes`
	/// and the table was not asked for.
	std::vector<std::uint32_t> start;
	std::vector<std::uint32_t> member;

	/// Cells of each region, which is also the number of regions that hold the cell (n_c).
	std::vector<std::uint16_t> size;

	/// Every region is exactly the cells within the cube of half-width w around its owner, and no lattice position holds two cells:
	/// then box sums over the grid give the same sums as the table.
	bool isFullCubes = false;
};

/// Connected parts of the lattice; its links alone are looked at.
int countComponents( const Lattice& lattice );

/// `runner` may be null.
RegionSet buildRegions( const Lattice& lattice, int halfWidth, TaskRunner* runner = nullptr );

} // namespace pliant
