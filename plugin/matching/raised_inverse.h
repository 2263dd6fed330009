#pragma once

// The regularised inverse of a symmetric matrix: the 9 x 9 moments of quadratic clusters (Müller et al. 2005, section 4.3).

#include <Eigen/Core>

namespace pliant {

using Moment9 = Eigen::Matrix<double, 9, 9>;

/// The inverse of a symmetric positive semidefinite matrix, with eigenvalues below `floorFraction` of the largest raised to that floor.
/// Returns zero for the zero matrix. Uses Jacobi rotations: accurate to rounding, and the same on every compiler.
Moment9 raisedInverse( const Moment9& moment, double floorFraction );

} // namespace pliant
