#pragma once

// The steps of which an octree is made, for those who make one out of another.

#include "adapt/octree/octree.h"

namespace pliant {

/// The block of the level above that holds a block.
inline Eigen::Matrix<std::int16_t, 3, 1> blockAbove( const Eigen::Matrix<std::int16_t, 3, 1>& c )
{
	return { std::int16_t( c.x() >> 1 ), std::int16_t( c.y() >> 1 ), std::int16_t( c.z() >> 1 ) };
}

/// Children and the depth-first order of the cells, from `parent` and `levelStart`.
void orderOctree( Octree& octree );

/// Room for what is measured of each node.
void allocateMeasures( Octree& octree );

/// Mass, centre, spread and surface of one node from its cells; the arrays have their sizes.
void measureNode( Octree& octree, const Lattice& lattice, std::uint32_t node );

} // namespace pliant
