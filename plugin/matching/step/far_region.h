#pragma once

// How much of a far region's goal counts, so that the level has the stiffness of a solid: stretched, bent, cut short at its end, or held.

#include "lattice/lattice.h"

#include <vector>

namespace pliant {

/// What a region of a far level weighs: its moments, and how much of its goal counts.
struct FarRegion
{
	double mass = 0.0;                                ///< full cells, pinned ones counted kPinnedWeight times
	Vec3d centre = Vec3d::Zero();                     ///< cells
	Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< cells^2
	double pull = 0.0;                                ///< b_r
	double eta = 0.0;
};

/// First and second moments of a set of cells about the rest mass centre, in cells; sums.
struct FarMoments
{
	double mass = 0.0;
	Vec3d first = Vec3d::Zero();
	Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

	void add( const FarMoments& other, double fraction );
	Eigen::Matrix3d aboutCentre() const { return second - first * first.transpose() / mass; }
};

/// The cells of one region.
struct RegionCells
{
	std::vector<Vec3d> place;   ///< cells
	std::vector<double> weight; ///< full cells, heavy where pinned
};

/// b_r and eta_r from a region's moments with pinned cells heavy, and without.
FarRegion weighFarRegion( const FarMoments& heavy, const FarMoments& plain, int level );

/// eta of a region that holds pinned cells: these stand to one side, where the closed form does not know them. `mu`: farSecondMoment.
double etaOfHeld( const RegionCells& cells, const FarRegion& region, const FarMoments& plain, double mu );

} // namespace pliant
