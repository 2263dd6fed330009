#pragma once

// Theoretical values without a closed form: small solvers.

#include <Eigen/Core>

#include <string>

namespace pliant_study {

/// A clamped, inextensible beam of length 1 under its own weight, w L^3 / ( E I ) = load: the position of the point at arc length s, along
/// and down. Found by shooting: for loads up to 50.
Eigen::Vector2d heavyElastica( double load, double s );

/// Transverse stretch of a compressible Neo-Hookean bar stretched to `stretch`: mu ( t^2 - 1 ) + lambda ln( stretch t^2 ) = 0.
double neoHookeanAcross( double stretch, double nu );

/// Cook's membrane, plane stress, E = 1, thickness 1, a load of 1 distributed over its right edge: the upward displacement of the point (
/// x, y ). Bilinear elements on two meshes, extrapolated.
double cookDeflection( double nu, double x, double y );

/// "0.5": without trailing zeros.
std::string shortNumber( double value );

} // namespace pliant_study
