#pragma once

// Motion of the obstacles of a soft body.

#include "world/touch/node_touch.h"

namespace pliant {

/// Motion of an object in a step, relative to the soft body's origin.
struct ObstacleMotion
{
	Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero(), centre = Vec3d::Zero();

	bool isStill() const { return linear.isZero( 0.0 ) && angular.isZero( 0.0 ); }
	/// The obstacle at the step's end.
	Obstacle moved( const Obstacle& obstacle, double step ) const
	{
		Obstacle then = obstacle;
		const double angle = step * angular.norm();
		const Vec3d apart = obstacle.position - centre;
		const Eigen::Matrix3d turn = angle > 0.0 ? Eigen::AngleAxisd( angle, angular.normalized() ).toRotationMatrix()
												 : Eigen::Matrix3d::Identity();
		then.basis = turn * obstacle.basis;
		then.position = centre + step * linear + turn * apart;
		return then;
	}
	Vec3d displacement( const Vec3d& at, double step ) const { return step * ( linear + angular.cross( at - centre ) ); }
};

} // namespace pliant
