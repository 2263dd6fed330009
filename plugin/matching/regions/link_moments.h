#pragma once

// Corrected moments of regions, wider than one cell, that the surface or a crack truncates.
//
// A uniform strain S costs a region |S|^2 with its second moment J. A region of half-width w truncated to w + 1 layers loses a larger
// fraction of J than of its material: with w = 2 half a region keeps a quarter. A block of 6 cells would yield a third more than sigma / E.
// Instead, the moment of each lattice link is divided, like a cell's mass, among the regions that hold both its ends.
//
//   J* = mu sum over the axes' links in the region of m_ij / n_ij e e^T,   mu = w ( w + 1 ) / 3
//
// n_ij regions hold link ij of mass m_ij, the mean of its cells' masses. A full region has J* = J, and the regions of any body together
// have mu per link: the strain energy of the body under uniform strain is that of its links. J* enters like the moment of a finer body
// (level_tables.h): the rotation is fitted to A_pq C and the goal is L = F + ( R - F ) C^T, C = J^+ J*. Not in the papers; see
// docs/design/implicit.md.

#include "lattice/lattice.h"
#include "pliant/material.h"

namespace pliant {

struct RegionTables;

/// True where a body of this material uses link moments: implicit steps of regions wider than 1. At w = 1 they change nothing in sum.
bool usesLinkMoments( const Material& material );

/// Fills `blend`, `rateFraction` and `ratePull`. The tables must still hold their members, J and J^+.
void applyLinkMoments( const Lattice& lattice, const Material& material, RegionTables& tables );

} // namespace pliant
