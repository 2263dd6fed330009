#pragma once

// Limits of the fracture settings and tuning constants of the fracture rules.

namespace pliant {

inline constexpr float kLargestBreakStrain = 10.0f;
inline constexpr float kLargestStrength = 1e12f;   // Pa
inline constexpr float kLongestCoolDown = 10.0f;   // s
inline constexpr int kLargestSmallPiece = 1000000; // cells
inline constexpr float kLongestFade = 3600.0f;     // s
inline constexpr int kMaxPieces = 100000;

/// Bodies with levels that can break are refined at this fraction of their breaking stretch, so that only finest cells break.
inline constexpr float kRefineBeforeBreak = 0.5f;

/// Neighbours of a split node are split too if strained by this fraction of the threshold: one border between sizes results instead of
/// successive ones, each of which would excite vibrations.
inline constexpr float kRefineTogether = 0.6f;

/// Where coarse nodes meet fine ones, strains have errors of up to a half: a fine node linked to a coarse one breaks at this multiple of
/// the break strain. Forbidding fractures within some links of a coarse node is no alternative: impacts are over before all of these are
/// split, and only a half to a thirtieth of what breaks on the uniform lattice would break.
inline constexpr float kStrainFactorNextToCoarse = 2.0f;

/// For a pull in any direction some link has a cosine with it of at least 0.85 (worst between an axis, a face's and a cell's diagonal): its
/// strain exceeds this fraction of the material's.
inline constexpr float kCandidateFraction = 0.6f;
/// Axes along which a cell's neighbours spread less than this fraction of the widest are excluded from its deformation.
inline constexpr double kFlatNeighbourhood = 1e-3;
/// Two stretches whose difference is below this fraction of that to the third are equal: their directions are arbitrary.
inline constexpr double kEqualStretches = 1e-6;
/// A cell whose own links reach this multiple of the break strain starts a crack whatever its neighbours' strain: a neck.
inline constexpr float kNeckFactor = 2.0f;
/// A crack grows in its plane where the pull is within 40 degrees of its normal, ...
inline constexpr double kSameCrackCosine = 0.77;
/// ... the cell is this close to the plane and this close to the broken cells, in cells; ...
inline constexpr double kCrackThickness = 1.0, kCrackReach = 2.0;
/// ... and no other crack starts beside it within this many cells plus half its own size.
inline constexpr double kCrackShield = 3.0;
/// Maximum crack speed as a fraction of the wave speed in a rod, sqrt( E / rho ) (in brittle materials branching limits cracks to about
/// half).
inline constexpr float kCrackSpeed = 0.5f;
/// A crack that has not grown for this time is removed, s.
inline constexpr float kCrackRest = 0.25f;

} // namespace pliant
