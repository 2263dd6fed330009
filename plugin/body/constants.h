#pragma once

// Constants of bodies and templates, each with its unit and reason.

namespace pliant {

/// Bounds of the factor by which a template may be scaled: outside of them squares of a model's lengths leave the range of single
/// precision.
inline constexpr float kSmallestScale = 1e-6f, kLargestScale = 1e6f;

/// Squared angular velocity of a body, times its length over g: below the first it rocks at rest, as in stacks and heaps; above the second,
/// a ball of 0.4 m at 0.7 m/s, it rolls: what a step takes from its rotation is returned, and its nodes land as deep as they were apart.
inline constexpr double kRockingTurn = 0.025, kFreeTurn = 0.25;

} // namespace pliant
