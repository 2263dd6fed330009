#pragma once

// Constants of edge_faces.cpp and its use.

namespace pliant {

/// Static and kinematic objects smaller than this, cells, touch the drawn surface as those that move do: larger ones meet many spheres.
inline constexpr double kSmallThing = 3.0;
/// Objects smaller than this, cells, touch faces at edges: larger ones rest on the nodes' spheres there, and are not braked by the rims of
/// faces as they slide over an edge.
inline constexpr double kEdgeThing = 1.5;
/// How much farther than to the nodes' spheres such objects are searched for, cells.
inline constexpr double kSmallReach = 0.5;
/// A face is at most so far in front of a node at an edge, cells: the layer below the surface has none.
inline constexpr double kEdgeFaceHeight = 1.0;
/// The same on bodies with levels, where the nodes of the layer above may be smaller, in sizes of the node.
inline constexpr double kLayerHeight = 0.6;
/// Two faces are in one plane where their normals have this cosine and their distance is below this, cells.
inline constexpr double kCoplanarCosine = 0.999, kPlaneTolerance = 0.05;

} // namespace pliant
