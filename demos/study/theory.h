#pragma once

// What theory says where no formula does: small solvers of our own.

#include <Eigen/Core>

#include <string>

namespace pliant_study {

/// A clamped, inextensible beam of length 1 under its own weight, w L^3 / ( E I ) = load: where the point at arc length s comes to, along
/// and down. Found by shooting: for loads up to 50.
Eigen::Vector2d heavyElastica( double load, double s );

/// Sideways stretch of a compressible Neo-Hookean bar drawn to `stretch`: mu ( t^2 - 1 ) + lambda ln( stretch t^2 ) = 0.
double neoHookeanAcross( double stretch, double nu );

/// Cook's membrane, plane stress, E = 1, thickness 1, a load of 1 spread over its right edge: how far the point ( x, y ) goes up. Bilinear
/// elements on two meshes, extrapolated.
double cookDeflection( double nu, double x, double y );

/// "0.5": without zeros that say nothing.
std::string shortNumber( double value );

} // namespace pliant_study
