#pragma once

// Every number of the core that is neither an input nor a law, with its unit and its reason.

#include <cstddef>

namespace pliant {

/// Virtual lanes of a kernel. One AVX-512 register, two AVX2 or four SSE2/NEON ones: the arithmetic is the same on each.
inline constexpr int kLanes = 16;

/// Alignment of hot arrays, bytes: one cache line, one 16-lane vector.
inline constexpr std::size_t kAlignment = 64;

/// Eigenvalues of a second moment below this share of its largest are taken as zero when it is inverted (flat or thin regions).
inline constexpr float kMomentFloor = 1e-3f;

/// Alpha above this is cut: the explicit step is safe up to here (algorithm derivation in docs/step.md).
inline constexpr float kLargestAlpha = 1.0f;

/// A body's origin follows its mass centre in multiples of this length, m, once it has strayed by more: a power of two, so that
/// the move is exact in binary and the same on every machine.
inline constexpr double kRebaseGrid = 1.0;

/// Speed above which a node is held back, m/s: faster is an error of the game, and 16-bit cell hashes and float contacts end here.
inline constexpr float kSpeedLimit = 1.0e5f;

} // namespace pliant
