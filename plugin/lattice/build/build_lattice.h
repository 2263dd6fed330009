#pragma once

// From a triangle mesh to cells and links: the whole of Ohta et al. 2009, "Preprocessing", at the finest level.

#include "lattice/lattice.h"
#include "pliant/body_template.h"

#include <cstdint>
#include <vector>

namespace pliant {

struct LatticeBuild
{
	Lattice lattice;
	std::vector<std::uint32_t> weldedVertex; ///< per input vertex; vertices with one number are one place
	BuildReport report;
};

/// The first knob out of its range, or Ok. Rejects NaN.
Status checkSettings( const LatticeSettings& settings );

/// The answer when memory runs out; itself content with none.
Status outOfMemory() noexcept;

/// Does not throw: what goes wrong is in the status.
Result<LatticeBuild> buildLattice( const MeshView& mesh, const LatticeSettings& settings );

} // namespace pliant
