#pragma once

// Regions that the surface or a crack cuts short, wider than one cell: the moment they should have.
//
// A uniform strain S costs a region |S|^2 with its second moment J. A region of half-width w that is cut down to w + 1 layers has lost more
// of J than of its share of the material: with w = 2 half a region has a quarter. A block of 6 cells then gives way by a third more than
// sigma / E. What a link of the lattice carries is shared out instead, like a cell's mass: over the regions that hold both its ends.
//
//   J* = mu sum over the axes' links in the region of m_ij / n_ij e e^T,   mu = w ( w + 1 ) / 3
//
// n_ij regions hold link ij of mass m_ij, the mean of its cells'. A whole region has J* = J, and the regions of any body together have mu a
// link: the strain energy of the body under uniform strain is that of its links. Regions follow J* as they do a finer body's moment
// (level_tables.h): A_pq C is what the rotation is fitted to and L = F + ( R - F ) C^T the goal, C = J^+ J*.
// Beyond the papers; docs/design/implicit.md has what it brings.

#include "lattice/lattice.h"
#include "pliant/material.h"

namespace pliant {

struct RegionTables;

/// Whether a body of this material gets them: implicit steps of regions wider than 1. At w = 1 the sums over all regions agree anyhow.
bool usesLinkMoments( const Material& material );

/// Fills `blend`, `rateFraction` and `ratePull`. The tables must still have their members, J and J^+.
void applyLinkMoments( const Lattice& lattice, const Material& material, RegionTables& tables );

} // namespace pliant
