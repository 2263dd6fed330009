#pragma once

// Constants of bodies and templates, each with its unit and reason.

namespace pliant {

/// Factors by which a template may be scaled: beyond them lengths of a game's models leave what single precision can square.
inline constexpr float kSmallestScale = 1e-6f, kLargestScale = 1e6f;

} // namespace pliant
