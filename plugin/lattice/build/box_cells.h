#pragma once

// The cells of boxes along the axes. Cells that a box's faces cut get their mass from samples that all lie on the same side of the face, so
// that a cube of 8.2 cells would have the mass of one of 8.5; cells that divide its edges are full.

#include "lattice/lattice.h"

namespace pliant {

/// Whether a closed mesh is a box along the axes, by its bounding box, m, its area, m^2, and its volume, m^3.
bool isBox( const Vec3d& size, double area, double volume );

/// The cell edge near `near`, m, that divides the edges of a box of `size`, m, best, while the number of cells stays near `target`; 0 if
/// there is none.
double cellEdgeOfBox( const Vec3d& size, double near, double target );

} // namespace pliant
