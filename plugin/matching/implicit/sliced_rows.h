#pragma once

// Rows of a region matrix in the layout of the implicit step's kernels, which sum the same rows some hundred times: four rows of about the
// same length side by side, padded to the longest ("sliced ELLPACK": Kreutzer et al. 2014, SELL-C-sigma, with C = 4 and sigma one tile).
// Summed singly, each row costs a mispredicted branch and a chain of dependent additions.

#include "matching/kernels/kernels.h"
#include "matching/node_state.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

struct RegionMatrix;

class SlicedRows
{
public:
	/// Every row must have at least one term.
	void layOut( const RegionMatrix& matrix );
	/// Returned pointers are valid as long as the rows do not change.
	RowSlices view() const;
	std::size_t bytes() const;

private:
	void fill( const RegionMatrix& matrix, const RowSlice& slice, std::uint32_t tileBegin );

	std::vector<RowSlice> m_slices;
	std::vector<std::uint32_t> m_tiles; ///< first slice of each tile, and the total
	std::vector<std::uint32_t> m_from, m_keys;
	AlignedArray<float> m_mass, m_fraction;
};

} // namespace pliant
