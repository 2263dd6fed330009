#pragma once

// Constants of bodies and templates, each with its unit and reason.

namespace pliant {

/// Bounds of the factor by which a template may be scaled: outside of them squares of a model's lengths leave the range of single
/// precision.
inline constexpr float kSmallestScale = 1e-6f, kLargestScale = 1e6f;

} // namespace pliant
