#pragma once

// Constants of the coupling to Bullet, each with its unit and reason.

#include <LinearMath/btScalar.h>

#include <cstddef>
#include <numbers>

namespace pliant {

/// Default of SoftBody::setSurfaceTolerance, cells: a tenth of a pixel where a cell covers ten.
inline constexpr double kSurfaceTolerance = 1e-2;

/// Classifying all nodes takes longer than skinning the vertices again where a body has at least so many nodes and fewer vertices than this
/// per node: a node takes some 40 ns, a vertex 30.
inline constexpr int kManySkinnedNodes = 1024, kFewVerticesPerNode = 4;

/// Sphere radii are rounded to steps of 2^(1/16), so that nodes can share shapes.
inline constexpr double kRadiusStepsPerOctave = 16.0;

/// Contacts are created at least this far before touch, in node radii, so that a resting contact does not flicker.
inline constexpr btScalar kContactSlop = btScalar( 0.04 );
/// Largest distance at which a node that pressed an object in the last substep keeps its contact, in node radii.
inline constexpr double kMostPressedReach = 0.5;
/// Largest depth to which nodes of rolling bodies land, in node radii and in distances from the surface before the step. With the second
/// at 1 default balls of .4, .1 and .05 m keep 94, 94 and 91 % of a rigid one's velocity, at 2 to 3 95, 96 and 94 %.
inline constexpr double kLandingDepth = 0.13, kLandingGaps = 2.0;

/// Spheres that miss a plane or box by more than this fraction of a radius are rejected early: rounding in a world 10 000 km wide.
inline constexpr double kFarSlack = 1e-6;

/// Bound of the rounding error of a height over a plane in single precision, over the sum of the coordinates that it is computed from.
inline constexpr double kBlockRounding = 2e-6;

/// Supports of a hull by which a sphere may be found to be clear of it before GJK: each costs a tenth of what GJK takes.
inline constexpr int kHullProbes = 4;

/// From a cube's centre to its corner, in half edges, plus a tenth: splitting a node of level 2 to the finest level takes two substeps.
inline constexpr double kCornerReach = 1.1 * std::numbers::sqrt3;

/// A node that moves by more than this fraction of its radius in a step is swept; a slower one is tested by its nearest point.
inline constexpr double kFastFraction = 0.5;

/// Limit of the iterations of conservative advancement: most sweeps take two, grazing ones a few more.
inline constexpr int kMostAdvances = 32;

/// Contact processing threshold that hides a manifold from Bullet's solver, m: no contact is as deep.
inline constexpr double kHiddenThreshold = -1e18;

/// Least distance of an implicit node's centre, now and then, from the plane at the step's end (lookAhead), in its radii.
inline constexpr double kAheadFraction = 0.5;

/// How much deeper than at the nearest sphere an object may penetrate between four spheres, in their radii: an object of their size by 0.6,
/// a character's capsule of six times that size by 0.14.
inline constexpr double kHollowDepth = 0.3;
/// A fast body stays guarded (tunneling_guard.h) near static objects until it moves by less than this fraction of its radius in a step.
inline constexpr double kSlowFraction = 0.1;
/// A node that penetrates a static object this deep, in node radii, is guarded too, however slow it is.
inline constexpr btScalar kDeepFraction = btScalar( 0.6 );
/// The tunneling guard keeps a node's centre this fraction of its radius, or its present distance if smaller, away from static objects.
inline constexpr double kGuardFraction = 0.25;
/// A violation of a barrier below this fraction of the radius is rounding error.
inline constexpr double kGuardSlack = 1e-6;
/// Rounds of the tunneling guard: a corrected node is tested again; after the last round it stays where it is.
inline constexpr int kGuardRounds = 4;
/// Gauss-Seidel sweeps over the barriers of one node.
inline constexpr int kGuardSweeps = 16;

/// A penetration that a change of levels caused (penetration_allowance.h) is removed at the first of these velocities, radii of the body's
/// smallest node per second, once the body has stayed slower than the second of them for the third, s.
inline constexpr double kAllowanceOut = 1.0, kAllowanceCalm = 2.0, kAllowanceCalmFor = 0.25;
/// Nodes of a faster body that hold more than this fraction of its kinetic energy are not split where they touch something.
inline constexpr double kSplitEnergy = 5e-4;

/// Self-collision. Two outward unit vectors that differ by less than this do not determine the sides.
inline constexpr double kLeastFacing = 0.5;
/// A sum of outward vectors shorter than this is rounding error: the material continues equally in all directions.
inline constexpr float kLeastOutward = 1e-3f;
/// Margin of the list of pairs of nodes that may touch, in radii of the largest node.
inline constexpr double kNearMargin = 0.5;
/// Nodes that are this many diameters apart at rest, with material between them, cannot be brought into contact by crushing it.
inline constexpr double kCrushedNodes = 8.0;

/// Soft bodies touch in spheres centred at this fraction of the distance to the node behind (round_surface.h): twice the radius.
inline constexpr double kRoundFraction = 0.5;
/// Cosines between a face and the direction to the other node at which the sphere begins to grow, and has its full size.
inline constexpr double kLeastRoundCosine = 0.5;
inline constexpr double kFullRoundCosine = 0.8;
/// Largest gap between the own spheres of two nodes whose round spheres touch, in their radii.
inline constexpr btScalar kRoundMargin = btScalar( 0.2 );

/// Contact surface of a body (contact_surface.h). Half width of a node's patch, cells: on a face cut at 45 degrees the nodes behind it are
/// 1.4 cells apart, and no point of it is farther from all of them.
inline constexpr double kPatchHalfWidth = 0.9;
/// A surface with a larger radius of curvature counts as flat, cells.
inline constexpr double kFlatRadius = 7.5;
/// One with a larger radius than this, cells, is a plane: just below kMaxPatchRadius.
inline constexpr double kPlaneRadius = 60.0;
/// A node whose distance from the centre of a patch's sphere is below this fraction of its radius has the normal of the patch itself.
inline constexpr double kLeastCentreDistance = 0.01;
/// An obstacle's point nearest to a plane is sought from so far behind it, cells: from farther all nodes around a slightly tilted box find
/// its lowest edge, and none supports the others; from nearer they miss what is lowest between them, here by .01 cells at most.
inline constexpr double kPlaneDepth = 8.0;
/// Half width of a node's plane for objects that many nodes carry, cells: where the surface is bent, wider ones stick out of it and push
/// out what is above their neighbours.
inline constexpr double kPlaneHalfWidth = 0.6;
/// The same for small objects other than spheres, which the nodes around one above a node must support too: from the depth all nodes around
/// a box that is tilted by up to a quarter of a radian find their own corner of it, where a single one would tip it to and fro.
inline constexpr double kSmallPlaneDepth = 4.0, kSmallPlaneHalfWidth = 1.2;
/// Patches touch at most this far to the side of their nodes, cells: kSmallPlaneHalfWidth with its tolerance.
inline constexpr double kWidestPatch = 1.3;
/// Sine of the angle to its normal below which a patch touches a flat obstacle on the node's own line, so that contacts of resting faces
/// involve few nodes. An obstacle is flat where its normals at two points agree by the cosine.
inline constexpr double kFlatSine = 0.02, kSameNormal = 1.0 - 1e-9;
/// Least cosine of the angle between a patch's normal and the contact normal; beyond it the node's own sphere is used.
inline constexpr double kLeastContactCosine = 0.5;
/// A penetration of a patch deeper than this, cells, belongs to the other side of a thin body, or is so deep that nodes are tested one by
/// one: the sphere's centre is then moved to this fraction of its depth,
/// and to so many cells at first.
inline constexpr double kPatchDepth = 1.25, kPatchRetreat = 0.25, kFirstRetreat = 2.0;
/// Limit of spheres tried per patch, and tolerance of the lateral offset of the touching point, as a fraction of its bound.
inline constexpr int kPatchRounds = 4;
inline constexpr double kPatchTolerance = 0.05;
/// Two patches are tested against each other where their nodes' lines are no farther apart than this, cells of the larger kind; and
/// allowance of the gap between their own spheres.
inline constexpr double kPatchPairDistance = 0.72, kPatchPairMargin = 0.03;
/// Two nodes are of about the same size where the ratio of their sizes exceeds this.
inline constexpr double kAlikeSizes = 0.55;
/// A node has no patch where the cells around it are compressed below this fraction of their rest volume.
inline constexpr double kLeastPatchVolume = 0.2;
/// Least volume of the parallelepiped of the offsets to the nodes that share a point, as a fraction of the box of their lengths, and
/// largest weight of a node.
inline constexpr double kLeastFractionVolume = 0.1, kMostFraction = 1.5;

/// A soft body rotates about an axis where its moment of inertia is at least this fraction of the sum of its cells' own.
inline constexpr double kRollingInertia = 0.1;

/// Deactivation (activation.cpp), relative to the velocity gained in a fall over the smallest node's radius: the root mean square velocity
/// of the nodes is below this fraction of it, 3 cm/s at cells of 0.1 m under 9.81 m/s^2 ...
inline constexpr double kSleepFraction = 0.03;
/// ... or below that of a fall over kContactSlop, while no node moves by more than this many radii: a body pressed to and fro at rest.
inline constexpr double kRestDisplacement = 0.1;
/// The same for pinned bodies that may be rigid, at any velocity: they swing in place for a long time.
inline constexpr double kHeldDisplacement = 0.5;

/// A body in its rigid state may sleep if its angular velocity is below Bullet's threshold, or if its farthest point is slower than this,
/// m/s: a shard of 10 cm that is pressed to and fro in a heap rotates by 1 to 2 rad/s from time to time.
inline constexpr double kSleepTurn = 0.15;
/// Time at rest that a small motion of such a body uses up, per duration of the motion: shards in a heap move for a tenth of the time.
inline constexpr btScalar kRestLoss = btScalar( 2 );
/// Largest time at rest beyond gDeactivationTime, s: what moves for longer than half of it is awake for a while.
inline constexpr btScalar kMostRest = btScalar( 0.5 );
/// Rest that such a body still needs when its heap has woken it: at least this, s, and this multiple of the time in which a body that
/// falls is too fast to sleep.
inline constexpr btScalar kWokenRest = btScalar( 0.5 ), kWokenFalls = btScalar( 2 );

/// Impulses of an island's contacts that add energy are scaled down at most to this: half an impulse still stops the approach.
inline constexpr double kLeastBounce = 0.5;
/// Resolution of the bisection for the fraction of a bounce that adds no energy.
inline constexpr double kLeastBounceStep = 1e-4;

/// Impulses of a bounce are raised for the body behind the contacts' nodes by at most this fraction, and at most so far that they return
/// this share of the energy that the contacts absorb.
inline constexpr double kMostBounceRaise = 0.25;
inline constexpr double kBounceShare = 0.5;

/// An explicit body that is simulated with less than this fraction of its Young's modulus rebounds by restitution, others by their
/// elasticity. There is no mean of the two: a body that is stopped half-way rebounds by neither.
inline constexpr float kRestitutionReach = 0.5f;

/// Energy added by a block's contacts, relative to all they transfer, that counts as rounding error; ends that iteration too.
inline constexpr double kBounceSlack = 1e-4;

// The implicit step's contacts (docs/design/implicit.md says how each was found).
/// A contact's stiffness in units of its nodes' own resistance.
inline constexpr double kContactStiffness = 10.0;
/// Impulse on a rigid body over this velocity, m/s, is the mass that its contact is as stiff as, if that is more than its own: the weight
/// of an object at rest gives its own mass at 1/60 s.
inline constexpr double kLoadVelocity = 0.16;
/// Below this velocity a contact that has just begun to slide counts as sticking, m/s; a sticking contact creeps by less in every substep.
inline constexpr double kSlipSpeed = 5e-3;

/// Anisotropic friction: directions scaled by less than this fraction have no friction.
inline constexpr double kLeastDirection = 1e-3;

/// Impulses are accurate enough where their summed errors are below this fraction of all normal impulses and of all friction limits.
inline constexpr double kImpulseError = 0.01;
/// With contacts the iteration ends where impulses are accurate to kImpulseError, but it never has to continue below the first of these
/// velocities, m/s, and never ends above the second.
inline constexpr double kContactGradientSpeed = 1e-5, kMostContactGradientSpeed = 3e-4;
/// Fraction of the residual (twice an energy) that a pass may leave: while further passes are to follow, a tenth in velocity; and from the
/// pass on that may be the last. With a hundredth there too, light and almost rigid bodies slide a fifth too slowly.
inline constexpr double kPassFraction = 1e-2, kLatePassFraction = 1e-3;
/// Passes of a substep: a contact that presses or slides otherwise than assumed requires another. With eight a tower of eight cubes sleeps
/// a second sooner, as impacts are not ended early, but a pile takes nearly twice as long.
inline constexpr int kMostPasses = 4;
/// Sweeps over the contacts of a block of explicit bodies, before passes continue from their result: of the contacts of a pile that comes
/// to rest none needs more, while it is thrown together half of them do. From the sixth sweep on changes are enlarged by the factor: a node
/// between two bodies needs 60 sweeps otherwise. Where the ratio of the last two of kTrialSweeps says that kMostSweeps will not be enough,
/// as between a heavy ball and the thin body that it breaks, passes begin then.
inline constexpr int kMostSweeps = 40, kPlainSweeps = 5, kTrialSweeps = 16;
inline constexpr double kSweepRelaxation = 1.4;
/// Limit of passes where contacts would still pull, or rub by kLargestFrictionTorque times their limits, which can add energy: most impacts
/// settle in 8 passes, the hardest of 600 in 49.
inline constexpr int kMostHardPasses = 60;
inline constexpr double kLargestFrictionTorque = 2.0;
/// The same where nodes would keep this fraction of the contacts' impulses as momentum into an obstacle.
inline constexpr double kLargestMomentumLeft = 0.1;
/// The friction on each body must be accurate to this fraction of the limits of all its contacts, or another pass follows, up to
/// kMostFairPasses: compared with the friction of a heavy body on the floor, that of a light body on it is negligible.
inline constexpr double kPartError = 0.1;
/// Passes after which friction limits follow passes far from convergence too.
inline constexpr int kMostFairPasses = 8;
/// Of an island with more rigid bodies than the first number only those take part in the block that touch a soft body or rest on one, the
/// latter up to the second: the cost of the coarse system's factorisation grows with a power between 2 and 3 of their number.
inline constexpr int kWholeBlockRigid = 24, kMostBlockRigid = 96;
/// In a block of more connected parts of soft bodies than the first number those with a G below the second, of bodies of fewer nodes than
/// the third, have no affine motions in the coarse system: these save hardly a product there, and the factor takes half of the time that a
/// cube of 2 197 cells breaks into a hundred pieces in (G about 1). Larger bodies, and a few, keep theirs, since whole bodies would be
/// tilted by the error that remains.
inline constexpr std::size_t kManyParts = 16;
inline constexpr float kLeastWholeStiffness = 4.0f;
inline constexpr int kLeastWholeNodes = 64;
/// A body supports another if the contact's normal has at least this component upwards.
inline constexpr double kSupportSlope = 0.5;
/// Halvings of the line search: as many as a float has bits.
inline constexpr int kLineSearchHalvings = 24;
/// Nodes that penetrate too deep are pushed out at most at this velocity, m/s.
inline constexpr double kPushOutSpeed = 2.0;
/// Conflicting contacts of one node with static objects: limit of the sweeps that seek a velocity which satisfies them all, and tolerance
/// as a fraction of the largest velocity that any of them lacks.
inline constexpr int kAgreeSweeps = 32;
inline constexpr double kAgreedFraction = 1e-3;
/// Contacts conflict where the velocity found exceeds this many times the largest lack ...
inline constexpr double kLargestExitDistance = 4.0;
/// ... and the compromise weights the velocity of the static objects by this, compared with 1 for each contact.
inline constexpr double kAgreeRest = 0.01;
/// A contact that violates its target by more than this, m/s, and whose violation changes by less than this fraction of it in a substep is
/// stuck. Resting contacts violate theirs by less than a tenth of a millimetre per second, and impacts change.
inline constexpr double kConflictViolation = 5e-3, kConflictChange = 1e-2;
/// The fraction by which the impulse of a stuck contact decays in each substep.
inline constexpr double kConflictDecay = 0.1;
/// Least cosine between a normal and an axis for the contact to count as along it; every direction exceeds it for some axis.
inline constexpr double kSqueezeCosine = 0.5;
/// Velocity at which two objects that were placed inside one another separate, m/s; stiff ones, which spring back, separate twice as fast.
/// Bullet's own bodies, which do not spring, move as their depth requires.
inline constexpr double kPartingSpeed = 1.0;
/// A penetration deeper than this fraction of a radius, and deeper than the motion of a step, counts as placed inside one another;
/// kUsualPush is Bullet's default fraction of a depth that is corrected in a step (m_erp2).
inline constexpr double kPartedDepth = 0.25, kUsualPush = 0.2;
/// Substeps without the tunneling guard after a separation: the current one and the next.
inline constexpr int kPartingPhases = 2;
/// Directions and lengths that differ by less than this fraction are equal.
inline constexpr double kParallel = 1e-3;
/// Relaxation factor, per substep, of the impulses on a rigid body from the rest of the world (joints, rigid contacts).
inline constexpr double kOutsideFraction = 0.25;

/// A surface carries a character where the cosine between its normal and the vertical is at least this: 60 degrees.
inline constexpr double kCarrySlope = 0.5;

// Elasticity::Automatic (implicit_choice.cpp).
/// Averaging time of the nodes' load, s: several bounce periods, since a bounce is no load.
inline constexpr double kLoadTime = 0.5;
/// A body that steps implicitly continues to until its load has stayed below this fraction of the switching load for kCalmTime, s: the time
/// that Bullet waits before it deactivates a body.
inline constexpr double kLeaveFraction = 0.5;
inline constexpr double kCalmTime = 2.0;
/// A body takes the implicit step where its substeps would cost rigid bodies more than this number of steps of one body in a game step:
/// about a millisecond in a heap.
inline constexpr int kMostRigidSubsteps = 100;

/// Soft substeps: default, maximum, and default bound up to which stiff materials raise them automatically.
inline constexpr int kDefaultSubsteps = 4;
inline constexpr int kLargestSubsteps = 64;
inline constexpr int kDefaultMaxSubsteps = 16;

/// Margin of an object's swept box in the broadphase, as a fraction of its diagonal: contacts change velocities.
inline constexpr btScalar kSweepMargin = btScalar( 0.02 );
/// Longest step of a world with soft bodies, s; longer ones are shortened. A longer frame means that the program was halted.
inline constexpr btScalar kLongestStep = btScalar( 1 );
/// Frames that stepSimulation catches up with at once; further ones are dropped before Bullet's step count overflows.
inline constexpr btScalar kMostFrames = btScalar( 1e6 );

/// Game step that substep counts refer to, s. Longer steps get more substeps.
inline constexpr btScalar kNominalStep = btScalar( 1 ) / 60;

/// How far a transform's axes may deviate from unit length and right angles, as a fraction, to count as a rotation: products of many float
/// rotations stay within a tenth of it, and no realistic scaling is smaller.
inline constexpr double kMostScale = 1e-2;
/// Margin around a contact within which its triangle is sought, as a fraction of the mesh's box: rounding error.
inline constexpr btScalar kTriangleMargin = btScalar( 1e-5 );
/// A node is driven in one step by at most this many sizes of its body: beyond that the rest of the body would be stretched to a thread.
/// Points of attachments are no further from it.
inline constexpr double kFarthestDrive = 100.0;
/// Bodies are placed no farther from the origin than this along any axis, m: a float's last bit is 64 m there.
inline constexpr btScalar kFarthestPosition = btScalar( 1e9 );

// --- Links of multibodies ---

/// A link whose mobility is less than this fraction of that of a free body of its mass is held by its joints or its base.
inline constexpr double kLeastLinkMobility = 1e-6;
/// Directions in which joints hold a link have this fraction of the mobility of the free link: an exactly locked axis has no mass matrix.
inline constexpr double kLockedLinkMobility = 1e-3;

/// The same for a rigid body on Bullet's joints, which may be a hundred times lighter than what is attached to it.
inline constexpr double kLockedJointMobility = 1e-4;
/// Largest number of rigid bodies that joints connect with one that is attached or hit: their mobility is a dense matrix. The bodies of
/// larger groups count as bodies without joints.
inline constexpr std::size_t kMostJoined = 32;
/// A kinematic body turns as its angular velocity says where less than this fraction of its pins' mean square displacement differs.
inline constexpr double kTurnedOtherwise = 0.01;
/// A contact hits a body on joints that approaches by this fraction of its radius of gyration in the substep.
inline constexpr double kHitTravel = 0.05;
/// Relative regularisation of the joints' equations, which are redundant for two hinges of one door.
inline constexpr double kJointRounding = 1e-6;
/// Rounds in which the rows of joints that are at their limits are found: stops and motors need two or three.
inline constexpr int kJointRounds = 8;

// --- Attachments ---

/// Fraction of the distance between the two points of an attachment that is to be closed within a substep. The full distance would
/// overshoot, since other forces pull on the points too.
inline constexpr double kAttachmentReturn = 0.5;

/// Stiffness k of an attachment of a body that steps explicitly, as a multiple of its nodes' mass: its points stay within F h^2 / ( r k )
/// of each other under a force F.
inline constexpr double kExplicitAttachmentStiffness = 1000.0;

/// A point nearer than this to a node's centre, in cells, moves with that node alone.
inline constexpr double kAttachedCentre = 1e-3;

/// A neighbour shares a point if at least this fraction of its offset is across those of the neighbours before it.
inline constexpr double kLeastAttachedSpan = 0.5;

/// Tags of islands are below the number of a world's objects plus that of the group's islands; a snapshot with higher ones is refused.
inline constexpr int kMostTags = 1 << 24;

/// Objects of a snapshot that are faster than this, m/s and rad/s, or pulled by more than this, N and N m, or whose axes are longer than
/// this, are refused: values computed from them stay finite.
inline constexpr btScalar kFastestStoredObject = btScalar( 1e6 ), kStrongestStored = btScalar( 1e15 ), kLargestStoredAxis = btScalar( 1.1 );

// --- Bodies that follow a pose ---

/// Largest gain of a node toward its target's velocity within a substep: the rest of the difference, 1e-5 of it, is beyond float's
/// precision in the solution of an implicit body.
inline constexpr double kMostPoseGain = 1e5;

/// Largest velocity at which a pose pulls a node, m/s.
inline constexpr double kMostPoseSpeed = 1e3;

inline constexpr float kMostPoseDamping = 10.0f;

// --- Frames ---

/// Smallest inertia of a frame's patch about any axis, as a fraction of the largest: nodes on a line define no rotation.
inline constexpr double kLeastFrameInertia = 1e-3;

/// Largest radius of a frame's patch, times the distance from its centre to the body's farthest node: a larger one includes no more nodes,
/// but makes the frame's sphere too large for Bullet's broadphase.
inline constexpr double kFarthestOfFrame = 2.0;

/// Smallest mobility that Bullet's solver sees, 1/kg and 1/(kg m^2): where all nodes of the patch are held.
inline constexpr double kLeastFrameMobility = 1e-6;

/// Fraction of the difference by which the force on a frame's patch follows that of its joints in a substep. What the joints' rows do not
/// say is learnt by it times the ratio of the exact mobility to the one that Bullet sees: faster learning than the joints' correction
/// drives vibrations.
inline constexpr double kFrameLearning = 0.25;

/// Position of the origin of a frame of a stiff implicit body between the patch and the body's centre of mass: impulses there rotate it
/// least, between the two because the patch deforms locally.
inline constexpr double kFrameInward = 0.75;

/// The response of a body to impulses on its frames is solved to this fraction of its energy. A bar of 3e9 Pa swings as a rigid one does;
/// with ten times as much it lags, and with a thousandth a body of 1 700 nodes costs a fifth more.
inline constexpr double kResponseFraction = 1e-5;
/// The response to an impact is solved to this fraction of its energy: the strain at the peak to 1 %.
inline constexpr double kPeakFraction = 1e-4;

/// The least fraction of a contact's approach that its impulse stops within the substep of an impact, where all of it is extrapolated from
/// that: what approaches on meets in the next one, at four fifths of the velocity or more. And the least approach of a contact that belongs
/// to the impact, over that of the fastest.
inline constexpr double kLeastStopped = 0.2;

/// The strain at the peak of an impact over that of an equilibrium of the same energy, since waves add to it: the median over falls on
/// edges, corners and ends of cubes, panes and bars in steps that resolve them.
inline constexpr double kImpactWaves = 1.3;
/// Numerical damping above which a step damps an impact that it would resolve.
inline constexpr float kMostResolvedDamping = 0.5f;

/// The least fraction of an impulse's energy that has to be left without its rigid motion: less is as well the error of its distribution.
inline constexpr double kLeastStrainingImpulse = 0.05;
/// The error of the block's solution: at most this fraction of the energy of the impulse on a body strains it.
inline constexpr double kSolutionError = 0.01;

/// Velocities of a body count as rigid where less than this fraction of their energy is left without the rigid motion.
inline constexpr double kLeastElastic = 1e-12;

/// Least eigenvalue of the energies of velocity fields, each of energy 1, that count as independent: those below are rounding.
inline constexpr double kLeastResponse = 1e-5;

/// Iterations of Bullet's solver for the joints of frames, for which a game has not set any: with Bullet's 10 a clamped bar settles 2 to 3
/// mm beside its place, with 40 a thousandth of that.
inline constexpr int kFrameIterations = 40;

/// The largest alpha of the implicit step of bodies that neither break nor flow. Rounding changes the operator by some 1e-7 alpha of the
/// masses, on levels, where regions are less regular, by more: dice of glass on the floor flew off, and at 1e5 two of eight stacks of
/// concrete boxes on two levels fell over.
inline constexpr float kMostImplicitAlpha = 1e6f, kMostLevelAlpha = 3e4f;

} // namespace pliant
