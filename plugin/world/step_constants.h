#pragma once

// How implicit bodies divide a game step. docs/design/implicit.md, "Landings" and "Large changes of shape".

namespace pliant {

/// A step resolves a body's own vibrations while sound travels at most this fraction of the body's size in it: an impact on a heavy object
/// then takes some 20 steps. From the whole size on the impact is over within a step, and restitution alone makes it rebound.
inline constexpr double kResolvedTravel = 0.25;
/// An impact of an implicit body is resolved where it strains the body by more than the first and less than the second, the velocity of
/// approach over that of sound, since a faster one crushes it; and where it is faster than a fall from this fraction of the body's size.
inline constexpr double kLandingStrain = 0.03, kMostLandingStrain = 1.0, kLandingFall = 0.1;
/// It is found so many game steps ahead, and over after so many crossings of sound.
inline constexpr double kLandingSteps = 2.0, kLandingCrossings = 4.0;
/// A rolling body moves by at most this fraction of the spacing of its nodes in a substep, since other nodes touch the ground in each; but
/// for that it takes at most this multiple of the usual substeps, because everything that takes substeps takes as many.
inline constexpr double kRolledSpacings = 0.3, kMostRollingSubsteps = 2.0;
/// In islands of more deformable bodies it is not resolved: all of them would take the substeps, and in a heap nobody sees it.
inline constexpr int kMostLandingBodies = 2;
/// Implicit bodies take longer game steps in parts of at most this length, s.
inline constexpr double kLongestImplicitStep = 1.0 / 30.0;
/// Up to this game step, s, the default bound of the number of substeps holds; longer ones get proportionally more.
inline constexpr double kLongestPlayedStep = 1.0 / 15.0;
/// Links of an implicit body that sound crosses more often than this in a step are stretched by at most this in it, in rest lengths.
inline constexpr double kStiffTravel = 4.0, kMostStretch = 0.15;

/// An object that would move the nodes of a sleeping implicit body by this many cells within a step wakes it before it hits it.
inline constexpr double kWakingDisplacement = 0.05;
/// And that is faster by the velocity of a fall for so many steps: what is put down on it wakes it as it touches it.
inline constexpr double kWakingFall = 2.0;

} // namespace pliant
