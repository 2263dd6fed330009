#pragma once

// Constants of bodies in their rigid state (Material::rigidStrain), each with its unit and reason.

#include <LinearMath/btScalar.h>

namespace pliant {

/// A hull may have this multiple of the volume of its material; where it has more, its nodes are divided among two.
inline constexpr double kConvexVolume = 1.3;
/// A hull may lie inside of the spheres by this, in radii of the largest: half as many corners make a search for contacts twice as fast.
inline constexpr float kHullTolerance = 0.05f;
/// Nodes that are not divided further, and the largest number of hulls of a body.
inline constexpr int kLeastHullNodes = 12, kMostHulls = 32;
/// Contacts of hulls last at least until they have separated or slid by this fraction of the hulls' margin, but not beyond kLongestLasting,
/// m: a body at rest falls 2.7 mm in a step of 1/60 s before its contacts hold it.
inline constexpr btScalar kLastingContact = btScalar( 0.5 ), kLongestLasting = btScalar( 0.004 );
/// And in any case by this multiple of the fall from rest in a step, g h^2: at 1/30 s stacks of boxes fell through the floor.
inline constexpr btScalar kLastingFall = btScalar( 2 );
/// Radius of the area in which hulls touch, in radii of a body's smallest node sphere.
inline constexpr btScalar kContactArea = btScalar( 0.5 );
/// The arm of the pressure that resists rolling, in radii of that area: at most 1, and this times the square of a node's radius over the
/// body's. Crumbs are round for the solver and angular for the eye; the form of larger bodies is that of their hulls.
inline constexpr btScalar kRollingArm = btScalar( 7 );
/// A body that touches something rotates by at most this angle in a step, rad: an eighth of a turn, as for Bullet's rigid bodies.
inline constexpr btScalar kFarthestTurn = btScalar( 0.785 );
/// A body that has just become rigid is rotated to find its contacts until its farthest corner moves by this fraction of their distance.
inline constexpr btScalar kFirstContactTurn = btScalar( 0.5 );
/// Game steps: until a new body is tested for its rigid state, between two tests, and for which a body deforms at least.
inline constexpr int kRigidStart = 2, kRigidRetry = 3, kRigidPause = 6;
/// A slow body that has been rigid for fewer game steps than the first of these deforms twice as long as the time before, up to the second:
/// one that rests on another, whose hull lies higher on it than its spheres, would rise, deform and sink again and again, and never sleep.
inline constexpr int kBrieflyRigid = 60, kLongestRigidPause = 240;
/// Time for which a body has to be slow, as after a fall over its largest node at most, before it may be rigid while it is bent, s.
inline constexpr double kBentRest = 0.25;
/// Velocity at which bodies in their rigid state separate from objects that their hulls overlap, m/s, and a lower bound for the fraction of
/// a penetration that a solver corrects in a step, which is used to compute it.
inline constexpr btScalar kRigidParting = btScalar( 0.3 ), kLeastCorrection = btScalar( 1e-3 );
/// A body deforms again under more than this multiple of the load, N, that it became rigid under.
inline constexpr double kRigidLoad = 2.0;
/// One that was bent then, under less than this fraction of it, if that load was at least this fraction of its own weight: the load that is
/// read while it comes to rest is by some tens of per cent off.
inline constexpr double kBentLoad = 0.25, kLeastBentLoad = 0.5;
/// After this time of slow motion, s, the load is a mean over some kMeanLoadTime, s: two pieces that rock on each other exchange their
/// loads, and would deform at each turn and never sleep.
inline constexpr double kLoadRest = 1.0, kMeanLoadTime = 0.25;
/// Contacts with one object belong to one patch while the cosine between their normals is above this.
inline constexpr double kPatchCosine = 0.95;
/// An impact on a patch acts on the nodes within this depth of the foremost, in cells.
inline constexpr double kFrontDepth = 0.5;
/// What is added to a patch's second moments, in squared cells, so that a line and a point have an inverse.
inline constexpr double kLeastPatchSpread = 1e-3;
/// The fraction of the energy of an impact between two soft bodies that strains one of them.
inline constexpr double kSharedImpact = 0.5;
/// Velocity from which impacts on pinned bodies in their rigid state are searched, m/s: the least that strains them depends on the mass.
inline constexpr double kHeldForecast = 0.05;
/// A pin that follows a body has not moved if its node is within this distance of it, m: the rounding of positions.
inline constexpr btScalar kStillPin = btScalar( 1e-4 );

} // namespace pliant
