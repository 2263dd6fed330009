#pragma once

// The rotation nearest to any 3x3 matrix, the polar factor of shape matching (Steinemann et al. 2008, eq. 1). Accepts any matrix: zero,
// flat, mirrored, huge. The result is always finite and proper (det +1), never a reflection.
// This is the robust scalar path; the kernels use it for lanes that their fast path cannot resolve.

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pliant {

/// The unit quaternion of the rotation R that maximises tr( R^T a ), the global optimum.
/// Where the matrix leaves the rotation undetermined (zero, rank one, some reflections) the undetermined part is taken from `previous`.
/// Returns `previous` if `a` has a non-finite entry.
Eigen::Quaterniond fitRotation( const Eigen::Matrix3d& a, const Eigen::Quaterniond& previous );
Eigen::Quaternionf fitRotation( const Eigen::Matrix3f& a, const Eigen::Quaternionf& previous );

/// The rotation by a rotation vector, rad.
inline Eigen::Quaterniond rotationBy( const Eigen::Vector3d& vector )
{
	const double angle = vector.norm();
	return angle > 0.0 ? Eigen::Quaterniond( Eigen::AngleAxisd( angle, vector / angle ) ) : Eigen::Quaterniond::Identity();
}

/// The matrix of the cross product: crossMatrix( a ) b = a x b.
inline Eigen::Matrix3d crossMatrix( const Eigen::Vector3d& a )
{
	Eigen::Matrix3d m;
	m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
	return m;
}

} // namespace pliant
