#pragma once

// Sphere radii of nodes that represent many cells, and which nodes need a sphere. Ohta et al. 2009, "Collision Detection".
//
// The sphere of a finest cell has the radius ( d / 2 ) cbrt( fill ). A coarse node's sphere reaches as far as its cells' spheres do: r is
// the median, over those cells' open faces, of
//   ( x0_cell - x0_node ) . n_face + ( d / 2 ) cbrt( fill_cell )
// so that objects rest on a coarse node about as high as on its cells, whatever its shape: a full block of 2^l cells an edge has r = 2^l d
// / 2, a slab four cells wide and two thick has r = d. Where the shape has several thicknesses the widest side decides. A node without open
// faces has the sphere of its volume, r = ( d / 2 ) cbrt( mass ). No radius is larger than that, or smaller than the largest cell's.
// One sphere per node leaves grooves between neighbours, at worst half a node deep: objects smaller than a node need finer nodes there
// (Adaptivity::refinesOnContact).

#include "adapt/octree/octree.h"

namespace pliant {

/// Values of each node of the octree, in the cut or not: they do not depend on the nodes around it.
struct NodeColliders
{
	std::vector<float> radius; ///< m
	/// 1 for the surface and one layer below it: nodes with a cell no more links from the surface than the node is cells wide.
	std::vector<std::uint8_t> collides;
	/// Links from each finest cell to the nearest surface cell, counted up to the largest node's width in cells; one more beyond.
	std::vector<std::uint8_t> depth;
};

NodeColliders measureColliders( const Lattice& lattice, const Octree& octree );

/// How a fracture or a restored link changed cells and octree, as in CellChange and OctreeUpdate.
struct CollidersChange
{
	const std::vector<std::uint32_t>& nodeBefore;
	const std::vector<std::uint32_t>& cellBefore;
	const std::vector<std::uint32_t>& touched;
};

/// Updates the colliders from those before: only what is near touched cells is measured. measureColliders is the reference implementation,
/// with identical bits where no cells were removed.
NodeColliders followColliders( const Lattice& lattice, const Octree& octree, const NodeColliders& before, const CollidersChange& change );

} // namespace pliant
