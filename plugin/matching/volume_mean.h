#pragma once

#include "matching/kernels/volume_limits.h"

#include <Eigen/Dense>

#include <algorithm>

namespace pliant {

/// b of volume keeping: a mean of the moments whose pseudo-inverse is `inverse`, in `extents` directions (volumeMatrix in kernel_volume.h);
/// 0 if none.
inline double volumeMean( const Eigen::Matrix3d& inverse, double extents )
{
	const double sum = inverse.trace(), harmonic = extents / sum;
	return sum > 0.0 ? harmonic * std::min( double( kVolumeLimit ), harmonic * inverse.squaredNorm() / sum ) : 0.0;
}

/// h of volume keeping: ( tr M - M ) h = - axial( F R^T ), zero where the fit is no maximum (volumeTurn in kernel_volume.h). `turning`: M;
/// `stretch`: F R^T.
inline Eigen::Matrix3d volumeTurn( const Eigen::Matrix3d& turning, const Eigen::Matrix3d& stretch, double moment )
{
	const Eigen::Matrix3d symmetric = 0.5 * ( turning + turning.transpose() ),
						  matrix = symmetric.trace() * Eigen::Matrix3d::Identity() - symmetric;
	const Eigen::Vector3d axial( stretch( 1, 2 ) - stretch( 2, 1 ), stretch( 2, 0 ) - stretch( 0, 2 ), stretch( 0, 1 ) - stretch( 1, 0 ) );
	const bool isMaximum = matrix( 0, 0 ) > 0.0 && matrix.topLeftCorner<2, 2>().determinant() > 0.0 &&
		matrix.determinant() > double( kLeastTurning ) * moment * moment * moment;
	const Eigen::Vector3d h = isMaximum ? Eigen::Vector3d( -matrix.inverse() * axial ) : Eigen::Vector3d( Eigen::Vector3d::Zero() );
	Eigen::Matrix3d across;
	across << 0.0, -h.z(), h.y(), h.z(), 0.0, -h.x(), -h.y(), h.x(), 0.0;
	return across;
}

} // namespace pliant
