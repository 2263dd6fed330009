#pragma once

// Constants of the drawn surface as a shape.

#include <LinearMath/btScalar.h>

namespace pliant {

/// A triangle whose normal differs by more than this from the mean of those around its corner, 25 degrees, is at a crease: the facets of
/// round meshes differ by up to 20, the faces of a box by 45 and more.
inline constexpr float kCreaseCosine = 0.906f;

/// An object is behind a triangle that it touches where the cosine of the angle between their normals is below the negative of this.
inline constexpr btScalar kBehindCosine = btScalar( 0.5 );

/// Contact tests divide the triangles near an object to the size of a cell, but no more often than this: of a body that has been stretched
/// or thrown to 1e24 m they would never end.
inline constexpr int kMostSurfaceSplits = 100000;

} // namespace pliant
