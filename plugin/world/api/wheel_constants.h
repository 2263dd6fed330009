#pragma once

// Numbers of vehicle_raycaster.cpp, each with its reason.

namespace pliant {

/// A wheel's ray meets a body where it comes to the first node that is nearer to it than this many of the node's radii: a little more than
/// half the diagonal between four nodes, sqrt( 2 ).
inline constexpr double kWheelGap = 1.5;
/// The way out of the body is taken from the nodes within so many radii of the ray, two nodes to each side, ...
inline constexpr double kWheelReach = 5.0;
/// ... that begin no deeper than so many radii below the first: one layer, on slopes up to 45 degrees.
inline constexpr double kWheelDepth = 1.9;
/// What is no flatter than this, a ratio of squares, or steeper than this cosine against the ray, is no ground: then the way out is back
/// along the ray.
inline constexpr double kWheelFlat = 0.25, kWheelSlope = 0.5;

} // namespace pliant
