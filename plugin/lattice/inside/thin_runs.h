#pragma once

// Finds thin cells, whose material is weighed by the lengths of runs rather than by samples.

#include "lattice/inside/voxelize.h"

namespace pliant {

/// Keeps runs only in thin cells, where most runs contain at most one sample. Rows along each axis measure the same material; the axis with
/// most rows through it is the one across it. (Choosing by the samples that happen to hit would favour high estimates.) Sorts `slivers`;
/// the kept ones go to `voxels`, with their samples marked.
void keepThinRuns( std::vector<Sliver>& slivers, Voxels& voxels );

} // namespace pliant
