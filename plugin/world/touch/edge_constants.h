#pragma once

// Constants of faces at edges and in thin parts, and of small objects.

#include <LinearMath/btScalar.h>

namespace pliant {

/// Static and kinematic objects that are narrower than this, cells, touch the drawn surface as those that move do: larger ones
/// meet many spheres.
inline constexpr double kSmallThing = 3.0;
/// Objects smaller than this, cells, touch faces at edges: larger ones rest on the nodes' spheres there, and are not braked by the rims of
/// faces as they slide over an edge.
inline constexpr double kEdgeThing = 1.5;
/// How much farther than to the nodes' spheres such objects are searched for, cells.
inline constexpr double kSmallReach = 0.5;
/// Two faces are on opposite sides of a sheet where the cosine of the angle between their normals is below the negative of this.
inline constexpr double kOppositeCosine = 0.9;
/// A face is at most so far in front of a coarse node, in sizes of the node: beyond it belongs to the layer above.
inline constexpr double kLayerHeight = 0.6;
/// Two corners of a convex object are one where they are nearer than this fraction of its largest extent, or than a centimetre (Bullet).
inline constexpr btScalar kCornerFraction = btScalar( 0.01 );
/// Two faces are in one plane where their normals have this cosine and their distance is below this, cells.
inline constexpr double kCoplanarCosine = 0.999, kPlaneTolerance = 0.05;

} // namespace pliant
