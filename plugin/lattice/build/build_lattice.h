#pragma once

// Builds cells and links from a triangle mesh: the whole of Ohta et al. 2009, "Preprocessing", at the finest level.

#include "lattice/lattice.h"
#include "pliant/body_template.h"

#include <cstdint>
#include <vector>

namespace pliant {

struct LatticeBuild
{
	Lattice lattice;
	std::vector<std::uint32_t> weldedVertex; ///< per input vertex; vertices with the same number share a position
	BuildReport report;
};

/// Returns an error for the first setting out of its range, or Ok. Rejects NaN.
Status checkSettings( const LatticeSettings& settings );

/// Does not throw: errors are reported in the status.
Result<LatticeBuild> buildLattice( const MeshView& mesh, const LatticeSettings& settings );

} // namespace pliant
