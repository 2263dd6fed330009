#pragma once

// How large the sphere of a node is that stands for many cells, and which nodes need one. Ohta et al. 2009, "Collision Detection".
//
// The sphere of a finest cell has the radius ( d / 2 ) cbrt( fill ). A big node's sphere reaches as far as its cells' spheres do: r is the
// median, over those of their faces that lie open, of
//   ( x0_cell - x0_node ) . n_face + ( d / 2 ) cbrt( fill_cell )
// so that things rest on a big node about as high as on the cells it stands for, whatever its shape: a full block of 2^l cells an edge has
// r = 2^l d / 2, a slab four cells wide and two thick has r = d. Where the shape has several thicknesses the widest side decides. A node
// without open faces has the ball of its volume, r = ( d / 2 ) cbrt( mass ); no node has more, or less than its largest cell.
// One ball a node leaves grooves between neighbours, half a node deep at the worst: what is smaller than a node needs finer ones there
// (Adaptivity::refinesOnContact).

#include "adapt/octree/octree.h"

namespace pliant {

/// Of each node of the octree, in the cut or not: what it brings to a collision does not depend on what stands around it.
struct NodeColliders
{
	std::vector<float> radius; ///< m
	/// 1 for the surface and one layer below it: nodes with a cell no more links from the surface than the node is cells wide.
	std::vector<std::uint8_t> collides;
	/// Links from each finest cell to the nearest of the surface, counted up to as many as the largest node is cells wide; one more beyond.
	std::vector<std::uint8_t> depth;

	std::size_t bytes() const { return radius.size() * ( sizeof( float ) + 1 ) + depth.size(); }
};

NodeColliders measureColliders( const Lattice& lattice, const Octree& octree );

/// What became of cells and octree when links went or came back, or some of the cells did. As in CellChange and OctreeUpdate.
struct CollidersChange
{
	const std::vector<std::uint32_t>& nodeBefore;
	const std::vector<std::uint32_t>& cellBefore;
	const std::vector<std::uint32_t>& touched;
};

/// The same for the body as it is now, from those before: only what is near touched cells is measured. measureColliders is the slow twin,
/// to the bit where no cells went.
NodeColliders followColliders( const Lattice& lattice, const Octree& octree, const NodeColliders& before, const CollidersChange& change );

} // namespace pliant
