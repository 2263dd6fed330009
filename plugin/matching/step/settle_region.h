#pragma once

// The careful scalar road for one region that the lanes left open.

#include "matching/kernels/kernels.h"

namespace pliant {

/// Settles the rotation of region r and writes its record.
void settleRegion( const Kernels& kernels, const MatchView& view, int r );

} // namespace pliant
