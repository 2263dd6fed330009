#pragma once

// Constants only: sources compiled for one instruction set must share no code.

namespace pliant {

/// b of volume keeping (volumeMatrix, volumeMean): b tr( J^+ ), the stiffness against compression, is at most this multiple of its value
/// for equal moments. At 1, the smallest of these means, E of a bar of 6 x 6 cells is .95 of the set value at kappa 2; the explicit step is
/// stable up to 1.17.
inline constexpr float kVolumeLimit = 1.15f;

/// Volume keeping does not rotate regions so thin that the determinant of tr M - M is below this fraction of their moments' sum cubed.
inline constexpr float kLeastTurning = 1e-3f;

} // namespace pliant
