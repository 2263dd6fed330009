#pragma once

// Numbers of the preprocessing, each with its reason.

#include <cstddef>

namespace pliant {

/// Cells around a cell: 3^3 - 1.
inline constexpr unsigned kNeighbours = 26;

/// Lattice positions along an axis: coordinates are 16-bit.
inline constexpr int kMaxExtent = 32767;

/// What float rounding of positions may amount to, as a share of the lattice's size: 8 units in the last place.
inline constexpr double kRoundingFraction = 1e-6;

/// Diagonals of a mesh, m, for which products such as mass x length^2 stay inside float's range with room to spare.
inline constexpr double kSmallestDiagonal = 1e-7;
inline constexpr double kLargestDiagonal = 1e7;

/// A mesh may stick out of a whole number of cells by this share of a cell before another layer is added: it is rounding, not shape.
inline constexpr double kOverhang = 1e-3;

/// Coordinates are snapped to integers below 2^29, so that products of differences are exact in 64 bits.
inline constexpr int kCoordinateBits = 29;

/// Welding: buckets are this many tolerances wide, so that few vertices stand near a border; and at most 2^20 of them along an axis.
inline constexpr double kTolerancesPerBucket = 4.0;
inline constexpr double kMostBuckets = 1048576.0;

/// A bucket with more different points than this is welded whole: only a mesh that is dust at this scale has one.
inline constexpr std::size_t kCrowdedBucket = 1024;

/// |sum of area vectors| / area: 0 for a closed shell, 1/2 for a hemisphere. Below this a shell has an inside of its own.
inline constexpr double kNearlyClosed = 0.1;

/// How many of the largest shells are asked whether they hold a smaller one, and at how many of its triangles.
inline constexpr std::size_t kMostContainers = 32;
inline constexpr std::size_t kContainmentProbes = 9;

/// Above this share of unpaired edges to triangles the surface is a soup: closing its rims would cost more than it saves.
inline constexpr double kMostRimFraction = 0.2;

/// A cluster of triangles is one dipole from this many of its radii on (Barill et al. 2018). Measured error of W below 0.05, far from 1/2.
inline constexpr double kFarField = 2.6;
inline constexpr int kTrianglesPerLeaf = 8;

/// |W| above this is inside: half way between 0 and 1, and the same for a mesh turned inside out.
inline constexpr double kInsideWinding = 0.5;

/// Row crossings are kept in memory, 16 bytes each; above this many for a cell that is asked for the surface is folded beyond use.
inline constexpr double kMostCrossingsPerCell = 48.0;
inline constexpr double kMostCrossingsAtLeast = 1.0e6;

/// Lattice positions searched for a cell that is allowed, where the mesh is not closed and each has to be asked.
inline constexpr double kMostPositionsPerCell = 16.0;

/// Cells cut by a surface of area A: 1.5 A / d^2 on average, half of each filled, a tenth below the least fill. So this many more than
/// V / d^3: 1.5 * 0.9 - 0.75.
inline constexpr double kCellsPerArea = 0.6;

/// Area over the square of the diagonal. A ball has 0.8, a tree with all its leaves some tens.
inline constexpr double kMostFolds = 2000.0;

/// An open surface is asked for its winding number sample by sample. Triangles and clusters looked at for a cell that is asked for; more
/// would take seconds.
inline constexpr double kMostWorkPerCell = 25000.0;

/// Points per axis at which an open surface is asked what an answer costs, and for its volume; beyond so much work it is not asked.
inline constexpr int kWorkProbes = 2;
inline constexpr int kVolumeProbes = 12;
inline constexpr double kMostSurveyWork = 5e6;

/// Rows across the longest side of the mesh when its volume is estimated, and when a sliver is looked for.
inline constexpr int kEstimateRows = 64;
inline constexpr int kSliverRows[] = { 64, 256, 1024 };

/// targetCells is met when the count is off by no more than this share; so many tries.
inline constexpr double kTargetSlack = 0.1;
inline constexpr int kTargetTries = 4;
inline constexpr double kTargetSlackWhenOpen = 0.3;
inline constexpr int kTargetTriesWhenOpen = 2;

/// A shell knows where in a lattice position the surface passes by this many parts along an edge: their cube is the bits of a word.
inline constexpr int kShellSamples = 4;

/// Surface further than this from every cell's ball gets cells of its own, cells; and no cell of a shell is further than this from what it
/// carries.
inline constexpr double kShellReach = 1.0;

/// The least share of a full cell that a shell's cell weighs: lighter ones would be flung about by their neighbours. As the least fill by
/// default.
inline constexpr double kLeastShellFill = 0.03;

/// Positions that a surface of area A passes through: 1.5 A / d^2 on average, 1 A / d^2 along the axes, fewer where it is folded.
inline constexpr double kShellCellsPerArea = 1.25;

/// targetCells for a shell: off by no more than this share; so many tries, each a small part of what telling inside costs.
inline constexpr double kShellTargetSlack = 0.1;
inline constexpr int kShellTries = 4;

/// Cells that carry a solid's thin parts count for targetCells where they are more than this share of all.
inline constexpr double kMostShellFraction = 0.25;

/// How the count may change with the cell size, count ~ d^-p: ribbons, sheets, crumpled sheets.
inline constexpr double kLeastShellPower = 0.8;
inline constexpr double kMostShellPower = 3.0;

/// Points at which a surface is asked where it passes: as many, and more only where its cells are more.
inline constexpr double kMostShellPoints = 1e6;
/// And points at which it is asked first, at most, for how many positions that will be; it is folded where these are less than this share
/// of them.
inline constexpr double kMostSurveyPoints = 2e5;
inline constexpr double kFoldedFraction = 0.25;
/// Positions are counted too high by less than this factor.
inline constexpr double kMostOverCounted = 4.0;

/// So many times as many points along an edge are asked as parts: the area in a position, which is summed over them, is off by some 2 %
/// then.
inline constexpr double kAreaDensity = 2.0;

/// The inside's own surface may stick out of its cells by this much, cells; what goes on further is a part that leads away from it.
inline constexpr double kShellOverhang = 0.25;

/// The corners of a triangle that is smaller than this are as good as its middle, cells.
inline constexpr double kSmallestVisited = 0.1;

/// A soup that winds both ways, this share of what it seems to hold the other way round, holds nothing: sheets above one another.
inline constexpr double kMostOpposedFraction = 0.25;

/// An open surface whose inside falls into parts of fewer cells than this holds nothing: its winding number hangs near one half.
inline constexpr int kLeastCellsPerPart = 8;

/// Patches of the drawn surface (contact_patches.h). So many points along a cell's edge are looked at, of so many triangles at most; they
/// count up to this distance from the node, cells, and where they look the way the patch does by this cosine at least.
inline constexpr double kPatchSampleDensity = 4.0;
inline constexpr std::size_t kMostPatchTriangles = 30000;
inline constexpr double kPatchFitRadius = 1.75;
inline constexpr double kLeastPatchCosine = 0.7;
/// How long the mean normal of those within this distance must be: at a right-angled edge it is 0.71, on a ball of three cells' radius
/// 0.96.
inline constexpr double kPatchNormalRadius = 1.25;
inline constexpr double kLeastPatchAgreement = 0.9;
/// Fits of a patch, each with the normal that the last one found; and what is added to the equations, so that a few points in a line still
/// have an answer.
inline constexpr int kPatchFits = 3;
inline constexpr double kPatchRegularity = 1e-6;
/// Root mean square of what the surface may be off its patch, cells.
inline constexpr double kMostPatchError = 0.08;
/// Of the surface above the node, cells: further the cell is not the first behind it.
inline constexpr double kLeastPatchHeight = 0.01;
inline constexpr double kMostPatchHeight = 0.95;
/// Of a flat or hollow patch, cells: half a cell aside it is off by a sixtieth of a cell.
inline constexpr double kMostPatchRadius = 8.0;

/// Tasks a pass is cut into at most. Fixed, so that nothing depends on the number of threads.
inline constexpr std::size_t kMostTasks = 64;

} // namespace pliant
