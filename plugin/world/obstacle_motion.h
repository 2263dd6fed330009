#pragma once

// How what a soft body meets moves.

#include "lattice/lattice.h"

namespace pliant {

/// How an object moves in a step, relative to the soft body's origin.
struct ObstacleMotion
{
	Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero(), centre = Vec3d::Zero();

	bool isStill() const { return linear.isZero( 0.0 ) && angular.isZero( 0.0 ); }
	Vec3d way( const Vec3d& at, double step ) const { return step * ( linear + angular.cross( at - centre ) ); }
};

} // namespace pliant
