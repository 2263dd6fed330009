#pragma once

// Constants of the drawn surface, its skin and its cracks, each with its unit and reason.

#include <cstddef>

namespace pliant {

// --- Tasks ---

/// Vertices or nodes per task.
inline constexpr int kVerticesPerTask = 2048;
/// Groups of four vertices per task, where the skin is turned as a whole: they cost less than skinning.
inline constexpr int kSkinGroupsPerTask = 2048;
/// Points of cracks per task.
inline constexpr std::size_t kCrackPointsPerTask = 1024;
/// Blocks of a stream that are compared as a whole, entries: the ranges that have changed consist of them.
inline constexpr std::size_t kStreamBlock = 16;

// --- Skin ---

/// Most cells that carry a vertex or a point of a crack: the bits of the word that represents those of a side.
inline constexpr std::size_t kMostCarriers = 64;
/// Radius of a cell's influence on vertices, cells. With 1.4 every point has at least two cells of full material in reach, no cell beyond
/// the 27 around it has influence, and linear fields are exact at the centres, faces and corners of cells.
inline constexpr double kSkinSupport = 1.4;
/// Tolerance for material behind the surface, cells: on a concave or bumpy surface the centre of a cell's material may lie slightly in
/// front of the tangent plane.
inline constexpr double kFrontSlack = 0.1;
/// Points further out than this, cells, are clamped: they have no cell around them in any case.
inline constexpr double kFarOut = 4.0;
/// Sum of ( s - 1 )^2 over a gradient's singular values up to which the skin follows it; above four times that it is ignored.
inline constexpr float kSoundStrain = 0.5f;

/// Tolerance of nodes as a fraction of that of vertices, in a body that moves as a rigid one (rigid_skin.h says why).
inline constexpr double kRigidSkinNodeFraction = 1.0 / 3.0;
/// Nodes are collinear where their squared extent across the line is below this fraction of that along it.
inline constexpr double kLineExtent = 1e-4;

/// Largest displacement of a vertex by a fade in one frame, as a fraction of the surface's diagonal: half of the limit for a change of
/// levels.
inline constexpr double kFadeStep = 5e-4;
/// Frames of the shortest fade: a tenth of a second.
inline constexpr int kFewestFadeFrames = 6;
/// Frames of the longest fade: half a second. In crushed or torn bodies a change may move the surface by a third of the body; at kFadeStep
/// per frame the surface would stay away from its nodes, and be skinned in full, for up to 13 s.
inline constexpr int kMostFadeFrames = 30;
/// Frames over which the children of a split node separate: a quarter of a second.
inline constexpr int kEaseFrames = 15;
/// Fraction of the diagonal below which an offset is dropped, and smallest difference of gradients: a fiftieth of a step, and above
/// rounding.
inline constexpr float kFadeFloor = 1e-5f;

// --- Shapes of cracks ---

/// Bounds of CrackSettings' values, in the units documented there.
inline constexpr float kLongestWave = 100.0f;
inline constexpr int kMostSubdivision = 8;
inline constexpr float kMostBendTolerance = 0.5f;

/// The noise is zero at its own lattice points. This shift, in wavelengths, keeps them away from the cells' corners.
inline constexpr double kNoiseShift[3] = { 0.3819, 0.6180, 0.2361 };
/// The fixed-point iteration that inverts the noise usually gains a digit in two rounds, at worst in ten; it ends when the change of a
/// position, cells, is below kNoiseStill.
inline constexpr int kNoiseRounds = 200;
inline constexpr double kNoiseStill = 1e-13;

/// Points of faces nearer to one another than this, cells, are merged. The surface moves by no more than this; smaller features would only
/// produce slivers.
inline constexpr double kCrackMergeDistance = 1e-4;
/// Smallest distance of a refining point from the ends of its line, as a fraction of the spacing.
inline constexpr double kRefineSpacing = 0.3;
/// Upper limits of an edge's length, as a multiple of the segments of the faces' edges and as a fraction of the noise's wavelength: cuts
/// along it and its two neighbours then bend a border about four times in a cell. Half as long, borders would have twice as many points as
/// the faces within them need.
inline constexpr double kPiecesOfEdge = 2.0, kWaveOfEdge = 0.625;
/// Bisections of a side in search of the surface: to 1/256 of a cell.
inline constexpr int kBisections = 8;
/// A part of the material with less volume than this, cells^3, is rounding: its centre is that of its corners.
inline constexpr double kSolidBlob = 1e-6;

/// Added to the quality of a corner that is no ear: such corners are cut only when balance is no ear.
inline constexpr double kNoEar = -2.0;
/// Factor for an ear that leaves an unwanted edge: it comes after all others.
inline constexpr double kUnwantedEar = 1e-6;

/// Largest distance of a point from the grid of its face, as a fraction of the grid's spacing: rounding.
inline constexpr double kOffGrid = 1e-6;
/// Longest edge of a panel, cells: longer triangles keep following the cells that cut them.
inline constexpr float kLongestPanel = 1.5f;

// --- Traces of blades ---

/// Traces whose normals differ by less than the angle of this cosine belong to one surface.
inline constexpr float kSameSurface = 0.7f;
/// Distance below which traces have about equal weight, cells.
inline constexpr float kNearTrace = 0.25f;
/// Resistance of a point of the outer surface to leaving it, over that to moving along it.
inline constexpr float kSlide = 100.0f;
/// The same for the square of the fraction of the surface there that faces a direction. Points on flat surface hardly leave it (where
/// borders have few points each represents a large area); slightly bent surface holds a point no more than kSlide alone.
inline constexpr float kSlideFlat = 1000.0f;
/// Largest displacement of a point, cells: half a cell's diagonal and the noise.
inline constexpr float kFarthestMove = 1.25f;

// --- State of cracks ---

/// A list is sparse where it has fewer than one in this many of all items: it is then faster to visit it than all of them.
inline constexpr std::size_t kSparseFraction = 32;
/// Vertices of a patch from which on its table of vertices is made small again: clearing a table costs as much as its largest content.
inline constexpr std::size_t kLargePatch = 1024;
/// Smaller shifts of a unit normal are rounding errors and are ignored.
inline constexpr float kSeenShift = 1e-6f;

} // namespace pliant
