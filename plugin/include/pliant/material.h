#pragma once

// What a body is made of and which of the papers' methods moves it. Every value has a unit, a range and a default that works.

#include "pliant/export.h"
#include "pliant/result.h"

namespace pliant {

/// How a body's regions are laid over its nodes.
enum class Method : int
{
	Lattice,       ///< one region per node on the uniform lattice (Rivers and James 2007)
	SingleCluster, ///< one region for the whole body (Müller et al. 2005)
	Clusters       ///< several overlapping box-shaped regions (Müller et al. 2005, section 4.4)
};

/// Deformation modes of a cluster (Müller et al. 2005, sections 3.3, 4.2, 4.3). Used by SingleCluster and Clusters.
enum class ClusterMode : int
{
	Rigid,
	Linear,
	Quadratic
};

/// How masses enter region sums and goals.
enum class Weights : int
{
	Conserving, ///< a node's mass is shared among the regions that cover it; goals are the exact transpose. Keeps momentum.
	Literal     ///< plain mass in sums, goals averaged by region mass (Steinemann et al. 2008, eq. 6-8). Leaks momentum; for comparison.
};

/// Out of which matrix a region's rotation is taken.
enum class RotationFrom : int
{
	Apq, ///< the moment matrix: torque-free with conserving weights
	F    ///< the deformation gradient A_pq A_qq^+ (Ohta et al. 2009, eq. 1); for comparison
};

enum class Stiffness : int
{
	YoungsModulus, ///< alpha follows from `youngsModulus` and the step
	RawAlpha       ///< alpha is `alpha`, whatever the step (the papers' parameter; not a material constant)
};

/// How a body's elasticity moves it in time.
enum class Elasticity : int
{
	Explicit, ///< the papers' step: cheap; stiffness needs substeps, and heavy loads do too
	Implicit, ///< any stiffness and any load at the game's own step, for more time a step (docs/design/implicit.md). Method::Lattice only
	Automatic ///< implicit where the explicit step cannot reach the stiffness or a heavy load lies on the body's island, else explicit.
			  ///< What the implicit step cannot do (far levels, other methods) steps explicitly: SoftBody::implicitStatus tells why
};

struct Material
{
	/// kg per cubic metre. Above 0, at most 1e6.
	float density = 1000.0f;

	/// Young's modulus, Pa. Above 0. Poisson's ratio is 0. Reached up to a limit that grows with substeps and
	/// regionHalfWidth; what is out of reach is reported, and the stiffest stable setting is used instead.
	/// Not used by Method::SingleCluster, whose stiffness is `alpha`.
	float youngsModulus = 2.0e4f;

	Stiffness stiffness = Stiffness::YoungsModulus;

	/// Share of the way to the goal per substep, (0, 1]. Used with Stiffness::RawAlpha and Method::SingleCluster. Ohta et al. 2009, eq. 3.
	float alpha = 1.0f;

	/// Blend of the goal from rigid (0) to the best linear or quadratic fit, [0, 0.95]. Ohta et al. 2009, eq. 5. Larger is softer.
	float beta = 0.0f;

	/// Kept volume, kappa, [0, 2]: a pressed body bulges, with Poisson's ratio nu = kappa / (2 kappa + 1); 0: nu = 0, and nothing is paid.
	/// 0.5 gives nu 0.25, 1 gives 0.33, 2 gives 0.4. Young's modulus stays what it is set to; how much of it can be reached changes a
	/// little. Method::Lattice only.
	float volumeKeeping = 0.0f;

	/// Plasticity (Müller et al. 2005, section 4.5; Steinemann et al. 2008, eq. 9-10): what is strained beyond `yieldStrain` keeps part of
	/// it. The strain is | S - 1 |, the root of the sum of squares of a region's principal elastic strains: a bar pulled by 5 % counts
	/// 0.05. [0, 10]; 0: nothing flows, and nothing is paid or held. Volume is kept by what flows. Method::Lattice only.
	float yieldStrain = 0.0f;

