#pragma once

// The constants of the core, each with its unit and its reason.

#include <cstddef>

namespace pliant {

/// Virtual lanes of a kernel: one AVX-512 register, two AVX2 or four SSE2/NEON ones. The arithmetic is the same on each.
inline constexpr int kLanes = 16;

/// Alignment of hot arrays, bytes: one cache line, one 16-lane vector.
inline constexpr std::size_t kAlignment = 64;

/// Eigenvalues of a second moment below this fraction of the largest count as zero when it is inverted (flat or thin regions).
inline constexpr float kMomentFloor = 1e-2f;

/// Horn's matrix is scaled to entries of about 1; eigenvalues closer than this to the largest leave the rotation undetermined.
inline constexpr double kOpenRotationGap = 1e-7;

/// Floor of a body's inertia where net angular velocity is removed, as a fraction of its largest moment: a rod has none about its own axis.
inline constexpr double kInertiaFloor = 1e-6;
/// Moment of inertia of a cell's sphere about its own centre, over its mass and the square of the cell size: ( 2 / 5 ) ( 1 / 2 )^2.
inline constexpr double kCellInertia = 0.1;
/// Least inertia of a body whose angular velocity is reported, over its mass and the square of the cell size: that of nodes a tenth of a
/// cell from the axis.
inline constexpr double kLeastTurningInertia = 0.01;
/// A body that breaks is rigid up to this fraction of the strain at which its weakest link breaks.
inline constexpr double kRigidBreakFraction = 0.8;
/// Pinned nodes hold a body against rotation if they are spread by this many cells, root mean square, in two directions.
inline constexpr double kFirmSpread = 0.25;
/// A body that a load strains visibly somewhere is calm, and may be rigid, if it vibrates by less than this fraction of the visible limit.
inline constexpr double kCalmFraction = 0.2;
/// A free body that breaks at less than the first, and is calm, is folded if a link of it is longer than at rest by the first or shorter by
/// the second fraction: five times what rigidStrain may call invisible, and cells that have passed through one another.
inline constexpr double kFoldedStretch = 0.5, kFoldedSquash = 0.9;
/// Largest Material::rigidStrain: more could be seen.
inline constexpr float kLargestRigidStrain = 0.1f;

inline constexpr double kPi = 3.14159265358979323846;

/// Young's modulus of a body whose material sets none, as a multiple of rho g L: less sags visibly under ten times the body's own mass.
inline constexpr double kDefaultStiffness = 100.0;
/// Standard gravity, m/s^2.
inline constexpr double kStandardGravity = 9.80665;

/// Larger alphas are clamped to this: the explicit step is stable up to here (derivation in docs/design/step.md).
inline constexpr float kLargestAlpha = 1.0f;

/// Response of a mode to its displacement from which on an explicit step is unstable: it overshoots by the full initial error.
inline constexpr double kUnstableResponse = 4.0;

/// alpha ( 1 + 3 kappa ) is kept below this; at 4 the response to compression overshoots by the full initial error.
inline constexpr double kLargestVolumeAlpha = 3.5;

/// Poisson's ratio 0.49.
inline constexpr float kLargestVolumeKeeping = 24.5f;

/// Largest region damping factor of a substep: with 0.87 a body of alpha 0.87 that hits a floor gains fifty times its energy, at 0.71 none.
inline constexpr double kLargestDampingFraction = 0.5;
/// lambda ( alpha + 2 k ) stays below this; the explicit step is unstable from 4 on.
inline constexpr double kLargestDampedResponse = 3.8;
/// Response to deformation by volume conservation at rest, and of a crushed region at most, in units of kappa (volumeStrain). With damping
/// limited by that of rest alone, crushed bodies with much damping gained energy.
inline constexpr double kRestResponse = 3.0, kCrushedResponse = 9.0;

/// lambda ( alpha + 2 k ) + 2 f stays below this, f the wobble damping factor: a cube with alpha ( 1 + 3 kappa ) = 1.9 and f = 0.96 gained
/// a thousand times the energy of its fall.
inline constexpr double kLargestWobbleResponse = 3.95;

/// Relative rounding tolerance before a modulus counts as out of reach.
inline constexpr double kAlphaSlack = 1e-4;

/// Blocks of far levels have up to 2^3 cells along an edge.
inline constexpr int kMostFarLevels = 3;

/// Largest alpha of a far level. Every level is a contraction, so any wave has a response of at most 1 + 3 * 2 / 3 = 3 < 4, the stability
/// limit.
inline constexpr double kLargestFarAlpha = 2.0 / 3.0;

/// More than the moment of all far levels together, cells^2.
inline constexpr double kMostReach = 1.0e6;

/// Region damping factors with far levels: 3 + 2 * 0.25 + 2 * 2 * 0.1 < 4 (docs/design/step.md).
inline constexpr float kLargestFarDampingFraction = 0.25f;
inline constexpr float kLargestDampingOfFar = 0.1f;

/// The implicit solver stops when the residual norm (r . z, twice an energy) falls to this fraction of its initial value, or below the
/// body's mass times the square of this speed, m/s; at the latest after this number of iterations.
inline constexpr double kGradientFraction = 1e-8;
inline constexpr float kGradientSpeed = 1e-4f;
inline constexpr int kMostGradients = 60;

/// A region is taut where its second moment has grown by this over the root of G, the implicit step's stiffness: tension then swings modes
/// that the body's bending hardly resists faster than a step can resolve.
inline constexpr float kTautStretch = 1.5f;

/// From this G on the inertias of regions come from the rest shape and the displacements (kernel_inertia.h). Those from the positions alone
/// have errors of 4e-5 in a body of twenty cells: A would err by .4 of the masses.
inline constexpr float kLeastFramedStiffness = 1e4f;

/// Bounds of Material's values, in the units documented there.
inline constexpr float kLargestDensity = 1.0e6f;
inline constexpr float kLargestBeta = 0.95f;
inline constexpr float kLargestDamping = 1000.0f;
inline constexpr int kLargestHalfWidth = 4;
inline constexpr int kLargestClusterEdge = 64;

/// The suggested number of substeps for a modulus that is out of reach is limited to this, which means "never".
inline constexpr int kMostSubstepsNamed = 1000000;

inline constexpr float kLargestYieldStrain = 10.0f;
inline constexpr float kLargestCreep = 1.0e4f;
inline constexpr float kLargestPlasticLimit = 2.0f;

/// Largest relative change of a rest shape in a substep.
inline constexpr double kLargestFlow = 0.5;

/// Where the flow of the yield law would raise the elastic energy, a safe flow is tried and halved up to this often; after that the region
/// does not flow in this substep.
inline constexpr int kFlowHalvings = 4;
/// Relative regularisation of second moments inverted for that: flat regions have none along their normal.
inline constexpr double kFlowFloor = 1e-6;

/// Iterations that bring a plastic stretch back to its limit; the remaining error is below float rounding.
inline constexpr int kLimitRounds = 8;

/// Bodies' origins are multiples of this length, m: a power of two, so that origins and shifts are exact in binary, in float up to 1000 km
/// from the world's origin, and the same on every machine.
inline constexpr double kOriginGrid = 1.0 / 16.0;

/// Nodes are clamped to this velocity, m/s: higher ones are errors of the game, and 16-bit cell hashes and float contacts fail beyond it.
inline constexpr float kSpeedLimit = 1.0e5f;

/// Substeps between two reviews of the strains: a split a few substeps late is invisible, a review in every substep costs some per cent.
inline constexpr int kSubstepsBetweenReviews = 4;

/// Times that the new nodes of a split are moved to the mean position their regions predict (docs/design/levels.md).
inline constexpr int kEasingRounds = 2;

/// Time over which energy added by a change of levels is removed, s: longer than springs take to return it, and finite.
inline constexpr float kEnergyRemovalTime = 0.5f;

/// Level changes that arrays are reserved for, each with the largest number of new nodes. Reserved but untouched memory is not committed.
inline constexpr int kScratchChanges = 10;

/// Memory of a body with levels that is allocated from the start, relative to what its nodes need.
inline constexpr double kScratchFraction = 1.125;

/// Nodes of a snapshot farther out than this, m, or faster than this, m/s, are refused: squares of such numbers are still finite. A body is
/// never placed farther out, nor given a tenth of the velocity.
inline constexpr float kFarthestStored = 1.0e9f, kFastestStored = 1.0e6f;

// --- Tasks ---

/// Nodes per task. Sums are folded task by task, which affects rounding, so it must not depend on the number of threads.
inline constexpr int kNodesPerTask = 1024;
/// The same for nodes or members of clusters, ...
inline constexpr int kMembersPerTask = 1024;
/// ... and for the blocks of far levels: fewer, since a body has an eighth as many of them as nodes, or less.
inline constexpr int kBlocksPerTask = 256;
/// Rows of the tables of levels that one task measures: a multiple of the floats in a cache line, so that no two tasks write to the same
/// line.
inline constexpr int kRowsPerTask = 64;

// --- Regions ---

/// Limit of the sweeps of Jacobi's method, which converges quadratically once rotations are small: ten are more than enough for 9 x 9.
inline constexpr int kJacobiSweeps = 32;

/// A connected part whose inertia per mass is less than this, m^2, is a point: a nanometre squared, far above rounding in double and far
/// below the distance that floats resolve between two positions.
inline constexpr double kPointExtent = 1e-18;

/// Added to a region's inertia, relative to its mean moment: a collinear region has none about its line. Its nodes lie on the line, so the
/// value has no effect there.
inline constexpr double kLineInertia = 1e-4;

/// Box sums touch every position of the grid, the table only the nodes: largest number of positions per node at which the grid is faster,
/// by half-width (measured, docs/benchmarks.md).
inline constexpr float kLargestGridRatio[kLargestHalfWidth + 1] = { 0.0f, 1.6f, 4.0f, 8.0f, 16.0f };

/// The linear mode of clusters scales its fit to the rest volume by this factor at most: a flat cluster would otherwise grow without bound.
/// (Müller's own program limits the factor to 2 as well.)
inline constexpr double kLargestVolumeScale = 2.0;

/// Minimum number of blocks along a body's longest side for a far level to be used: with fewer, most regions contain the whole body.
inline constexpr int kLeastBlocks = 4;
/// Second moment of one solid cell, cells^2: that of a plate of one cell across its thickness.
inline constexpr double kSolidCellMoment = 1.0 / 12.0;
/// Squared deviation of x^2 / 2 from its best linear fit over a length L, relative to the second moment squared: L^4 / 720 of
/// ( L^2 / 12 )^2.
inline constexpr double kCurveFraction = 0.2;

} // namespace pliant
