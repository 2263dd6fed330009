#pragma once

// Constants of vehicle_raycaster.cpp.

namespace pliant {

/// A wheel's ray hits the first node whose centre is closer to the ray than this many radii of the node: a little more than half the
/// diagonal between four nodes, sqrt( 2 ).
inline constexpr double kWheelGap = 1.5;
/// The surface normal is computed from the nodes within this many radii of the ray, two nodes to each side, ...
inline constexpr double kWheelReach = 5.0;
/// ... that lie at most this many radii deeper than the first: one layer, on slopes up to 45 degrees.
inline constexpr double kWheelDepth = 1.9;
/// Nodes less flat than this ratio of squares, or a normal with a smaller cosine against the ray than this, are not ground: the normal is
/// then opposite to the ray.
inline constexpr double kWheelFlat = 0.25, kWheelSlope = 0.5;

} // namespace pliant
