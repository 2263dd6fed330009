#pragma once

// How soft a big region must be so that it resists a deformation as the finest regions under it would together.
// Ohta et al. 2009, eq. 7-10 (by size alone) and, beyond it, by the second and fourth moments of what the regions really hold, so that
// borders, cracks and mixed levels count. Evaluated with the node positions the step uses.

#include "adapt/moments/fine_moments.h"

namespace pliant {

/// What a region of the step needs to know of its rest shape.
struct RegionRest
{
	double mass = 0.0;                                ///< full cells
	Vec3d centre = Vec3d::Zero();                     ///< c0_r, cells
	Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< J_r, cells^2
	Eigen::Matrix3d inverse =
		Eigen::Matrix3d::Zero(); ///< J_r^+: directions with less than a thousandth of the largest extent count as none
	Eigen::Matrix3d outside = Eigen::Matrix3d::Zero(); ///< 1 - J_r J_r^+
	bool isFlat = false;                               ///< whether `outside` is not zero
};

RegionRest measureRegion( const Octree& octree, const Cut& cut, const RegionMatrix& matrix, std::uint32_t region, float cellSize );

/// Ohta et al. 2009, eq. 8, 9, 10: beta = 1 - ( ( 2w + 1 ) / ( 2w + m^(1/k) ) )^k for k = 1, 2, 3 dimensions, m in full finest cells.
/// Within [0, 0.95]: a node of less than one cell would give less than 0.
double ohtaBeta( double mass, int halfWidth, int dimensions );

/// beta = 1 - tr( J_fine ) / tr( J_r ), within [0, 0.95]: for every affine deformation the energy is that of the finest regions.
double energyBeta( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment );

/// The same for each direction: C = J_r^+ J_fine, its stretch within what beta in [0, 0.95] allows. Symmetric parts of the two need not
/// commute; C is taken as the product, J_fine limited so that 0.05 J_r <= J_fine <= J_r.
Eigen::Matrix3d energyBlend( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment );
/// The same always by way of eigenvalues: energyBlend's slow twin, and what it does where a limit is met.
Eigen::Matrix3d energyBlendByDirections( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment );

/// Share of the residual, which no affine motion explains, that a region leaves alone, so that quadratic deformations too cost what
/// they cost the finest regions: eta = 1 - sum ( E_k - ( 1 - beta ) a_k ) / sum rho_k over the six quadratics, within [0, 0.95].
/// `beta` where there is no residual.
double quadraticEta( const Octree& octree, const Cut& cut, const RegionMatrix& matrix, std::uint32_t region, const FineMoments& fine,
	const RegionRest& rest, float cellSize, double beta );

/// J_fine of an octree node.
Eigen::Matrix3d fineMoment( const FineMoments& fine, std::uint32_t node );

} // namespace pliant
