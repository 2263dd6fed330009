#pragma once

// The rotation of a free rigid body at constant angular momentum.

#include "lattice/lattice.h"

#include <Eigen/Geometry>

namespace pliant {

/// Returns the rotation by which a free rigid body turns within h, s. `moments`: principal moments of inertia, kg m^2; 0: the body has no
/// spin about that axis. `axes`: from the principal axes to the world's. `spin`: angular momentum about the mass centre, kg m^2/s.
Eigen::Quaterniond freeRotation( const Vec3d& moments, const Eigen::Quaterniond& axes, const Vec3d& spin, double h );

} // namespace pliant
