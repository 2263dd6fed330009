#pragma once

// Builds a cell complex from a mesh and a lattice; see CellComplex::build.

#include "surface/crack_complex/cell_complex.h"

namespace pliant {

/// Call it within `withinMemory` (lattice/attempt.h).
void buildComplex( const MeshView& mesh, const Lattice& lattice, const SkinBinding& skin, const LatticeSettings& build,
	const CrackSettings& settings, CellComplex& out );

} // namespace pliant
