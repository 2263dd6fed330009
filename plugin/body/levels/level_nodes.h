#pragma once

// Node arrays across changes of their number, and the conservation of the body's momentum and spin. Steinemann et al. 2008, section 5.2.

#include "matching/node_state.h"

#include <array>

namespace pliant {

/// Positions, velocities, rest positions, masses, freedom.
std::array<AlignedArray<float>*, 11> arraysOf( NodeState& nodes );

/// Changes the count; entries below `count` are undefined afterwards, padding is zero.
void resizeNodes( NodeState& nodes, int count );

/// Adds one rigid motion to all nodes that restores the momentum and spin of `before`, unless a node is pinned: a coarse node has no spin
/// of its own, so that its children have more than it had.
void restoreMomentum( NodeState& nodes, const NodeState& before );

/// Removes up to `joules` from the nodes' internal motion; their total momentum and spin, and pinned nodes, stay unchanged. Returns the
/// removed energy.
double removeInternalMotion( NodeState& nodes, double joules );

} // namespace pliant
