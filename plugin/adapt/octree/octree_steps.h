#pragma once

// The steps of building an octree, shared with its update.

#include "adapt/octree/octree.h"
#include "lattice/union_find.h"

#include <functional>

namespace pliant {

/// Joins nodes of the highest level that belong to one part of a block of the next level. `nodeOfCell`: of that level; `parts`: its nodes.
using JoinNodes = std::function<void( const Octree& octree, const std::vector<std::uint32_t>& nodeOfCell, UnionFind& parts )>;

/// Joins a node to those of its block to which links of one of its cells lead.
void joinByLinks(
	const Octree& octree, const Lattice& lattice, const std::vector<std::uint32_t>& nodeOfCell, std::uint32_t cell, UnionFind& parts );

/// Builds all but the measures of the nodes, which are allocated.
Octree assembleOctree( const Lattice& lattice, int coarseLevels, const JoinNodes& join );

/// Computes mass, centre, spread and surface flag of one node from its cells.
void measureNode( Octree& octree, const Lattice& lattice, std::uint32_t node );

} // namespace pliant