	/// Rate at which the rest shape follows the elastic strain while that is beyond the yield strain, 1/s, (0, 1e4].
	float plasticCreep = 10.0f;

	/// Largest distance of a region's flowed rest shape from the first one, in the measure of `yieldStrain`, (0, 2].
	float plasticLimit = 0.5f;

	/// Half-width w of a region, in cells, 1 to 4. Wider reaches stiffer materials per substep and costs more.
	int regionHalfWidth = 1;

	/// Far levels, 0 to 3: matching on blocks of 2, 4 and 8 cells an edge too, so that a force reaches farther in one substep
	/// (docs/design/step.md, "Far levels"; beyond the papers). One, two, three reach 3.9, 15.8, 63.7 times the Young's modulus that
	/// regionHalfWidth 1 reaches at the same substep, for a fifth to a third more time. Only as many work as `youngsModulus` needs; 0:
	/// nothing is paid or held. A body does without levels that it is less than 4 blocks long for. Poisson's ratio of what they add is 0,
	/// and region damping feels little of it. Refused without Method::Lattice and Stiffness::YoungsModulus, with a yieldStrain, and for
	/// bodies with levels of detail.
	int farLevels = 0;

	/// Rate at which motion that is no rigid motion of a region dies, 1/s, [0, 1000].
	/// Lowest modes feel little of it; momentum is untouched.
	float damping = 10.0f;

	/// Damping of the slow wobble, as a share of critical damping of the body's slowest free vibration, [0, 1]. 0 lets it ring.
	/// Flight, rolling and swinging of the body as a whole, and its momentum, are untouched.
	/// A body whose cells fall into several unconnected parts is damped part by part, each by its own slowest vibration (Method::Lattice;
	/// others not at all).
	float wobbleDamping = 0.15f;

	Elasticity elasticity = Elasticity::Explicit;

	/// Damping that the implicit step brings along, [0, 1]: 1 calms a body within a few swings of a sixtieth of a second's step and is the
	/// sturdiest, 0 lets it ring as long as `damping` and `wobbleDamping` allow. Rigid motion and momentum are untouched. Of the implicit
	/// step only.
	float numericalDamping = 1.0f;

	Method method = Method::Lattice;
	ClusterMode clusterMode = ClusterMode::Linear;

	/// Edge of a cluster's box for Method::Clusters, in cells, 2 to 64; neighbours overlap by half.
	int clusterEdge = 4;

	Weights weights = Weights::Conserving;
	RotationFrom rotationFrom = RotationFrom::Apq;
};

/// Stiffness that varies in space (Steinemann et al. 2008, section 4.2 and Fig. 4): a share of the material's, asked once for each finest
/// cell when a body is made. Method::Lattice only.
struct StiffnessField
{
	/// `point`: 3 floats, the middle of the cell's material in the mesh's own coordinates, m. Returns a share of youngsModulus (or alpha)
	/// in (0, 1]; what lies outside is refused. Null: 1 everywhere, and nothing is kept.
	float ( *fraction )( const float* point, void* context ) = nullptr;
	void* context = nullptr;
};

/// The first thing wrong with a material, or Ok. Refuses NaN.
PLIANT_API Status check( const Material& material );

/// What a material asks of the step on a lattice of cells of edge `cellSize` (m).
struct StiffnessPlan
{
	float alpha = 1.0f;          ///< what the step will use, (0, 1]; with Elasticity::Implicit of any size
	float reachedModulus = 0.0f; ///< Pa; below `youngsModulus` when that is out of reach
	int substepsNeeded = 1;      ///< substeps per game step that would reach `youngsModulus` at this regionHalfWidth with these far levels
	bool reachable = true;
};

/// alpha = 3 E h^2 / (rho d^2 w (w + 1)), at most 1, what is left being asked of the far levels; `h` is one substep, s
/// (docs/design/step.md). Clusters of edge e: (e^2 - 1) / 4 for w (w + 1).
PLIANT_API StiffnessPlan planStiffness( const Material& material, float cellSize, float gameStep, int substeps );

} // namespace pliant
