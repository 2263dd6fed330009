#pragma once

// Rates of a lattice that fills its grid as the implicit step's kernels sum them: a row a component (kernels/kernel_boxes.h).

#include "matching/kernels/kernels.h"
#include "matching/node_state.h"

#include <cstddef>

namespace pliant {

class FlatBoxes
{
public:
	/// For a grid of gridX x gridY x gridZ nodes, all there; `padded`: their number in whole lanes.
	void layOut( int gridX, int gridY, int gridZ, int halfWidth, int padded );
	/// Borrowed: until it is laid out again.
	FlatRows view();
	std::size_t bytes() const;

private:
	AlignedArray<float> m_rows;
	AlignedArray<int> m_x, m_y;
	std::size_t m_stride = 0, m_margin = 0; ///< between rows; before the first
};

} // namespace pliant
