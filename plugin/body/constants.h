#pragma once

// Constants of bodies and templates, each with its unit and reason.

#include <cstddef>

namespace pliant {

/// Bounds of the factor by which a template may be scaled: outside of them squares of a model's lengths leave the range of single
/// precision.
inline constexpr float kSmallestScale = 1e-6f, kLargestScale = 1e6f;

/// Squared angular velocity of a body, times its length over g: below the first it rocks at rest, as in stacks and heaps; above the second,
/// a ball of 0.4 m at 1 m/s, it rolls.
inline constexpr double kRockingTurn = 0.1, kFreeTurn = 0.5;

/// Implicit bodies that turn by this much in a step, rad, go on along arcs: a smaller turn stretches by 1e-5 along tangents.
inline constexpr double kLeastArc = 0.005;
/// And those with contacts that can break, by this much: tangents would stretch them by .00125. Contacts account for tangents
/// (IslandBlock::rollingLag), and bodies that roll slower stay on them.
inline constexpr double kLeastTouchedArc = 0.05;
/// And that sound crosses so many times in it, in the root of the mean square radius.
inline constexpr double kArcTravel = 3.0;
/// Pins whose mean square distance from the axis is a smaller fraction of a region's second moment lie on it; others have to turn with
/// their part, up to this fraction of its turn.
inline constexpr double kLeastPinnedMoment = 0.01, kTurnsWithPins = 0.05;
/// Free rotation is divided into parts of this turn about a principal axis, rad, at most so many: the energy then stays within a per cent.
inline constexpr double kFreeTurnPart = 0.5;
inline constexpr int kMostTurnParts = 32;
/// The least fraction of a body's energy about its mass centre that is the energy of its rotation: the parts of what bends in flight rotate
/// by themselves.
inline constexpr double kRotatesAsRigid = 0.98;

/// Nodes of bodies of fewer cells do not merge: they would be one block or a few, with no rotation of their own.
inline constexpr std::size_t kLeastMergedCells = 27;

/// Nodes on opposite sides of one, between which a thin part bends: their mean differs from it by less than this fraction of their
/// distance, the direction has less than this cosine with the part's normals, and directions are 30 degrees apart.
inline constexpr float kPairAsymmetry = 0.1f, kPairAcross = 0.5f, kPairsApart = 0.87f;

// --- Segments of large bodies (segments.h) ---

/// Bodies of fewer nodes, with a smaller G, or that are divided into fewer segments, as compact ones are, need few products without.
inline constexpr int kLeastDividedNodes = 400, kLeastSegments = 32;
inline constexpr float kLeastDividedStiffness = 300.0f;
/// Edges of the cubes, cells, and the number of coupled pairs of segments from which on they are larger: the factor of the coarse system
/// must not take longer than the products that it saves.
inline constexpr int kLeastSegmentEdge = 3, kLargestSegmentEdge = 64, kMostSegmentPairs = 400;
/// Resistance of a link between two segments to their relative velocity, in the resistances of its two cells: of a full lattice with n = 3
/// ( n^2 - 1 ) / ( 8 n ) = 1 / 3 of G m, and a cell's own is some .9.
inline constexpr double kLinkResistance = 0.19;
/// The same to a relative rotation, in those units times d^2: a row of single cells has no other. And the least moment of inertia, m d^2: a
/// segment of one cell is a point.
inline constexpr double kSegmentTwist = 1.0 / 6.0, kLeastSegmentMoment = 1.0 / 6.0;

// --- Inertia and pieces ---

/// Minimum inertia of a body, relative to that of its regions as full ones about their own centres: all nodes in one point have none.
inline constexpr double kLeastBodyInertia = 1e-12;
/// The same for a body of one node, m^2 per mass: it has no inertia, and nothing that could rotate.
inline constexpr double kLeastPointInertia = 1e-12;

} // namespace pliant
