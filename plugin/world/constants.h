#pragma once

// Numbers of the coupling to Bullet, each with its unit and reason.

#include <LinearMath/btScalar.h>

namespace pliant {

/// Sphere radii are rounded to steps of 2^(1/16), so that nodes share shapes.
inline constexpr double kRadiusStepsPerOctave = 16.0;

/// Contacts are made this far ahead of touch at least, in node radii, so that a resting contact does not flicker.
inline constexpr btScalar kContactSlop = btScalar( 0.04 );

/// A node that moves more than this share of its radius in a step is swept instead of asked for its nearest point.
inline constexpr double kFastShare = 0.5;

/// Root mean square speed of the nodes below which a body may fall asleep, m/s.
inline constexpr btScalar kSleepSpeed = btScalar( 0.03 );

/// Soft substeps: default, largest, and the default bound up to which stiff materials raise them by themselves.
inline constexpr int kDefaultSubsteps = 4;
inline constexpr int kLargestSubsteps = 64;
inline constexpr int kDefaultMaxSubsteps = 16;

/// The game step that substeps are counted for, s. Longer steps get more.
inline constexpr btScalar kNominalStep = btScalar( 1 ) / 60;

} // namespace pliant
