#pragma once

// Where the faces of a body's surface look. For who meets it in something rounder than its cells (world/round_surface.h).

#include "lattice/lattice.h"

namespace pliant {

/// Which cells have open faces, and which way: those of cell i look away from the cells inner[ start[i] .. start[i + 1] ), which lie right behind it along an axis of the
/// lattice, linked to it, with nothing linked on the other side. In the order of x, y, z, low side first. Cells within the body have none.
struct OpenFaces
{
	std::vector<std::uint32_t> start, inner;

	std::size_t bytes() const { return ( start.size() + inner.size() ) * sizeof( std::uint32_t ); }
};

OpenFaces findOpenFaces( const Lattice& lattice );

} // namespace pliant
