#pragma once

// Bodies of the adaptive scenes, made in code.

#include "third_party_glue/model_file.h"

#include <array>
#include <vector>

namespace pliant_demos {

/// A palm of `blocks` blocks of eight cells, its lower corner at the origin, and thin fingers that hang below it along -y, each two
/// cells thick. Palm and fingers stand on the lattice of edge `cell`: blocks of the palm are full, blocks at a finger a quarter full.
struct PalmPlan
{
	float cell = 0.02f;
	int blocks[3] = { 5, 4, 3 };
	int fingerCells = 24; ///< length
	std::vector<std::array<int, 2>> fingers; ///< where each hangs: cells along x and z, even numbers

	float width( std::size_t axis ) const { return 8 * cell * float( blocks[axis] ); }
};
pliant_glue::ModelMesh makePalm( const PalmPlan& plan );

} // namespace pliant_demos
