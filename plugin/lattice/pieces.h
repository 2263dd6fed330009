#pragma once

// Links taken out of a lattice, and the parts it then falls into. Steinemann et al. 2008, section 5.1; Ohta et al. 2009, "Fracturing".

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// A link between two cells, the lower number first.
struct CellLink
{
	std::uint32_t a = 0, b = 0;

	friend bool operator==( const CellLink& l, const CellLink& r ) { return l.a == r.a && l.b == r.b; }
	friend bool operator<( const CellLink& l, const CellLink& r ) { return l.a != r.a ? l.a < r.a : l.b < r.b; }
};

/// The lattice without some of its links: `links` ascending, each once, all of them there.
Lattice withoutLinks( const Lattice& lattice, const std::vector<CellLink>& links );

/// The lattice with links put back: `links` ascending, each once, none of them there, all between 26-neighbours.
Lattice withLinks( const Lattice& lattice, const std::vector<CellLink>& links );

/// The cells of each connected part, ascending; parts in the order of their lowest cells.
std::vector<std::vector<std::uint32_t>> connectedParts( const Lattice& lattice );

/// The same of a lattice in which every part has one of `seeds`, each once: one that was connected, and those are the ends of all links it
/// lost. They look for each other side by side, and what is cut a little further finds itself soon around the cut's edge.
std::vector<std::vector<std::uint32_t>> connectedParts( const Lattice& lattice, const std::vector<std::uint32_t>& seeds );

/// Some cells of a lattice (ascending, whole connected parts) as a lattice of their own, about their own mass centre. Coordinates stay, so
/// that blocks of higher levels are the same ones.
Lattice extractCells( const Lattice& lattice, const std::vector<std::uint32_t>& cells );

} // namespace pliant
