#pragma once

// Limits for values that the C face passes to Bullet, which does not check them.

namespace pliant::c {

/// Largest coordinate of a position, m: that of SoftBody::create.
inline constexpr double kMostPosition = 1e9;
/// Largest length of a rigid shape, m: at 1e6 m the resolution of a float is 6 cm.
inline constexpr double kMostLength = 1e6;
/// Largest mass of a rigid body, kg: its inertia, times the square of kMostLength, stays a finite float.
inline constexpr double kMostMass = 1e12;
/// Largest component of a velocity, m/s or rad/s: that of SoftBody.
inline constexpr double kMostSpeed = 1e5;
/// Time within which a force may not lead beyond kMostSpeed, s: that of SoftBody.
inline constexpr double kForceTime = 1.0 / 60.0;
/// Largest force or moment of a motor, N or N m: with kMostLength a finite float.
inline constexpr double kMostForce = 1e12;
/// Fraction of a joint's error that a step corrects: with Bullet's default of .2 a bar of half a metre on a slider hangs 4 cm too low.
inline constexpr double kJointErrorReduction = 0.8;
/// Largest component of gravity, m/s^2: within a step of 1/60 s it leads to a fifth of kMostSpeed.
inline constexpr double kMostGravity = 1e6;
/// Largest friction: beyond it Bullet's limits overflow a float.
inline constexpr double kMostFriction = 1e6;
/// Largest number of threads and of soft substeps: those of SoftBodyHost.
inline constexpr int kMostThreads = 64;
inline constexpr int kMostSubsteps = 64;
/// Largest number of vertices or triangles of a rigid mesh: Bullet counts with int.
inline constexpr unsigned long long kMostElements = 100000000;

/// Length of the normals that debug drawing shows at Bullet's contacts, m.
inline constexpr double kContactNormalLength = 0.1;

} // namespace pliant::c
