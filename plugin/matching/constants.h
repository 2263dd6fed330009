#pragma once

// Every number of the core that is neither an input nor a law, with its unit and its reason.

#include <cstddef>

namespace pliant {

/// Virtual lanes of a kernel. One AVX-512 register, two AVX2 or four SSE2/NEON ones: the arithmetic is the same on each.
inline constexpr int kLanes = 16;

/// Alignment of hot arrays, bytes: one cache line, one 16-lane vector.
inline constexpr std::size_t kAlignment = 64;

/// Eigenvalues of a second moment below this share of its largest are taken as zero when it is inverted (flat or thin regions).
inline constexpr float kMomentFloor = 1e-2f;

/// Horn's matrix is scaled to entries of about 1; eigenvalues nearer than this to its largest leave the rotation open.
inline constexpr double kOpenRotationGap = 1e-7;

/// Floor of a body's inertia when net turns are taken off, share of its largest moment: a rod has none about its own axis.
inline constexpr double kInertiaFloor = 1e-6;

inline constexpr double kPi = 3.14159265358979323846;

/// Alpha above this is cut: the explicit step is safe up to here (algorithm derivation in docs/design/step.md).
inline constexpr float kLargestAlpha = 1.0f;

/// alpha ( 1 + 3 kappa ) is kept below this; at 4 the answer to pressing overshoots as far as it was off.
inline constexpr double kLargestVolumeAlpha = 3.5;

inline constexpr float kLargestVolumeKeeping = 2.0f;

/// Largest share of region damping in a substep: with .87 a body of alpha .87 that strikes a floor gains fifty times its energy, with .71
/// nothing.
inline constexpr double kLargestDampingFraction = 0.5;
/// lambda ( alpha + 2 k ) stays below this, of the 4 at which the explicit step ends.
inline constexpr double kMostDampedAnswer = 3.8;

/// Rounding allowed before a modulus counts as out of reach, relative.
inline constexpr double kAlphaSlack = 1e-4;

/// Blocks of far levels are up to 2^3 cells an edge.
inline constexpr int kMostFarLevels = 3;

/// Largest share of the way to the goal on a far level. Every level is a contraction, so the worst wave is answered
/// 1 + 3 * 2 / 3 = 3 times at most, below the 4 at which the explicit step ends.
inline constexpr double kLargestFarAlpha = 2.0 / 3.0;

/// More than all far levels together give, cells^2.
inline constexpr double kMostReach = 1.0e6;

/// Shares of region damping with far levels: 3 + 2 * 0.25 + 2 * 2 * 0.1 < 4 (docs/design/step.md).
inline constexpr float kLargestFarDampingFraction = 0.25f;
inline constexpr float kLargestDampingOfFar = 0.1f;

/// The implicit step's solver stops when what is left (r . z, twice an energy) is this share of what it began with, or the body's mass
/// times the square of this speed, m/s; after so many products at the latest.
inline constexpr double kGradientFraction = 1e-8;
inline constexpr float kGradientSpeed = 1e-4f;
inline constexpr int kMostGradients = 60;

/// Bounds of Material's values; the units stand there.
inline constexpr float kLargestDensity = 1.0e6f;
inline constexpr float kLargestBeta = 0.95f;
inline constexpr float kLargestDamping = 1000.0f;
inline constexpr int kLargestHalfWidth = 4;
inline constexpr int kLargestClusterEdge = 64;

/// Substeps named to the user when a modulus is out of reach are cut here: beyond, the number means "never".
inline constexpr int kMostSubstepsNamed = 1000000;

inline constexpr float kLargestYieldStrain = 10.0f;
inline constexpr float kLargestCreep = 1.0e4f;
inline constexpr float kLargestPlasticLimit = 2.0f;

/// A rest shape changes by at most this share in a substep.
inline constexpr double kLargestFlow = 0.5;

/// Where the flow that the yield law asks for would raise the elastic energy, a safe one is tried, by this many halvings of it; then the
/// region stays as it is.
inline constexpr int kFlowHalvings = 4;
/// Second moments are inverted for it with this share of their sum added: flat regions have none across them.
inline constexpr double kFlowFloor = 1e-6;

/// Rounds in which a plastic stretch is brought back to its limit; what is left is below float's rounding.
inline constexpr int kLimitRounds = 8;

/// Bodies' origins are multiples of this length, m: a power of two, so that origins and moves are exact in binary, in float up to
/// 1000 km out, and the same on every machine.
inline constexpr double kOriginGrid = 1.0 / 16.0;

/// Speed above which a node is held back, m/s: faster is an error of the game, and 16-bit cell hashes and float contacts end here.
inline constexpr float kSpeedLimit = 1.0e5f;

/// Strains are looked at this seldom: a split a few substeps late is not seen, a look at every substep costs some per cent.
inline constexpr int kSubstepsBetweenReviews = 4;

/// After a split its parts go so many times to where all their regions have them (docs/design/levels.md).
inline constexpr int kEasingRounds = 2;

/// What a change of levels brings of energy is taken off for so long, s: longer than springs take to give it back, and not for ever.
inline constexpr float kOwedFor = 0.5f;

/// Changes of levels that arrays are reserved for, each with all the nodes it may bring. What is reserved and not used takes no memory.
inline constexpr int kScratchChanges = 10;

/// Room that a body with levels has from the start, in memory that is there, as a share of what its nodes take.
inline constexpr double kScratchFraction = 1.125;

} // namespace pliant
