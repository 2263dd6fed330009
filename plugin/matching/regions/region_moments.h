#pragma once

// Rest data of a region: weights, mass, centre and second moment. Built once per lattice, half-width and weight rule.
//
// Lengths are in cells and masses in full cells, so that every number here is of order 1 whatever the body's size.
// With node weights a_i, region weights b_r and covers C_i the step computes
//   gather:   M_r = sum a_i,  c0_r = sum a_i q_i / M_r,  J_r = sum a_i (q_i - c0_r)(q_i - c0_r)^T        (i in r)
//   scatter:  goal_i = sum b_r goal_{r,i} / C_i                                                          (r containing i)
// Conserving weights: a_i = m_i / n_i, b_r = 1, C_i = n_i. The scatter is then the transpose of the gather: m_i / C_i = a_i.
// Literal weights (Steinemann et al. 2008, eq. 6-8): a_i = m_i, b_r = m_r, C_i = sum of m_r. They leak momentum; kept for comparison.

#include "lattice/region.h"
#include "matching/aligned_array.h"
#include "pliant/material.h"

#include <Eigen/Core>

namespace pliant {

/// Entry i of six arrays: a symmetric matrix as xx, yy, zz, yz, xz, xy.
inline void storeSymmetric( AlignedArray<float> ( &to )[6], int i, const Eigen::Matrix3d& m )
{
	const double entry[6] = { m( 0, 0 ), m( 1, 1 ), m( 2, 2 ), m( 1, 2 ), m( 0, 2 ), m( 0, 1 ) };
	for ( int k = 0; k < 6; ++k )
	{
		to[k][i] = float( entry[k] );
	}
}

/// The matrix that storeSymmetric wrote.
inline Eigen::Matrix3d loadSymmetric( const AlignedArray<float> ( &from )[6], int i )
{
	const double xx = from[0][i], yy = from[1][i], zz = from[2][i], yz = from[3][i], xz = from[4][i], xy = from[5][i];
	Eigen::Matrix3d m;
	m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
	return m;
}

/// Arrays are padded to whole lanes; padding regions have zero mass moments and a unit second moment, so that no lane divides by zero.
struct RegionMoments
{
	int count = 0;
	int padded = 0;

	AlignedArray<float> nodeWeight;   ///< a_i
	AlignedArray<float> inverseCover; ///< 1 / C_i
	AlignedArray<float> regionWeight; ///< b_r; empty when all are 1

	AlignedArray<float> inverseMass; ///< 1 / M_r
	AlignedArray<float> centre[3];   ///< c0_r, cells, relative to the rest mass centre
	AlignedArray<float> moment[6];   ///< J_r as xx, yy, zz, yz, xz, xy

	/// J_r^+, same order, eigenvalues floored at kMomentFloor of the largest. Empty unless needed (needsInverse).
	AlignedArray<float> inverseMoment[6];
};

/// The pseudo-inverse J^+ of a possibly flat region: axes with less than `floorFraction` of the largest moment are left out of it, and form
/// `outside` = 1 - J J^+, which is zero for a solid region.
Eigen::Matrix3d inverseInPlane( const Eigen::Matrix3d& moment, double floorFraction, Eigen::Matrix3d& outside );

/// Replaces J^+ of flat and thin regions by the pseudo-inverse and stores 1 - J J^+ of all; `outOfPlane` stays empty where all are solid.
void markFlatRegions( RegionMoments& moments, AlignedArray<float> ( &outOfPlane )[6] );

/// The moments of the lattice that a piece came off, with the same settings.
struct MomentsBefore
{
	const RegionMoments& moments;
	const RegionSet& regions;                     ///< at least the sizes
	const std::vector<std::uint32_t>& cellBefore; ///< of each cell of the piece
	Vec3d shift;                                  ///< the piece's mass centre relative to the previous one, cells
};

/// With `before`, unchanged regions are copied; the result differs only in the rounding of their centres.
RegionMoments computeRegionMoments(
	const Lattice& lattice, const RegionSet& regions, Weights weights, bool withInverse, const MomentsBefore* before = nullptr );

/// The inverse of a symmetric positive semidefinite matrix, with eigenvalues below `floorFraction` of the largest raised to that floor.
/// Returns zero for the zero matrix.
Eigen::Matrix3d flooredInverse( const Eigen::Matrix3d& moment, double floorFraction );

/// The inverse of a connected part's inertia, kg m^2, with kInertiaFloor; zero for a point, which cannot rotate.
Eigen::Matrix3d inverseOfPart( const Eigen::Matrix3d& inertia, double mass );

} // namespace pliant
