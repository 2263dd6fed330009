#pragma once

// Constants only: sources compiled for one instruction set must share no code.

namespace pliant {

/// b of volume conservation (volumeWeights): b tr( J^+ ), the stiffness against compression, is at most this multiple of its value for
/// equal moments. The explicit step is stable up to 1.17.
inline constexpr float kVolumeLimit = 1.15f;

/// Share of a region's own moments in the weights B of volume conservation: a bar of 6 x 6 cells has the Poisson's ratio that is set,
/// and .97 of Young's modulus (.95 without); with more it contracts too much.
inline constexpr float kMomentShare = 0.25f;

/// Volume conservation does not rotate regions so thin that the determinant of tr M - M is below this fraction of their moments' sum cubed.
inline constexpr float kLeastTurning = 1e-3f;

/// Newton steps to the volume-preserving shape: they leave no more than float rounding up to a stretch of a hundred.
inline constexpr int kVolumeSteps = 7;

/// Half of | dev U |^2 from which on a shape has no meaning, and its cube would not be a float.
inline constexpr float kMostDeviator = 1e10f;

/// MatchView::mostVolumeResponse of a step that bears any stiffness.
inline constexpr float kAnyVolumeResponse = 1e30f;

} // namespace pliant
