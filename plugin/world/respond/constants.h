#pragma once

// Constants of the explicit contact path's corrections, each with its unit and reason.

namespace pliant {

/// An explicit body that is simulated with less than this fraction of its Young's modulus rebounds by restitution, others by their
/// elasticity. There is no mean of the two: a body that is stopped half-way rebounds by neither.
inline constexpr float kRestitutionReach = 0.5f;

/// Rounds in which such a body gets its velocity, and the fraction of the velocity of approach that may remain: with half of the mass in
/// the nodes that touch, each round halves what remains.
inline constexpr int kBounceRounds = 16;
inline constexpr double kBounceError = 1e-3;

} // namespace pliant
