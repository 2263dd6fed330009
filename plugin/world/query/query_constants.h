#pragma once

// Constants of surface_shape.cpp.

namespace pliant {

/// A triangle whose normal differs by more than this from the mean of those around its corner, 25 degrees, is at a crease: the facets of
/// round meshes differ by up to 20, the faces of a box by 45 and more.
inline constexpr float kCreaseCosine = 0.906f;

} // namespace pliant
