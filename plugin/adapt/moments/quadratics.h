#pragma once

namespace pliant {

/// The two axes of quadratic k: xx, yy, zz, yz, xz, xy.
inline constexpr int kQuadraticFirst[6] = { 0, 1, 2, 1, 0, 0 };
inline constexpr int kQuadraticSecond[6] = { 0, 1, 2, 2, 2, 1 };

} // namespace pliant
