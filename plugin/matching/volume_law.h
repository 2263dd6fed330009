#pragma once

// Volume conservation of a region in double precision (kernels/kernel_volume.h has the law and its reasons).

#include "matching/kernels/volume_limits.h"
#include "matching/rotation.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

/// b of volume conservation: a mean of the moments whose pseudo-inverse is `inverse`, in `extents` directions; 0 if none.
inline double volumeMean( const Eigen::Matrix3d& inverse, double extents )
{
	const double sum = inverse.trace(), harmonic = extents / sum;
	return sum > 0.0 ? harmonic * std::min( double( kVolumeLimit ), harmonic * inverse.squaredNorm() / sum ) : 0.0;
}

/// B of volume conservation; `mean`: b.
inline Eigen::Matrix3d volumeWeights( const Eigen::Matrix3d& moment, double mean, double extents )
{
	const double share = kMomentShare, whole = ( 1.0 - share ) * mean + share * moment.trace() / extents;
	return ( ( 1.0 - share ) * mean * Eigen::Matrix3d::Identity() + share * moment ) / ( whole > 0.0 ? whole : 1.0 );
}

/// m and N of kernels/kernel_volume.h, by principal stretches.
struct VolumeStrain
{
	double size = 0.0;
	Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity();
};

/// `stretch`: U; `weights`: B.
inline VolumeStrain volumeStrain( const Eigen::Matrix3d& stretch, const Eigen::Matrix3d& weights )
{
	const Eigen::Matrix3d one = Eigen::Matrix3d::Identity(), added = weights - one;
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( 0.5 * ( stretch + stretch.transpose() ) );
	const Eigen::Vector3d deviator = solver.eigenvalues().array() - solver.eigenvalues().mean();
	double low = -deviator.minCoeff(), high = 1.0 + 2.0 * deviator.norm() / std::sqrt( 6.0 );
	for ( int k = 0; k < 80; ++k )
	{
		const double x = 0.5 * ( low + high );
		( ( deviator.array() + x ).prod() < 1.0 ? low : high ) = x;
	}
	const Eigen::Vector3d inverse = ( deviator.array() + high ).inverse();
	const Eigen::Matrix3d& axes = solver.eigenvectors();
	return { solver.eigenvalues().sum() - 3.0 * high + added.cwiseProduct( stretch - one ).sum(),
		axes * ( 3.0 / inverse.sum() * inverse ).asDiagonal() * axes.transpose() + added };
}

/// Energy per kappa b at m.
inline double volumeEnergy( double size )
{
	return std::abs( size ) < 1.0 ? 0.5 * size * size : std::abs( size ) - 0.5;
}

/// Result of a region's fit: R, F, the matrix that R is fitted to, R C^T, J^+, J before plastic flow and the number of directions with
/// extent.
struct VolumeFit
{
	Eigen::Matrix3d rotation, f, fitted, across, inverse, moment;
	double extents = 3.0;
};

/// The force on rest positions, relative to kappa: b m ( R N J^+ + h x R ). `most`: MatchView::mostVolumeResponse.
inline Eigen::Matrix3d volumeMatrix( const VolumeFit& fit, double most )
{
	const double mean = volumeMean( fit.inverse, fit.extents ), size = fit.moment.trace();
	const VolumeStrain volume = volumeStrain( fit.rotation.transpose() * fit.f, volumeWeights( fit.moment, mean, fit.extents ) );
	const Eigen::Matrix3d turning = fit.fitted * fit.rotation.transpose(), symmetric = 0.5 * ( turning + turning.transpose() ),
						  matrix = symmetric.trace() * Eigen::Matrix3d::Identity() - symmetric;
	const Eigen::Matrix3d stretch = fit.f * volume.gradient * fit.rotation.transpose();
	const Eigen::Vector3d axial( stretch( 1, 2 ) - stretch( 2, 1 ), stretch( 2, 0 ) - stretch( 0, 2 ), stretch( 0, 1 ) - stretch( 1, 0 ) );
	const bool isMaximum = matrix( 0, 0 ) > 0.0 && matrix.topLeftCorner<2, 2>().determinant() > 0.0 &&
		matrix.determinant() > double( kLeastTurning ) * size * size * size;
	const Eigen::Vector3d h = isMaximum ? Eigen::Vector3d( -matrix.inverse() * axial ) : Eigen::Vector3d( Eigen::Vector3d::Zero() );
	const double limited = volume.size > 0.0 ? std::min( 1.0, most / volume.gradient.squaredNorm() ) : 1.0;
	const double scale = std::clamp( volume.size, -1.0, 1.0 ) * limited;
	return scale * mean * ( fit.rotation * volume.gradient * fit.inverse + crossMatrix( h ) * fit.across );
}

} // namespace pliant
