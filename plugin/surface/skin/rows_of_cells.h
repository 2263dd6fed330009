#pragma once

// Finds the vertices that follow given cells, to measure how a change of levels moves the skin.

#include "surface/skin/skinning.h"

namespace pliant {

class CellComplex;

/// By row of the binding: 1 where it contains one of the cells `isWanted`.
std::vector<char> rowsThatHold( const SkinBinding& binding, const std::vector<char>& isWanted );

/// A superset of it, found faster in a binding with points (SkinBinding::point): rows at points of the complex that one of the cells
/// carries or draws. `cellsInComplex`: by cell of the body, its index in the complex; empty: equal.
std::vector<char> rowsAtPointsOf( const SkinBinding& binding, const std::vector<char>& isWanted, const CellComplex& complex,
	const std::vector<std::uint32_t>& cellsInComplex );

} // namespace pliant
