#pragma once

// Constants of surface_shape.cpp.

namespace pliant {

/// A triangle whose normal is farther than this from the mean of those around its corner, 25 degrees, is beside a crease: the facets of
/// round meshes are up to 20 from it, the faces of a box 45 and more.
inline constexpr float kCreaseCosine = 0.906f;

} // namespace pliant
