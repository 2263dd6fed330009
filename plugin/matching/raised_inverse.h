#pragma once

// The inverse of a symmetric matrix that need not have one: the 9 x 9 moments of quadratic clusters (Müller et al. 2005, section 4.3).

#include <Eigen/Core>

namespace pliant {

using Moment9 = Eigen::Matrix<double, 9, 9>;

/// The inverse of a symmetric positive semidefinite matrix whose eigenvalues below `floorFraction` of the largest are raised to it.
/// The zero matrix gives zero. By Jacobi rotations: exact to rounding, and the same on every compiler.
Moment9 raisedInverse( const Moment9& moment, double floorFraction );

} // namespace pliant
