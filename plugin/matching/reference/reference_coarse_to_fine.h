#pragma once

// Far levels as they are defined: world coordinates, double precision, every region summed cell by cell. The slow twin of CoarseToFine.

#include "matching/step/coarse_to_fine.h"

namespace pliant {

/// What level `level` (1: blocks of 2 cells an edge) asks of each node at a share of 1, goal - position, m. How much of each region's goal
/// counts is taken from `far`, all else is measured anew.
std::vector<Vec3d> referenceFarDisplacement( const Lattice& lattice, const NodeState& nodes, const CoarseToFine& far, int level );

} // namespace pliant
