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

/// Around a node that is split for it so are those strained by this share of that: one border between sizes, and not one after the other,
/// each of which leaves its own ringing behind.
inline constexpr float kRefineTogether = 0.6f;

/// Where big nodes meet small ones strains are off by as much as half: a small one that is linked to a big one breaks at this many times
/// what was set. The road not taken is to let nothing break within some links of a big node: impacts are over before all that has been
/// split, and a half to a thirtieth of what breaks on the uniform lattice broke.
inline constexpr float kBearsBesideBig = 2.0f;

/// Along a pull in any direction lies a link whose cosine with it is at least 0.85 (worst between an axis, a face's and a cell's diagonal):
/// it is strained by more than this share of what the material is.
inline constexpr float kCandidateFraction = 0.6f;
/// Axes along which a cell's neighbours spread less than this share of the widest are left out of its deformation.
inline constexpr double kFlatNeighbourhood = 1e-3;
/// Two stretches that differ by less than this share of what the third differs are alike: their directions are any.
inline constexpr double kAlikeStretches = 1e-6;
/// A cell's own links at this many times what it bears begin a crack, whatever its neighbours' are at: a neck, which they are not part of.
inline constexpr float kNeck = 2.0f;
/// A crack goes on in its plane where the pull is within 40 degrees of its normal, ...
inline constexpr double kSameCrackCosine = 0.77;
/// ... the cell this near to the plane and this near to what has broken, cells; ...
inline constexpr double kCrackThickness = 1.0, kCrackReach = 2.0;
/// ... and nothing begins beside it within this many cells and half its own size.
inline constexpr double kCrackShield = 3.0;
/// Cracks run no faster than this share of the speed of waves in a rod, sqrt( E / rho ) (in brittle materials branching holds them to about
/// half).
inline constexpr float kCrackSpeed = 0.5f;
/// A crack that has not grown for this long is forgotten, s.
inline constexpr float kCrackRest = 0.25f;

} // namespace pliant
