#pragma once

// Constants of the preprocessing, each with its reason.

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace pliant {

/// Neighbours of a cell: 3^3 - 1.
inline constexpr unsigned kNeighbours = 26;

/// Lattice positions along an axis: coordinates are 16-bit.
inline constexpr int kMaxExtent = 32767;

/// Bound on the float rounding error of positions, as a fraction of the lattice's size: 8 units in the last place.
inline constexpr double kRoundingFraction = 1e-6;

/// Mesh diagonals, m, for which products such as mass x length^2 stay well inside float's range.
inline constexpr double kSmallestDiagonal = 1e-7;
inline constexpr double kLargestDiagonal = 1e7;

/// A mesh may exceed a whole number of cells by this fraction of a cell before a layer is added: smaller excesses are rounding errors.
inline constexpr double kOverhang = 1e-3;

/// Coordinates are snapped to integers below 2^29, so that products of differences are exact in 64 bits.
inline constexpr int kCoordinateBits = 29;

/// Welding: width of a bucket in tolerances, large enough that few vertices lie near a border, and the limit of 2^20 buckets along an axis.
inline constexpr double kTolerancesPerBucket = 4.0;
inline constexpr double kMaxBuckets = 1048576.0;

/// A bucket with more distinct points than this is welded whole: only meshes with clusters far below the tolerance have one.
inline constexpr std::size_t kCrowdedBucket = 1024;

/// |sum of area vectors| / area: 0 for a closed shell, 1/2 for a hemisphere. Below this a shell is treated as closed.
inline constexpr double kNearlyClosed = 0.1;

/// Number of largest shells tested for containing a smaller one, and number of the smaller shell's triangles that are tested.
inline constexpr std::size_t kMaxContainers = 32;
inline constexpr std::size_t kContainmentProbes = 9;

/// Above this ratio of unpaired edges to triangles the surface is a triangle soup: closing its rims would cost more than it saves.
inline constexpr double kMaxRimFraction = 0.2;

/// A cluster of triangles counts as one dipole from this many radii on (Barill et al. 2018). Measured error of W below 0.05, far from 1/2.
inline constexpr double kFarField = 2.6;
inline constexpr int kTrianglesPerLeaf = 8;

/// A point with |W| above this is inside: midway between 0 and 1, and independent of the mesh's orientation.
inline constexpr double kInsideWinding = 0.5;

/// Limit of row crossings, 16 bytes each, per requested cell; above it the surface is too folded to be resolved.
inline constexpr double kMaxCrossingsPerCell = 48.0;
inline constexpr double kBaseCrossings = 1.0e6;

/// Limit of lattice positions per allowed cell, for meshes that are not closed, where each position needs a winding number.
inline constexpr double kMaxPositionsPerCell = 16.0;

/// Cells in excess of V / d^3 for a surface of area A: it cuts 1.5 A / d^2 cells on average, half of each is filled, and a tenth are below
/// the minimum fill: 1.5 * 0.9 - 0.75.
inline constexpr double kCellsPerArea = 0.6;

/// Limit of the area over the square of the diagonal. A ball has 0.8, a tree with all its leaves some tens.
inline constexpr double kMaxFolds = 2000.0;

/// An open surface needs a winding number per sample. Limit of triangles and clusters visited per requested cell: more takes seconds.
inline constexpr double kMaxWorkPerCell = 25000.0;

/// Points per axis for estimating an open surface's query cost and volume; work limit of the volume estimate.
inline constexpr int kWorkProbes = 2;
inline constexpr int kVolumeProbes = 12;
inline constexpr double kMaxSurveyWork = 5e6;

/// Rows across the longest side of the mesh for the volume estimate and for the search for slivers.
inline constexpr int kEstimateRows = 64;
inline constexpr int kSliverRows[] = { 64, 256, 1024 };

/// targetCells is met when the relative deviation of the count is at most this; and the number of attempts.
inline constexpr double kTargetSlack = 0.1;
inline constexpr int kTargetTries = 4;
inline constexpr double kTargetSlackWhenOpen = 0.3;
inline constexpr int kTargetTriesWhenOpen = 2;

/// A mesh is a box along the axes if its area, and its volume, differ from its bounding box's by less than this fraction. Cell edges that
/// divide its edges are sought within a fifth of the one for targetCells; the count may deviate by `kBoxTargetSlack`, and ten per cent of
/// it weigh as one per cent of an edge that is left over.
inline constexpr double kBoxFill = 0.01;
inline constexpr int kBoxSearch = 5;
inline constexpr double kBoxTargetSlack = 0.26, kBoxCountWeight = 0.1;

/// Subdivision of a position's edge at which a shell records the surface's path; its cube is the number of bits of a word.
inline constexpr int kShellSamples = 4;

/// Surface farther than this from every cell's ball receives cells of its own, in cells; no cell of a shell is farther than this from its
/// surface.
inline constexpr double kShellReach = 1.0;

/// Minimum mass of a shell's cell as a fraction of a full cell: lighter cells would be accelerated too strongly by their neighbours. Equals
/// the default minimum fill.
inline constexpr double kMinShellFill = 0.03;

/// Lattice positions that a surface of area A passes through: 1.5 A / d^2 on average, 1 A / d^2 along the axes, fewer where it is folded.
inline constexpr double kShellCellsPerArea = 1.25;

/// targetCells for a shell: maximum relative deviation and number of attempts, each of which costs far less than an inside test.
inline constexpr double kShellTargetSlack = 0.1;
inline constexpr int kShellTries = 4;

/// Cells of a solid's thin parts count towards targetCells where they exceed this fraction of all cells.
inline constexpr double kMaxShellFraction = 0.25;

/// Bounds of the exponent p in count ~ d^-p: ribbons, sheets, crumpled sheets.
inline constexpr double kMinShellPower = 0.8;
inline constexpr double kMaxShellPower = 3.0;

/// Number of points sampled on a surface; exceeded only where the surface has more cells.
inline constexpr double kShellPoints = 1e6;
/// Maximum number of points in the first pass, which estimates the number of positions. The surface counts as folded where the positions
/// are less than this fraction of those points.
inline constexpr double kMaxSurveyPoints = 2e5;
inline constexpr double kFoldedFraction = 0.25;
/// Upper bound of the factor by which positions are overestimated.
inline constexpr double kMaxOvercount = 4.0;

/// Sampling density along an edge relative to kShellSamples: the area in a position, a sum over the samples, then has an error of about 2
/// %.
inline constexpr double kAreaDensity = 2.0;

/// The surface of an inside may exceed its cells by this much, in cells; surface beyond that belongs to a part that leads away.
inline constexpr double kShellOverhang = 0.25;

/// Triangles smaller than this, in cells, are not sampled at their corners: their centroid suffices.
inline constexpr double kSmallestVisited = 0.1;

/// A soup with this fraction of its apparent volume oppositely oriented has no inside: it consists of stacked sheets.
inline constexpr double kMaxOpposedFraction = 0.25;

/// An open surface whose inside consists of parts with fewer cells than this has no inside: its winding number is close to one half.
inline constexpr int kMinCellsPerPart = 8;

/// Patches of the drawn surface (contact_patches.h): samples along a cell's edge, maximum number of triangles, maximum distance of a sample
/// from the node in cells, minimum cosine between a sample's normal and the patch's.
inline constexpr double kPatchSampleDensity = 4.0;
inline constexpr std::size_t kMaxPatchTriangles = 30000;
inline constexpr double kPatchFitRadius = 1.75;
inline constexpr double kMinPatchCosine = 0.7;
/// Minimum length of the mean normal of the samples within this distance, in cells: 0.71 at a right-angled edge, 0.96 on a ball of three
/// cells' radius.
inline constexpr double kPatchNormalRadius = 1.25;
inline constexpr double kMinPatchAgreement = 0.9;
/// Number of fits of a patch, each with the normal of the previous one, and the regularisation of the equations, which keeps collinear
/// points solvable.
inline constexpr int kPatchFits = 3;
inline constexpr double kPatchRegularity = 1e-6;
/// Maximum root mean square distance of the surface from its patch, in cells.
inline constexpr double kMaxPatchError = 0.08;
/// Height of the surface above the node, in cells: at a greater height the cell is not the first one behind the surface.
inline constexpr double kMinPatchHeight = 0.01;
inline constexpr double kMaxPatchHeight = 0.95;
/// Maximum number of faces at an edge; each has at least this fraction of the weight of the largest.
inline constexpr std::size_t kMaxEdgeFaces = 4;
inline constexpr double kLeastFaceWeight = 0.1;
/// Radius of a flat or hollow patch, in cells: half a cell to the side the error is a five-hundredth of a cell, and half a degree.
inline constexpr double kMaxPatchRadius = 64.0;

/// Maximum number of tasks per pass. Fixed, so that results do not depend on the number of threads.
inline constexpr std::size_t kMaxTasks = 64;

/// Cells per task of the search for regions: enough to justify its scratch.
inline constexpr int kCellsPerTask = 512;
/// Cells of a region are counted over the grid where that has at most this many positions per cell and kSmallGrid more: of a longer, thin
/// body most positions are empty, while a small grid costs nothing.
inline constexpr std::size_t kMaxGridPerCell = 64, kSmallGrid = 4096;

/// Positions of a grid that has a table by position; it costs 16 MB at most.
inline constexpr std::uint64_t kMaxTableEntries = std::uint64_t( 1 ) << 22;

/// Keys of a shell are sorted, and duplicates removed, whenever their number has doubled, but not before there are this many: fewer take
/// too little memory to be worth the time.
inline constexpr std::size_t kLeastSortedKeys = 65536;

/// Entries of a stack for the tree of winding numbers: median splits keep the depth below log2 of the number of triangles that 32 bits can
/// count.
inline constexpr int kMaxWindingDepth = 64;
/// Solid angle of all directions, sr, which is a winding number of 1.
inline constexpr double kWholeSphere = 4.0 * std::numbers::pi;

/// Volume of cavities below which there are none, as a fraction of the material: rounding.
inline constexpr double kCavityFraction = 1e-9;

/// Bounds of LatticeSettings' values, in the units documented there.
inline constexpr int kMaxCellsLimit = 10000000;
inline constexpr int kMaxTrianglesLimit = 100000000;
inline constexpr int kMaxSamplesPerEdge = 8;
inline constexpr float kMaxWeldTolerance = 0.01f;
inline constexpr float kMaxMinimumFill = 0.5f;
inline constexpr float kMaxShellThickness = 1.0e7f;

} // namespace pliant
