#pragma once

// The cells of a region: all cells within w links of its owner. Rivers and James 2007, section 3; Ohta et al. 2009, "Preprocessing". In a
// full neighbourhood this is the cube of edge 2w + 1; cracks, gaps and concave corners reduce it.

#include "lattice/lattice.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

class TaskRunner;

/// Regions of half-width w over a lattice: region r belongs to cell r. Membership is symmetric: i is in region j when j is in region i, so
/// that one table serves the gather (cells of a region) and the scatter (regions of a cell).
struct RegionSet
{
	int halfWidth = 1;

	/// Region r holds member[ start[r] .. start[r + 1] ), ascending, including r itself. Empty when `isFullCubes` and the table was not
	/// requested.
	std::vector<std::uint32_t> start;
	std::vector<std::uint32_t> member;

	/// Number of cells of each region, which is also the number of regions that hold the cell (n_c).
	std::vector<std::uint16_t> size;

	/// True where every region is exactly the set of cells within the cube of half-width w around its owner and no lattice position holds
	/// two cells: box sums over the grid then give the same sums as the table.
	bool isFullCubes = false;
};

/// Number of connected parts of the lattice; reads only its links.
int countComponents( const Lattice& lattice );

/// `runner` may be null.
RegionSet buildRegions( const Lattice& lattice, int halfWidth, TaskRunner* runner = nullptr );

} // namespace pliant
