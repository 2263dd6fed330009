#pragma once

// Rates on a lattice that fills its grid, in the layout of the implicit step's kernels: one row per component (kernels/kernel_boxes.h).

#include "matching/kernels/kernels.h"
#include "matching/node_state.h"

#include <cstddef>

namespace pliant {

class FlatBoxes
{
public:
	/// For a grid of gridX x gridY x gridZ nodes without holes; `padded`: their number rounded up to whole lanes.
	void layOut( int gridX, int gridY, int gridZ, int halfWidth, int padded );
	/// Returned pointers are valid until the next layOut.
	FlatRows view();

private:
	AlignedArray<float> m_rows;
	AlignedArray<int> m_x, m_y;
	std::size_t m_stride = 0, m_margin = 0; ///< between rows, and before the first
};

} // namespace pliant
