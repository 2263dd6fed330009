#pragma once

// Limits of what may be asked of fracture, and what its rules are tuned by.

namespace pliant {

inline constexpr float kLargestBreakStrain = 10.0f;
inline constexpr float kLargestStrength = 1e12f;   // Pa
inline constexpr float kLongestCoolDown = 10.0f;   // s
inline constexpr int kLargestSmallPiece = 1000000; // cells
inline constexpr float kLongestFade = 3600.0f;     // s
inline constexpr int kMostPieces = 100000;

/// Bodies with levels that can break are refined at this share of the stretch they break at, so that what breaks is always finest cells.
inline constexpr float kRefineBeforeBreak = 0.5f;

} // namespace pliant
