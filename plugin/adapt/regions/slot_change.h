#pragma once

// Maps the slots of a cut to those after a change of the cut or of the links.

#include "adapt/regions/region_matrix.h"

namespace pliant {

/// The effect of a cut's change on its slots.
struct SlotChange
{
	/// Of each old slot: its slot, or that of the merged node that contains it; kNoNode where it was split or removed.
	std::vector<std::uint32_t> now;
	std::vector<std::uint32_t> before;   ///< of each new slot: its old slot; kNoNode where it is new
	std::vector<std::uint8_t> wasMerged; ///< of each new slot
};

SlotChange slotChange( const Octree& octree, const Cut& from, const Cut& to );

/// Nodes whose finest regions changed count as split, each into itself.
SlotChange slotChange( const RelinkedNodes& nodes );

/// Returns the old slots whose new numbers are not in the order of the old ones.
std::vector<std::uint32_t> slotsOutOfOrder( const std::vector<std::uint32_t>& now );

} // namespace pliant
