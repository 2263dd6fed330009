#pragma once

// The levels above the finest cells. Steinemann et al. 2008, section 4.1 (octree over a base lattice, virtual nodes); Ohta et al. 2009,
// "Preprocessing" (nodes at the centre of mass of each cell of every level).
//
// A block of the next coarser level holds eight blocks. A block whose material consists of several unconnected parts has one node per part:
// a parent never joins parts that the surface or a crack separates.

#include "lattice/lattice.h"

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace pliant {

inline constexpr std::uint32_t kNoNode = std::numeric_limits<std::uint32_t>::max();

/// Nodes of all levels in flat arrays. Level 0 comes first and its node i is cell i of the lattice; then level 1, and so on, each level in
/// the order of z, y, x of its blocks, then by lowest cell. Immutable once built.
struct Octree
{
	int levels = 1;                        ///< 0 .. levels - 1
	std::vector<std::uint32_t> levelStart; ///< first node of each level, and the node count at the end

	std::vector<std::uint32_t> parent;     ///< kNoNode on the highest level
	std::vector<std::uint32_t> childStart; ///< children of node n: child[ childStart[n] .. childStart[n + 1] ), ascending
	std::vector<std::uint32_t> child;

	/// The cells in depth-first order: those of node n are contiguous, cellCount[n] of them from cells[ cellStart[n] ].
	std::vector<std::uint32_t> cells;
	std::vector<std::uint32_t> cellStart;
	std::vector<std::uint32_t> cellCount;

	std::vector<Eigen::Matrix<std::int16_t, 3, 1>> coordinate; ///< block position at the node's own level
	std::vector<double> mass;                                  ///< in full finest cells
	std::vector<Vec3> restCentre;                              ///< m, relative to the lattice's mass centre
	/// Second moment of the node's cells (as points) about restCentre, per mass, cells^2: xx, yy, zz, yz, xz, xy.
	std::vector<std::array<float, 6>> spread;
	std::vector<std::uint8_t> isSurface; ///< 1 where one of its cells is a surface cell

	int nodeCount() const { return int( parent.size() ); }
	int levelOf( std::uint32_t node ) const
	{
		int level = 0;
		while ( node >= levelStart[level + 1] )
		{
			++level;
		}
		return level;
	}
};

/// `coarseLevels`: levels above the finest, 0 to kMaxCoarseLevels.
Octree buildOctree( const Lattice& lattice, int coarseLevels );

/// Checks every invariant of an octree over its lattice; the message names the first violation.
Status validate( const Octree& octree, const Lattice& lattice );

} // namespace pliant
