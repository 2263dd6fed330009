#pragma once

// Computes the softness for which a coarse region resists a deformation as the finest regions under it do together. Ohta et al. 2009, eq.
// 7-10 (by size alone) and, as an extension, by the second and fourth moments of the regions' actual contents, so that borders, cracks and
// mixed levels count. Evaluated with the node positions that the step uses.

#include "adapt/moments/fine_moments.h"

namespace pliant {

/// Rest shape of a region, as the step needs it.
struct RegionRest
{
	double mass = 0.0;                                ///< full cells
	Vec3d centre = Vec3d::Zero();                     ///< c0_r, cells
	Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< J_r, cells^2
	/// J_r^+; directions whose eigenvalue is below a hundredth of the largest are dropped.
	Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
	Eigen::Matrix3d outside = Eigen::Matrix3d::Zero(); ///< 1 - J_r J_r^+
	bool isFlat = false;                               ///< true where `outside` is not zero
};

RegionRest measureRegion( const Octree& octree, const Cut& cut, const RegionMatrix& matrix, std::uint32_t region, float cellSize );

/// Ohta et al. 2009, eq. 8, 9, 10: beta = 1 - ( ( 2w + 1 ) / ( 2w + m^(1/k) ) )^k for k = 1, 2, 3 dimensions, m in full finest cells.
/// Clamped to [0, 0.95]: it would be negative for a node of less than one cell.
double ohtaBeta( double mass, int halfWidth, int dimensions );

/// beta = 1 - tr( J_fine ) / tr( J_r ), within [0, 0.95]: for every affine deformation the energy is that of the finest regions.
double energyBeta( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment );

/// The same for each direction: C = J_r^+ J_fine, with its stretch limited as beta is to [0, 0.95]. The two symmetric matrices need not
/// commute; C is their product, with J_fine limited so that 0.05 J_r <= J_fine <= J_r.
Eigen::Matrix3d energyBlend( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment );
/// The same, always through eigenvalues: the reference implementation of energyBlend, which calls it where a limit is reached.
Eigen::Matrix3d energyBlendByDirections( const Eigen::Matrix3d& fineMoment, const Eigen::Matrix3d& moment );

/// Returns the fraction of the residual, which no affine motion explains, that a region does not correct, so that quadratic deformations
/// also cost the same energy as in the finest regions: eta = 1 - sum ( E_k - ( 1 - beta ) a_k ) / sum rho_k over the six quadratics, within
/// [0, 0.95]. Returns `beta` where there is no residual.
double quadraticEta( const Octree& octree, const Cut& cut, const RegionMatrix& matrix, std::uint32_t region, const FineMoments& fine,
	const RegionRest& rest, float cellSize, double beta );

/// J_fine of an octree node.
Eigen::Matrix3d fineMoment( const FineMoments& fine, std::uint32_t node );

} // namespace pliant
