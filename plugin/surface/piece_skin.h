#pragma once

// The skin of a piece that came off: the vertices of the whole mesh whose material the piece holds, carried by the piece's own cells.

#include "surface/skinning.h"

namespace pliant {

struct PieceSkin
{
	SkinBinding binding;                ///< all vertices of the whole mesh, so that vertex i stays vertex i; those of other pieces are not drawn
	std::vector<std::uint32_t> indices; ///< of the triangles whose vertices all are the piece's
};

/// `cells`: of each of the piece's cells its number in the lattice the mesh was bound to, ascending. `shift`: the piece's mass centre seen from
/// the whole's, m. A vertex belongs to the piece that holds the cell it follows most.
PieceSkin makePieceSkin( const SkinBinding& whole, const SkinTriangles& triangles, const std::vector<std::uint32_t>& cells, const Vec3& shift );

} // namespace pliant
