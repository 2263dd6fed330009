#pragma once

// The rotation nearest to any 3x3 matrix: what shape matching calls the polar factor (Steinemann et al. 2008, eq. 1).
// Any matrix will do: zero, flat, mirrored, huge. The answer is always finite and proper (det +1), never a reflection.
// This is the careful scalar road; the kernels' lanes come here with what their fast road could not settle.

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pliant {

/// The unit quaternion of the rotation R that maximises tr( R^T a ), the global optimum.
/// Where the matrix leaves the rotation open (zero, rank one, some reflections) the open part is taken from `previous`.
/// `a` with a number that is not finite gives `previous`.
Eigen::Quaterniond fitRotation( const Eigen::Matrix3d& a, const Eigen::Quaterniond& previous );
Eigen::Quaternionf fitRotation( const Eigen::Matrix3f& a, const Eigen::Quaternionf& previous );

} // namespace pliant
