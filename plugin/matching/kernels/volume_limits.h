#pragma once

// No code here: what is compiled for one instruction set must share none.

namespace pliant {

/// b of kept volume (volumeMatrix, volumeMean): b tr( J^+ ), which says how hard a squeeze is answered, is at most so many times what it is
/// where all moments are the same. With the least of these means, at 1, E of a bar of 6 x 6 cells is .95 of what it is set to at kappa 2;
/// the explicit step is safe up to 1.17.
inline constexpr float kVolumeLimit = 1.15f;

/// What is so thin that the determinant of tr M - M is less than this share of its moments' sum cubed is not turned by kept volume.
inline constexpr float kLeastTurning = 1e-3f;

} // namespace pliant
