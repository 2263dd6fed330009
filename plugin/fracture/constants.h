#pragma once

// Limits of the fracture settings and tuning constants of the fracture rules.

#include <cstdint>

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

inline constexpr float kLargestShard = 1e6f;        // m
inline constexpr float kLargestToughness = 1e12f;   // J/m^2
inline constexpr float kLongestGrain = 100.0f;      // length of a shard over its width
inline constexpr int kMostShardCentres = 100000;    // given by a game
inline constexpr float kFarthestCentre = 1e6f;      // m, of a shard, from the mesh's origin
inline constexpr int kMostDebrisPieces = 1000000;   // of a world's budget
inline constexpr int kMostDebrisNodes = 1000000000; // the same
inline constexpr int kMostPiecesPerStep = 100000;   // the same
/// Smallest shard in cells: below it the lattice's steps would be larger than the shard's faces.
inline constexpr double kLeastShardCells = 2.0;
/// Size of crumbs over that of shards.
inline constexpr double kCrumbSize = 1.0 / 3.0;
/// Mean distance of centres from random sequential adsorption over the least one allowed: between 1.2 in a plane (0.55 of it covered by
/// discs) and 1.1 in space (0.38 filled by balls).
inline constexpr double kShardSpacing = 1.15;
/// Parts of shards with less than this fraction of the mean shard's mass join the neighbour with the widest border: slivers.
inline constexpr double kShardSliver = 0.15;
/// Borders of shards are bent by this amplitude over the shard's size, with this wavelength over it: visibly curved, nowhere folded
/// (2 pi amplitude / wavelength is below a half).
inline constexpr double kShardBend = 0.09, kShardWave = 1.7;
/// Bins along an axis of the grid in which the nearest centre is sought.
inline constexpr int kMostShardBins = 64;
/// Steps of the search for a border on a link: to a fiftieth of its length where the border is bent, exact where it is flat.
inline constexpr int kBorderSteps = 6;
/// Rings about an impact: sectors of the first ring, growth of a ring's width over its inner radius, largest number, and random shift of
/// centres over the ring's width and the sector's angle.
inline constexpr int kFirstSectors = 7;
inline constexpr double kRingGrowth = 0.35, kSpokeJitter = 0.18;
/// A border is a spoke where its normal is at more than 45 degrees to the direction of the impact.
inline constexpr double kSpokeCosine = 0.7;
inline constexpr std::uint32_t kMostRings = 64;
/// A crack starts at no border that is nearly parallel to the pull: more than 80 degrees from the plane across it.
inline constexpr double kStartCosine = 0.17;
/// A border without area opens with the crack beside it only where that one's border has so many times its links: in blocks it has some
/// nine times as many, in a slanted thin part about as many.
inline constexpr int kCornerLinks = 3;
/// A crack stops at borders whose stretch across its plane is less than this fraction of the breaking stretch: they are not pulled apart.
inline constexpr double kOpensAt = 0.1;
/// The energy density E e^2 / 2 over the mean of E s^2 / 2, with s the strains of a cell's links: in simple tension e, and a mean over all
/// directions of cos^4.
inline constexpr double kLinkEnergyFactor = 5.0;

/// Rotations in an implicit step are left out of the shape that is tested from the stretch on that is this fraction of the breaking one.
inline constexpr double kTestedTurn = 0.02;

/// Parts of at most this many cells across are thin: at the faces of thicker ones bending strains the material by less than 0.3 more than
/// it does on the average around the outermost cells.
inline constexpr int kThinCells = 6;
/// Length of a body over the thickness of its thin parts, at least, and the least length in cells: shorter parts do not bend.
inline constexpr float kLeastSlenderness = 3.0f;
inline constexpr int kLeastThinLength = 3;
/// A cell is at a face that is within this many cells of its centre, and in the middle of a part within this many of it.
inline constexpr float kAtFace = 0.75f;
inline constexpr double kInMiddle = 0.1;
/// Cells are at the same face if the normals there are within 45 degrees of each other.
inline constexpr float kSameFaceCosine = 0.7f;
/// Links are on opposite sides of a cell where the angle between them is more than 135 degrees.
inline constexpr float kPairCosine = 0.7f;
/// Deviation of a normal's length from 1 that is rounding.
inline constexpr float kUnitNormal = 1e-3f;
/// A part lies along the lattice if the products of a cell's links over their squares are below this.
inline constexpr double kSlantedPart = 0.02;
/// Least area of a part's face over that at rest for its curvature to be measured.
inline constexpr double kLeastFaceArea = 1e-3;
/// Links say what happens across a part where their extent across it is this fraction of that along it, both squared.
inline constexpr double kLeastAcross = 0.15;
/// What is added to the squares of the fit of a curvature, in squares of cells: for the stretch across a part, the turn of its normal, and
/// the curvature. A cell with links to all sides has sums of 9, 12 and 3.
inline constexpr double kAcrossPrior = 0.5, kTurnPrior = 1e-6, kCurvaturePrior = 0.01;
/// The strain that bending adds to that around a cell at the face in front of it is at most this multiple of the estimate from opposite
/// links, which may lie at 22 degrees to the largest curvature: the middle of a cell's links is half a cell below it, but not in the middle
/// of a part.
inline constexpr double kRoughBending = 2.5, kRoughInMiddle = 1.25;
/// Less of it than this fraction of the breaking strain is not looked at: links find what is stretched.
inline constexpr double kBendingCandidate = 0.4;
/// A part is not bent where the estimate is below this fraction of the breaking strain.
inline constexpr double kLeastBending = 0.05;

/// Shards are tested again once sound has crossed this fraction of one: the load on a shard does not change sooner.
inline constexpr float kTestDistance = 0.5f;
/// Where the material is overloaded but no crack has the energy to run it is tested again after this fraction of Fracture::coolDown.
inline constexpr float kRetryFraction = 0.25f;
/// Area of the lattice's steps over that of a surface of any direction: the mean of | n_x | + | n_y | + | n_z |.
inline constexpr double kStairs = 1.5;

/// Rounding error of an excess, a float, as a fraction.
inline constexpr double kExcessRounding = 1e-6;
/// Margin of the test whether a stretch is below a limit, as a fraction: rounding in double precision.
inline constexpr double kStretchRounding = 1e-9;

} // namespace pliant
