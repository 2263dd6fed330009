#pragma once

// The steps of building an octree, shared with its update.

#include "adapt/octree/octree.h"

namespace pliant {

/// The block of the next coarser level that holds a block.
inline Eigen::Matrix<std::int16_t, 3, 1> blockAbove( const Eigen::Matrix<std::int16_t, 3, 1>& c )
{
	return { std::int16_t( c.x() >> 1 ), std::int16_t( c.y() >> 1 ), std::int16_t( c.z() >> 1 ) };
}

/// Computes children and the depth-first order of the cells from `parent` and `levelStart`.
void orderOctree( Octree& octree );

/// Allocates the measures of each node.
void allocateMeasures( Octree& octree );

/// Computes mass, centre, spread and surface flag of one node from its cells; the arrays must be allocated.
void measureNode( Octree& octree, const Lattice& lattice, std::uint32_t node );

} // namespace pliant
