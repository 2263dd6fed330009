#pragma once

// Fields of simple solids, about the distance to the surface, above 0 inside; and their union with a fillet.

#include "demos/marching.h"

namespace pliant_demos {

/// A box of half-edges `half`, its edges rounded with `radius`.
float roundBox( const Point& p, const Point& centre, const Point& half, float radius );

/// A rod from `a` to `b` with round ends, thicker at one of them.
float rod( const Point& p, const Point& a, const Point& b, float radiusA, float radiusB );

/// An ellipsoid with the given axes (at right angles, of unit length).
float ellipsoid( const Point& p, const Point& centre, const std::array<Point, 3>& axes, const Point& radii );

/// The union of two solids, with a fillet about as wide as `fillet` where they meet.
float join( float a, float b, float fillet );

} // namespace pliant_demos
