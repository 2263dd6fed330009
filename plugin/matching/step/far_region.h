#pragma once

// Weights of a far region's goal that give the level the stiffness of a solid: in tension, in bending, truncated, or pinned.

#include "lattice/lattice.h"

#include <vector>

namespace pliant {

/// A region of a far level: its moments, and the weight of its goal.
struct FarRegion
{
	double mass = 0.0;                                ///< full cells, pinned ones weighted by kPinnedWeight
	Vec3d centre = Vec3d::Zero();                     ///< cells
	Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< cells^2
	double pull = 0.0;                                ///< b_r
	double eta = 0.0;
};

/// First and second moments of a set of cells about the rest mass centre, in cells; plain sums.
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
	std::vector<Vec3d> position; ///< cells
	std::vector<double> weight;  ///< full cells, weighted for pins
};

/// b_r and eta_r from a region's moments with and without the extra weight of pinned cells.
FarRegion weighFarRegion( const FarMoments& weighted, const FarMoments& plain, int level );

/// eta of a region with pinned cells: these are off to one side, which the closed form does not cover. `mu`: farSecondMoment.
double etaOfPinned( const RegionCells& cells, const FarRegion& region, const FarMoments& plain, double mu );

} // namespace pliant
