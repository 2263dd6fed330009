#pragma once

// Numbers of the coupling to Bullet, each with its unit and reason.

#include <LinearMath/btScalar.h>

#include <cstddef>

namespace pliant {

/// SoftBody::setSurfaceTolerance unless set, cells: a tenth of a pixel where a cell is ten of them.
inline constexpr double kSurfaceTolerance = 1e-2;

/// Sphere radii are rounded to steps of 2^(1/16), so that nodes share shapes.
inline constexpr double kRadiusStepsPerOctave = 16.0;

/// Contacts of a pair whose memory is asked for before their turn.
inline constexpr std::size_t kContactsAhead = 2;
/// The same of a body's stand-ins.
inline constexpr std::size_t kStandsAhead = 4;
/// And of points that go back to the surfaces.
inline constexpr std::size_t kPositionsAhead = 12;

/// Contacts are made this far ahead of touch at least, in node radii, so that a resting contact does not flicker.
inline constexpr btScalar kContactSlop = btScalar( 0.04 );

/// Clear of a plane or a box is what misses it by more than this share of a radius: rounding, of a world ten thousand kilometres wide.
inline constexpr double kFarSlack = 1e-6;

/// A node that moves more than this share of its radius in a step is swept instead of asked for its nearest point.
inline constexpr double kFastFraction = 0.5;

/// Advances of what is swept until it touches: most take two, what grazes an edge a few more.
inline constexpr int kMostAdvances = 32;

/// Contact processing threshold of what Bullet's solver is to leave alone, m: no contact is as deep.
inline constexpr double kHiddenThreshold = -1e18;

/// What steps implicitly is met where it will be (lookAhead), where its centre is this share of its radius in front of the plane there, now
/// and then.
inline constexpr double kAheadFraction = 0.5;

/// How much deeper than on the nearest ball something may stand between four, in their radii: a thing of their size by 0.6, a character's
/// capsule of six times that by 0.14.
inline constexpr double kHollow = 0.3;
/// What was fast is held back (tunneling_guard.h) near what stands until it moves less than this share of its radius in a step.
inline constexpr double kSlowFraction = 0.1;
/// What is squeezed so deep into what stands, in node radii, is held back too, however slow.
inline constexpr btScalar kDeepFraction = btScalar( 0.6 );
/// What holds fast nodes back (tunneling_guard.h). A node's centre is kept this share of its radius away from what stands ...
inline constexpr double kGuardFraction = 0.25;
/// ... as far as it is not nearer yet; less than this share through a barrier is rounding.
inline constexpr double kGuardSlack = 1e-6;
/// A node that was turned is looked at again, this often; then it stays where it is.
inline constexpr int kGuardRounds = 4;
/// Sweeps over the barriers of one node.
inline constexpr int kGuardSweeps = 16;

/// What a change of levels brought into the world inside something (penetration_allowance.h) comes out of it at so many radii of the body's
/// smallest node a second, when the body has been slower than so many for so many seconds.
inline constexpr double kAllowanceOut = 10.0, kAllowanceCalm = 2.0, kAllowanceCalmFor = 0.25;
/// A faster body's nodes that hold more than this share of what it moves with are not split for what they touch.
inline constexpr double kSplitEnergy = 5e-4;

/// Self-collision. Two ways out of the material (unit vectors) that differ by less than this leave open which side is which.
inline constexpr double kFacing = 0.5;
/// A way out of the material that is shorter than this before it is normalised is rounding: as much lies on one side as on the other.
inline constexpr float kNoSide = 1e-3f;
/// How much further than they touch from pairs are noted that may come to touch, in radii of the largest node.
inline constexpr double kNearMargin = 0.5;
/// Nodes that are this many diameters apart at rest, with material between them, are not brought together by crushing it.
inline constexpr double kCrushedNodes = 8.0;

/// Soft bodies that step implicitly meet in spheres whose centres lie this share of the way to the node behind (round_surface.h): twice the
/// radius.
inline constexpr double kRoundFraction = 0.5;
/// Cosines of the angle between a face and where the other node is: from where on the sphere is more than the node's own, and is that
/// whole.
inline constexpr double kLeastLook = 0.5;
inline constexpr double kFullLook = 0.8;
/// And how much further apart than their own spheres touch two nodes may be whose round ones do, in their radii.
inline constexpr btScalar kRoundMargin = btScalar( 0.2 );

/// A body's surface as what touches it sees it (contact_surface.h). How far aside of a node's line its patch answers, cells: on a face cut
/// at 45 degrees the nodes behind it are 1.4 cells apart, and no point of it is further from all of them.
inline constexpr double kPatchHalfWidth = 0.9;
/// What is less curved than a sphere of this radius is flat, cells.
inline constexpr double kFlatRadius = 7.5;
/// Sine of the angle with its normal below which a patch touches flat things on the node's line, so that a face that rests on another has
/// contacts of few nodes; what has the same normal wherever it is asked, by this cosine, is flat.
inline constexpr double kFlatSine = 0.02, kSameNormal = 1.0 - 1e-9;
/// Cosine of the angle between a patch's normal and what it answers for; further aside the node's own sphere does.
inline constexpr double kLeastContactCosine = 0.5;
/// What is deeper in a patch than this, cells, is on the other side of a thin body, or so deep that nodes meet it one by one: the sphere is
/// tried at this share of its depth.
inline constexpr double kPatchDepth = 0.75, kPatchRetreat = 0.25;
/// Spheres tried; and how much further aside than it should be one may touch, as a share of the most.
inline constexpr int kPatchRounds = 4;
inline constexpr double kPatchTolerance = 0.05;
/// Two patches answer for each other where their nodes' lines are no further aside than this, cells of the larger kind; and how much
/// further apart than their own spheres touch nodes may be then, cells.
inline constexpr double kPatchPairDistance = 0.72, kPatchPairMargin = 0.25;
/// Where the cells around a node have less than this share of their volume at rest, it has no patch.
inline constexpr double kLeastPatchVolume = 0.2;
/// Nodes share a point where the steps to them span at least this share of the box of their lengths, and none has more of it than this.
inline constexpr double kLeastFractionVolume = 0.1, kMostFraction = 1.5;

/// A soft body turns as a whole about an axis about which its nodes have at least this share of what their cells would have by themselves.
inline constexpr double kRollingInertia = 0.1;

/// When a body may fall asleep (activation.cpp), by what a fall of its smallest node's radius would give it: its nodes' root mean square
/// velocity is below this share of that, 3 cm/s at cells of 0.1 m under 9.81 m/s^2 ...
inline constexpr double kSleepFraction = 0.03;
/// ... or below what a fall of kContactSlop would give it, and no node has gone further than so many radii since: what is pressed to and
/// fro at rest goes nowhere.
inline constexpr double kRestDisplacement = 0.1;

/// Where contacts of one island brought energy in, their impulses are made smaller, to this share at most: half of it still stops what
/// came.
inline constexpr double kLeastBounce = 0.5;
/// How finely the share of a bounce is found that brings nothing in.
inline constexpr double kLeastBounceStep = 1e-4;

/// What an implicit block's contacts bring in, as a share of all they move, is rounding below this, and the end of its iteration.
inline constexpr double kBounceSlack = 1e-4;

// The implicit step's contacts (docs/design/implicit.md says how each was found).
/// A contact's stiffness in units of what its nodes resist with by themselves.
inline constexpr double kContactStiffness = 10.0;
/// Below this speed a contact that has just begun to rub counts as held, m/s; one that is held creeps by less with every substep.
inline constexpr double kSlipSpeed = 5e-3;

/// Friction by direction: where it is scaled by less than this, a share, there is none.
inline constexpr double kLeastDirection = 1e-3;

/// Impulses that together are off by less than this share of all that presses are good enough.
inline constexpr double kImpulseError = 0.01;
/// With contacts the iteration ends where impulses are right to kImpulseError, but never need go on below the first of these speeds, m/s,
/// and never ends above the second.
inline constexpr double kContactGradientSpeed = 1e-5, kMostContactGradientSpeed = 3e-4;
/// Share of what is off (twice an energy) that a pass leaves before it is asked whether others follow: a tenth of the speeds; and of one
/// that may be the last by their number. At a hundredth there too what is light and all but rigid slides a fifth too slowly.
inline constexpr double kPassFraction = 1e-2, kLatePassFraction = 1e-3;
/// Solutions of a substep: contacts that press or slide otherwise than they were taken for make it one more.
/// With eight a tower of eight cubes sleeps a second sooner, as impacts are not ended early; but a pile takes nearly twice as long.
inline constexpr int kMostPasses = 4;
/// Where contacts would pull by then, or rub by so many times their limits, which can bring energy in, it goes on: most impacts are settled
/// in 8 passes, the hardest of 600 in 49.
inline constexpr int kMostHardPasses = 60;
inline constexpr double kLargestFrictionTorque = 2.0;
/// What each body is rubbed by must be right to this share of the limits of all its contacts, or a pass more is made, up to so many in all:
/// beside what rubs a heavy body on the floor, a light one's friction on it is nothing.
inline constexpr double kPartError = 0.1;
/// And after so many, limits of friction follow wild passes too.
inline constexpr int kMostFairPasses = 8;
/// Rigid bodies that take part in a block, where its island has more: the coarse system's factor grows with their number to a power between
/// 2 and 3.
inline constexpr int kMostBlockRigid = 96;
/// Halvings of the way to a solution: as many as a float has bits.
inline constexpr int kLineSearchHalvings = 24;
/// Nodes that have come too deep are pushed out at most this fast, m/s.
inline constexpr double kPushOutSpeed = 2.0;
/// Contacts of one node with what stands ask for what they can all have: looked for in so many sweeps, to this share of the most that any
/// of them lacks.
inline constexpr int kAgreeSweeps = 32;
inline constexpr double kAgreedFraction = 1e-3;
/// It must not be more than so many times that, or they are taken to be at odds ...
inline constexpr double kLargestExitDistance = 4.0;
/// ... and what lies between is looked for with this weight on staying with what stands, beside 1 of each contact.
inline constexpr double kAgreeRest = 0.01;
/// Two things that are put into one another go apart by so much, m/s: stiff ones, which spring back, twice as fast. Bullet's own bodies, of
/// which nothing springs, take what their depth asks for.
inline constexpr double kPartingSpeed = 1.0;
/// Deeper than this share of a radius is put into one another, if it is more than they move by; Bullet's usual share (m_erp2) of a depth is
/// pushed out in a step.
inline constexpr double kPartedDepth = 0.25, kUsualPush = 0.2;
/// Substeps in which nothing is held back after one in which it went apart: that one, and the next.
inline constexpr int kPartingPhases = 2;
/// Directions and ways that differ by less than this share are the same.
inline constexpr double kParallel = 1e-3;
/// Share in which a rigid body's impulses from the rest of the world (joints, rigid contacts) follow those of the last substep.
inline constexpr double kOutsideFraction = 0.25;

/// What is under a character carries it where the normal is as near to the vertical as this cosine: 60 degrees.
inline constexpr double kCarrySlope = 0.5;

// Elasticity::Automatic (implicit_choice.cpp).
/// Time over which what nodes carry is averaged, s: several times a bounce, for that is no load.
inline constexpr double kLoadTime = 0.5;
/// A body that has taken the implicit step keeps it until its loads are down to this share of what asked for it, and stay so for this long,
/// s: the time that Bullet waits before it puts a body to sleep.
inline constexpr double kLeaveFraction = 0.5;
inline constexpr double kCalmTime = 2.0;

/// Soft substeps: default, largest, and the default bound up to which stiff materials raise them by themselves.
inline constexpr int kDefaultSubsteps = 4;
inline constexpr int kLargestSubsteps = 64;
inline constexpr int kDefaultMaxSubsteps = 16;

/// Room in the broadphase around what an object may sweep in all its soft substeps, as a share of the swept box's diagonal: contacts change
/// velocities.
inline constexpr btScalar kSweepMargin = btScalar( 0.02 );
/// A world with soft bodies steps by no more than this at once, s: longer steps are cut short. A frame that took longer was a halt of the
/// program.
inline constexpr btScalar kLongestStep = btScalar( 1 );
/// Frames that stepSimulation may be asked to catch up with at once; what is beyond is dropped before it overflows Bullet's count of steps.
inline constexpr btScalar kMostFrames = btScalar( 1e6 );

/// The game step that substeps are counted for, s. Longer steps get more.
inline constexpr btScalar kNominalStep = btScalar( 1 ) / 60;

/// How far a transform's axes may be from unit length and right angles, as a share, to be taken for a rotation: products of many float
/// rotations stay within a tenth of it, and nobody scales by so little.
inline constexpr double kMostScale = 1e-2;
/// Room about a contact in which the triangle is looked for that it lies on, as a share of the mesh's box: rounding.
inline constexpr btScalar kTriangleMargin = btScalar( 1e-5 );
/// A node is driven in one step by at most so many of its body's sizes: further off what is left of the body's shape is a thread.
inline constexpr double kFarthestDrive = 100.0;
/// Bodies are put no further from the origin than this along any axis, m: a float's last bit is 64 m there.
inline constexpr btScalar kFarthestPosition = btScalar( 1e9 );

} // namespace pliant
