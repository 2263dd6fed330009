#pragma once

// Removes links from a lattice and finds its connected parts. Steinemann et al. 2008, section 5.1; Ohta et al. 2009, "Fracturing".

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// A link between two cells, the lower index first.
struct CellLink
{
	std::uint32_t a = 0, b = 0;

	friend bool operator==( const CellLink& l, const CellLink& r ) { return l.a == r.a && l.b == r.b; }
	friend bool operator<( const CellLink& l, const CellLink& r ) { return l.a != r.a ? l.a < r.a : l.b < r.b; }
};

/// Writes or reads links of a lattice. Refused unless they are ascending, unique, and in the lattice or, with `areAbsent`, between
/// neighbours that have no link.
void archiveLinks( Archive& archive, std::vector<CellLink>& links, const Lattice& lattice, bool areAbsent = false );

/// Returns the lattice without `links`, which are ascending, unique and present.
Lattice withoutLinks( const Lattice& lattice, const std::vector<CellLink>& links );

/// Returns the lattice with `links` added, which are ascending, unique, absent from it and between 26-neighbours.
Lattice withLinks( const Lattice& lattice, const std::vector<CellLink>& links );

/// Returns the cells of each connected part, ascending; parts in the order of their lowest cells.
std::vector<std::vector<std::uint32_t>> connectedParts( const Lattice& lattice );

/// Returns some cells of a lattice (ascending, whole connected parts) as a lattice of its own about its own mass centre. Coordinates are
/// kept, so that the blocks of coarser levels stay the same.
Lattice extractCells( const Lattice& lattice, const std::vector<std::uint32_t>& cells );

} // namespace pliant
