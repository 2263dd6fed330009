#pragma once

// The surface of a field, as a closed mesh.

#include "third_party_glue/model_file.h"

#include <array>
#include <functional>

namespace pliant_demos {

using Point = std::array<float, 3>;

/// Above 0 inside.
using Field = std::function<float( const Point& )>;

/// The surface where `field` is 0 within a box at whose faces it is negative, by marching tetrahedra on cubes of edge `cell`. Closed
/// and consistently oriented by construction. Parts thinner than a cell may be missed.
pliant_glue::ModelMesh marchSurface( const Field& field, const Point& low, const Point& high, float cell );

} // namespace pliant_demos
