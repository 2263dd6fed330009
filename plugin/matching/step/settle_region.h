#pragma once

// The robust scalar path for one region whose rotation the kernels' lanes left undetermined.

#include "matching/kernels/kernels.h"

namespace pliant {

/// Fits the rotation of region r and writes its record.
void settleRegion( const Kernels& kernels, const MatchView& view, int r );

} // namespace pliant
