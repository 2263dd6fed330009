#pragma once

// Constants of the forces that games apply, each with its unit and reason.

#include <LinearMath/btScalar.h>

#include <cstdint>

namespace pliant {

/// Largest pressure of a gas, Pa: ten thousand atmospheres, above which nothing that the library simulates holds.
inline constexpr btScalar kMostPressure = btScalar( 1e9 );

/// Largest velocity of wind and water, m/s: three times that of sound in air, where drag has another law.
inline constexpr btScalar kMostFlow = btScalar( 1000 );

/// Largest densities of wind and water, kg/m^3: beyond the heaviest gases and liquids.
inline constexpr btScalar kMostAirDensity = btScalar( 1e4 ), kMostWaterDensity = btScalar( 1e5 );

/// Largest coefficients of drag and lift: those of real shapes are below 3.
inline constexpr btScalar kMostDrag = btScalar( 100 );

/// Largest exponent of an explosion's falloff: beyond it nothing but the centre is hit.
inline constexpr btScalar kMostFalloff = btScalar( 10 );

/// Directions in which the outline of a rigid shape is sampled: the area of a sphere is then 2.6 % too small.
inline constexpr int kOutlineDirections = 16;

/// A leaf of the tree over a surface's triangles: few enough that testing them all costs as much as one more level.
inline constexpr std::uint32_t kTrianglesOfALeaf = 4;

/// A point nearer to a surface than the square root of this, in edges of the triangle, lies on it: rounding.
inline constexpr double kSurfaceRounding = 1e-12;

/// Scales of SoftBody::setScale: beyond them a body of a metre is a millimetre or a kilometre.
inline constexpr btScalar kSmallestBodyScale = btScalar( 1e-3 ), kLargestBodyScale = btScalar( 1e3 );

} // namespace pliant
