#pragma once

// What becomes of the slots of a cut when it changes, or when links do.

#include "adapt/regions/region_matrix.h"

namespace pliant {

/// What the change of a cut means for its slots.
struct SlotChange
{
	std::vector<std::uint32_t>
		now; ///< of each old slot: its slot, or that of the merged node that took it in; kNoNode where it was split or went
	std::vector<std::uint32_t> before;   ///< of each new slot: its old slot; kNoNode where it is new
	std::vector<std::uint8_t> wasMerged; ///< of each new slot
};

SlotChange slotChange( const Octree& octree, const Cut& from, const Cut& to );

/// Nodes in whose finest regions something changed count as split, each into itself.
SlotChange slotChange( const RelinkedNodes& nodes );

/// Old slots whose new numbers do not stand in the order of the old ones.
std::vector<std::uint32_t> slotsOutOfOrder( const std::vector<std::uint32_t>& now );

} // namespace pliant
