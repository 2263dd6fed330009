#pragma once

// Rows of a region matrix as the implicit step's kernels sum them, some hundred times with the same rows: four rows of about the same
// length side by side, padded to the longest ("sliced ELLPACK": Kreutzer et al. 2014, SELL-C-sigma, with C = 4 and sigma one tile). Row by
// row, each ends where the processor does not expect it, and waits for its own additions.

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
	/// Every row has one term at least.
	void layOut( const RegionMatrix& matrix );
	/// Borrowed: as long as the rows stay as they are.
	RowSlices view() const;
	std::size_t bytes() const;

private:
	void fill( const RegionMatrix& matrix, const RowSlice& slice, std::uint32_t tileBegin );

	std::vector<RowSlice> m_slices;
	std::vector<std::uint32_t> m_tiles; ///< first slice of each tile, and the end
	std::vector<std::uint32_t> m_from, m_keys;
	AlignedArray<float> m_mass, m_fraction;
};

} // namespace pliant
