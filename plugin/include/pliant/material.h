#pragma once

// The material of a body and the method that simulates it. Every value has a unit, a range and a working default.

#include "pliant/export.h"
#include "pliant/result.h"

namespace pliant {

/// How a body's nodes are grouped into regions, the sets of nodes that shape matching fits as one.
enum class Method : int
{
	Lattice,       ///< one region per node on the uniform lattice (Rivers and James 2007). Default.
	SingleCluster, ///< one region for the whole body (Müller et al. 2005)
	Clusters       ///< several overlapping box-shaped regions (Müller et al. 2005, section 4.4)
};

/// Deformation modes of a cluster (Müller et al. 2005, sections 3.3, 4.2, 4.3). Used by Method::SingleCluster and Method::Clusters.
enum class ClusterMode : int
{
	Rigid,    ///< rotation and translation only
	Linear,   ///< all affine deformations, as far as `beta` allows. Default.
	Quadratic ///< bending and twisting too
};

/// How masses enter region sums and goals.
enum class Weights : int
{
	Conserving, ///< a node's mass is divided among the regions that cover it; goals are the exact transpose. Conserves momentum. Default.
	Literal     ///< full mass in sums, goals averaged by region mass (Steinemann et al. 2008, eq. 6-8). Loses momentum; for comparison.
};

/// The matrix from which a region's rotation is extracted.
enum class RotationFrom : int
{
	Apq, ///< the moment matrix A_pq: free of torque with conserving weights. Default.
	F    ///< the deformation gradient A_pq A_qq^+ (Ohta et al. 2009, eq. 1); for comparison
};

/// How stiffness is specified.
enum class Stiffness : int
{
	YoungsModulus, ///< by Material::youngsModulus; alpha follows from it and the step. Default.
	RawAlpha       ///< by Material::alpha, regardless of the step (the papers' parameter; not a material constant)
};

/// How elasticity is integrated in time.
enum class Elasticity : int
{
	Explicit, ///< the papers' step: cheap; stiff materials and heavy loads need substeps
	Implicit, ///< any stiffness and any load at the game step, at a higher cost per step (docs/design/implicit.md). Needs Method::Lattice,
			  ///< Weights::Conserving, RotationFrom::Apq and farLevels 0.
	Automatic ///< Implicit where the explicit step cannot reach the stiffness or a heavy load rests on the body's island, else Explicit.
			  ///< Bodies that cannot step implicitly step explicitly; SoftBody::implicitStatus gives the reason. Default.
};

/// Settings of a material. `check` refuses values out of range (BadMaterial).
struct Material
{
	/// Density, kg/m^3, (0, 1e6].
	float density = 1000.0f;

	/// Young's modulus, Pa, finite. 0, the default: defaultYoungsModulus of the body, so that bodies of any size carry ten times their own
	/// mass; SoftBody::material returns the value, and fragments keep it. The explicit step reaches it up to a limit that grows with the
	/// number of substeps and with regionHalfWidth; beyond it the stiffest stable setting is used and the body is reported (StiffnessPlan,
	/// StepReport::unreachableStiffness). So are free bodies that neither break nor flow in the implicit step, beyond an alpha of 1e6, with
	/// levels of 3e4: floats do not resolve more. Not used by Method::SingleCluster, whose stiffness is `alpha`.
	float youngsModulus = 0.0f;

	/// Whether `youngsModulus` or `alpha` sets the stiffness.
	Stiffness stiffness = Stiffness::YoungsModulus;

	/// Fraction of the displacement to its goal that a node makes in a substep, (0, 1]. Used with Stiffness::RawAlpha and
	/// Method::SingleCluster. With RawAlpha alpha ( 1 + 3 volumeKeeping ) is at most 3.5. Ohta et al. 2009, eq. 3.
	float alpha = 1.0f;

	/// Blend of the goal from the rigid fit (0) to the best linear or quadratic one, [0, 0.95]; larger is softer. Ohta et al. 2009, eq. 5.
	float beta = 0.0f;

	/// Volume conservation, kappa, [0, 24.5]: a compressed body bulges, and a stretched one becomes thinner, with Poisson's ratio nu =
	/// kappa / ( 2 kappa + 1 ): 0.5 gives 0.25, 2 gives 0.4, 24.5 gives 0.49, at strains of any size. 0: nu = 0, at no cost. Young's
	/// modulus stays as set; the largest one that the explicit step reaches falls: its alpha is at most 3.5 / ( 1 + 3 kappa ).
	/// Method::Lattice only.
	float volumeKeeping = 0.0f;

	/// Plasticity: strain above which a region deforms permanently, [0, 10] (Müller et al. 2005, section 4.5; Steinemann et al. 2008, eq.
	/// 9-10). The strain is | S - 1 |, the root of the sum of squares of a region's principal elastic strains: 0.05 for a bar stretched by
	/// 5 %. Plastic flow conserves volume. 0: no plasticity, at no cost. Method::Lattice only.
	float yieldStrain = 0.0f;

	/// Rate at which the rest shape follows the elastic strain while that exceeds yieldStrain, 1/s, (0, 1e4].
	float plasticCreep = 10.0f;

	/// Largest plastic strain of a region's rest shape relative to the original one, in the measure of `yieldStrain`, (0, 2].
	float plasticLimit = 0.5f;

	/// Half-width w of a region, cells, 1 to 4: a region spans up to 2 w + 1 cells along each axis. Wider regions reach stiffer materials
	/// per substep and cost more.
	int regionHalfWidth = 1;

