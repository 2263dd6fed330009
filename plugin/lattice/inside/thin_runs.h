#pragma once

// Which cells are thin, so that lengths of runs weigh their material and not samples.

#include "lattice/inside/voxelize.h"

namespace pliant {

/// Only where the material is thin: where no more than one sample stands in most runs. Rows along each axis measure the same material;
/// the axis with most rows through it looks across it. (Choosing by what the samples happened to see would favour lucky estimates.)
/// Sorts `slivers`; those kept go to `voxels`, with their samples marked.
void keepThinRuns( std::vector<Sliver>& slivers, Voxels& voxels );

} // namespace pliant
