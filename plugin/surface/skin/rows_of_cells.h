#pragma once

// Which vertices follow some cells: what a change of levels moves the skin by is looked for at these.

#include "surface/skin/skinning.h"

namespace pliant {

class CellComplex;

/// Of each row of the binding: 1 where it holds one of the cells, `isWanted` by their numbers.
std::vector<char> rowsThatHold( const SkinBinding& binding, const std::vector<char>& isWanted );

/// The same, and some others' more, in a binding that names its points (SkinBinding::point), sooner: of each row at a point of the complex
/// that one of the cells carries or draws at. `cellsThere`: the numbers the body's cells have in the complex; empty: the same.
std::vector<char> rowsAtPointsOf( const SkinBinding& binding, const std::vector<char>& isWanted, const CellComplex& complex,
	const std::vector<std::uint32_t>& cellsThere );

} // namespace pliant