	/// Number of far levels, 0 to 3: shape matching also on blocks of 2, 4 and 8 cells per edge, so that a force travels farther in one
	/// substep (docs/design/step.md, "Far levels"; not in the papers). 1, 2 and 3 reach 3.9, 15.8 and 63.7 times the Young's modulus that
	/// regionHalfWidth 1 reaches with the same substep, for a fifth to a third more time. Only as many are active as `youngsModulus` needs;
	/// levels for which the body is less than 4 blocks long are left out. 0: none, at no cost. The added stiffness has Poisson's ratio 0
	/// and is hardly affected by `damping`. Needs Method::Lattice, Stiffness::YoungsModulus, yieldStrain 0 and no levels of detail.
	int farLevels = 0;

	/// Decay rate of velocities that deviate from the rigid motion of their region, 1/s, [0, 1000]. Affects the lowest modes of the body
	/// little; conserves momentum.
	float damping = 10.0f;

	/// Damping of slow vibrations, as a fraction of the critical damping of the body's slowest free vibration, [0, 1]; 0: none. Conserves
	/// momentum and does not affect flight or swinging of the body as a whole, nor rolling unless the body can break. In a body of several
	/// unconnected parts each part is damped by its own slowest vibration (Method::Lattice; other methods: not at all).
	float wobbleDamping = 0.15f;

	/// How elasticity is integrated in time.
	Elasticity elasticity = Elasticity::Automatic;

	/// Numerical damping of the implicit step, [0, 1]: 1 stops vibrations within a few periods at a step of 1/60 s and is the most robust;
	/// 0 leaves damping to `damping` and `wobbleDamping`. Rigid motion and momentum are not affected. Implicit step only. A body that lands
	/// on something takes the world's soft substeps, without numerical damping as far as they resolve the impact, until it is over: it
	/// rebounds by its own elasticity. So does a body that rolls. Below 1 a body takes them wherever they resolve its vibrations.
	float numericalDamping = 1.0f;

	/// A body whose strains and vibrations are below this is moved as one rigid body, [0, 0.1], until an impact, a load or a call of the
	/// game deforms it: for stiff bodies and the shards of brittle ones, which cost a fraction then. 0: never, at no cost. A body that can
	/// break deforms from 0.8 times the strain on at which its weakest link breaks; crushed, it takes its rest shape. Pinned ones are
	/// static. Bodies with moving pins, attachments, plastic flow or several parts always deform; pieces of SmallPieces::Rigid and of a
	/// single node never do.
	float rigidStrain = 0.0f;

	/// How nodes are grouped into regions. A build without Feature::Clusters takes Method::Lattice alone (BadArgument).
	Method method = Method::Lattice;
	/// Deformation modes of a cluster; used by Method::SingleCluster and Method::Clusters.
	ClusterMode clusterMode = ClusterMode::Linear;

	/// Edge length of a cluster's box, cells, 2 to 64, for Method::Clusters; neighbouring boxes overlap by half.
	int clusterEdge = 4;

	/// How masses enter region sums and goals.
	Weights weights = Weights::Conserving;
	/// The matrix from which a region's rotation is extracted.
	RotationFrom rotationFrom = RotationFrom::Apq;
};

/// Stiffness that varies in space (Steinemann et al. 2008, section 4.2 and Fig. 4). Method::Lattice only, else BadArgument.
struct StiffnessField
{
	/// Called once for each finest cell when a body is created. `point`: 3 floats, the centre of mass of the cell's material, mesh
	/// coordinates, m. Returns a factor on youngsModulus (or alpha) in (0, 1]; other values are refused (BadArgument). Null: 1 everywhere.
	float ( *fraction )( const float* point, void* context ) = nullptr;
	void* context = nullptr; ///< passed to `fraction`; used only during SoftBody::create
};

/// Returns Ok, or BadMaterial with a sentence about the first value that is out of its range (NaN included) or incompatible with another.
/// BadArgument where this build lacks a feature that the material needs.
PLIANT_API Status check( const Material& material );

/// Returns the Young's modulus of a body whose material sets none, Pa: E = 100 rho g L, g = 9.81 m/s^2. Its own weight compresses a cube of
/// edge L by half a per cent, ten times its mass on top by a tenth. `density`: kg/m^3; `length` L: longest edge of the rest shape's box, m;
/// both above 0 and finite, else 0 is returned. A cube of water's density and 1 m has that of soft rubber, 1e6 Pa.
[[nodiscard]] PLIANT_API float defaultYoungsModulus( float density, float length );

/// The stiffness that a material has at a given step and cell size.
struct StiffnessPlan
{
	float alpha = 1.0f;          ///< the alpha of the step, (0, 1]; unbounded with the implicit step
	float reachedModulus = 0.0f; ///< Young's modulus that is reached, Pa; below Material::youngsModulus when that is out of reach
	int substepsNeeded = 1;      ///< substeps per game step that would reach Material::youngsModulus with the given width and far levels
	bool reachable = true;       ///< whether the given number of substeps reaches Material::youngsModulus
};

/// Computes alpha = 3 E h^2 / ( rho d^2 w ( w + 1 ) ), limited to 1; far levels contribute the rest (docs/design/step.md). h: one substep,
/// s; d: `cellSize`, m. For clusters of edge e, ( e^2 - 1 ) / 4 replaces w ( w + 1 ). `gameStep`: s; `substeps`: per game step. The
/// material must pass `check`, cellSize and gameStep be above 0 and substeps at least 1: an assertion; without assertions a plan that is
/// not reachable. Neither is that of a material whose youngsModulus is 0 and not yet that of a body.
[[nodiscard]] PLIANT_API StiffnessPlan planStiffness( const Material& material, float cellSize, float gameStep, int substeps );

} // namespace pliant
