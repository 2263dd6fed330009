#pragma once

// Constants of vehicle_raycaster.cpp.

namespace pliant {

/// A surface whose normal has a smaller cosine against the wheel's ray than this is no ground: the normal is then opposite to the ray.
inline constexpr double kWheelSlope = 0.5;

} // namespace pliant
