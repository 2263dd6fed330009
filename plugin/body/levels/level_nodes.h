#pragma once

// Nodes while their number changes: arrays, and what a change must not do to the body's momentum and spin.
// Steinemann et al. 2008, section 5.2.

#include "matching/node_state.h"

#include <array>

namespace pliant {

/// Positions, velocities, rest positions, masses, freedom.
std::array<AlignedArray<float>*, 11> arraysOf( NodeState& nodes );

/// Other counts; what the arrays hold below `count` is undefined afterwards, padding is zero.
void resizeNodes( NodeState& nodes, int count );

/// One rigid motion for all nodes, where none is held, gives back the momentum and the spin that those before had: a big node has no spin
/// of its own, so that its children's is more than there was.
void restoreMotion( NodeState& nodes, const NodeState& before );

/// Takes as many joules out of how the nodes move against one another, or what there are: they keep the momentum and the spin of all
/// together, and those that are held their speeds. Returns how many.
double takeOwnMotion( NodeState& nodes, double joules );

} // namespace pliant
