#pragma once

// Far levels by definition: world coordinates, double precision, sums cell by cell. Reference implementation of CoarseToFine.

#include "matching/step/coarse_to_fine.h"

namespace pliant {

/// Displacement goal - position, m, of each node on level `level` (1: blocks of 2 cells along an edge) at an alpha of 1. The weight of each
/// region's goal is taken from `far`, everything else is computed independently.
std::vector<Vec3d> referenceFarDisplacement( const Lattice& lattice, const NodeState& nodes, const CoarseToFine& far, int level );

} // namespace pliant
