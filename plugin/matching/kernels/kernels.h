#pragma once

// The hot loops of lattice shape matching behind plain function pointers, one table per instruction set. Every table gives the same bits:
// 16 virtual lanes, a fixed order of every sum, no fused or approximate operation.
//
// The arithmetic runs in the body's own rotating frame (rotation R_b, centre c_b) in units of cells:
//   u_i = R_b^T (x_i - c_b) / d - q_i,   q_i = rest position / d
// so that a rigid motion of the whole body leaves u = 0 and only deformation is summed, subtracted and rounded.

#include "matching/kernels/volume_limits.h"

#include <cstdint>

namespace pliant {

/// Floats of a record: the contribution of one node to its regions, or of one region to its nodes. 12 are used; 16 fill a cache line.
inline constexpr int kRecordFloats = 16;
inline constexpr int kRecordUsed = 12;

/// The same for the implicit step's rates: 6 are used.
inline constexpr int kRateFloats = 8;

/// Nodes processed together between two transpositions.
inline constexpr int kTile = 64;

/// Sums of the body frame pass: m x (3), m x q^T (9, row-major), m.
inline constexpr int kFrameSums = 13;

/// Sums over the nodes' changes y and motion: m y (3), m p x y (3), m p (3), m p p^T as xx, yy, zz, yz, xz, xy (6) in cells and
/// body frame; m v (3), m ( x - c_b ) x v (3) in metres and world axes.
inline constexpr int kImpulseSums = 21;

/// Everything a kernel reads and writes. Borrowed arrays, padded to whole lanes; names as in lattice_matcher.cpp.
struct MatchView
{
	int nodeCount = 0;

	// Nodes, component by component.
	const float* x[3] = {};
	float* v[3] = {};
	const float* x0[3] = {}; ///< rest position, m
	const float* mass = nullptr;
	const float* freedom = nullptr;
	const float* nodeWeight = nullptr;
	const float* inverseCover = nullptr;
	float* change[3] = {};   ///< u after nodeRecords; y after scatter. Cells, body frame
	float* residual[3] = {}; ///< goal - position of the last substep. Cells, body frame

	// Regions.
	const std::uint32_t* start = nullptr;
	const std::uint32_t* member = nullptr;
	bool addOwner = false; ///< the table lists only a region's other members (the lattice's links, w = 1)
	const float* inverseMass = nullptr;
	const float* centre[3] = {};
	const float* moment[6] = {};
	const float* inverseMoment[6] = {};  ///< null unless beta > 0 or rotations come from F
	const float* regionWeight = nullptr; ///< b_r; null when all are 1

	// Regions over several levels (adapt/regions/region_matrix.h); all null on a uniform lattice.
	const std::uint32_t* memberMass = nullptr;     ///< per entry of `member`: weight of a member in the region's sums. Null: 1
	const std::uint32_t* memberFraction = nullptr; ///< per entry of `member`: weight of the member's region in the node's goal. Null: 1
	const float* pull = nullptr;       ///< of each node: sum of fractions b_r ( 1 - eta_r ) / C, the factor of its own u. Null: 1
	const float* regionBeta = nullptr; ///< beta_r; null: `beta` for all
	const float* regionEta = nullptr;  ///< eta_r; null: 0
	const float* blend[9] = {};        ///< C = J^+ J_fine, row-major, where beta is a tensor 1 - C^T; null where it is a scalar
	const float* outOfPlane[6] = {};   ///< 1 - J J^+ of flat and thin regions: along these directions F equals R. Null: all are solid
	const float* plastic[9] = {};      ///< S_p - 1, row-major; `inverseMoment` is then that of the plastic rest shape
	float volumeFraction = 0.0f;       ///< kappa
	float mostVolumeResponse = kAnyVolumeResponse; ///< bound of the response of volume conservation relative to kappa, 3 at rest
	float* volumeGradient[9] = {};                 ///< out: b^1/2 dm / dx on rest positions, world axes, of volumeMatrix. Null: not wanted
	float* volumeSize = nullptr;                   ///< out, with volumeGradient: m
	float* strain = nullptr;                       ///< out: sum over the singular values s of F of ( s - 1 )^2, per region
	float* stretch = nullptr;                      ///< out, with strain: upper bound of the largest s - 1, per region
	float* quaternion[4] = {};                     ///< w, x, y, z: rotation relative to the body frame

	// Records: one line per node or region; on the grid one line per lattice position.
	float* nodeRecord = nullptr;
	float* regionRecord = nullptr;
	const std::uint32_t* slot = nullptr; ///< lattice position of a node; null when node i is record i
	int gridX = 0, gridY = 0, gridZ = 0; ///< 0 when the table is used instead of box sums
	int halfWidth = 1;

	// Far levels (coarse_to_fine.h); null and 0 without.
	const float* farRecord = nullptr;        ///< of each block of the finest far level: the goals of all far levels for its nodes
	const std::uint32_t* farBlock = nullptr; ///< of each node
	const float* farPull = nullptr;          ///< of each node, as `pull`
	float farDamping = 0.0f;                 ///< fraction of the region damping that applies to the far levels' residual

	// The body frame and the step.
	float frameRotation[9] = {}; ///< R_b, row-major
	float frameCentre[3] = {};   ///< c_b, m, relative to the origin
	float cellsPerMetre = 1.0f;
	float alpha = 1.0f;
	float dampingFraction = 0.0f; ///< k
	float bodyFraction = 0.0f;    ///< of the whole body's rigid fit in the goal
	float beta = 0.0f;
	bool rotationFromF = false;

	// Conversion of the change in `apply`, world axes: y_w = velocityPerCell R_b y - wobbleFraction v - shift - turn x (x - pivot).
	float velocityPerCell = 0.0f; ///< d / h
	float wobbleFraction = 0.0f;
	float shift[3] = {}; ///< m/s
	float turn[3] = {};  ///< rad/s
	float pivot[3] = {}; ///< m
};

/// Sums of the rate pass: m v (3), m p x v (3).
inline constexpr int kRateSums = 6;

/// Rates of a lattice that fills its grid, one row per component instead of records: box sums are rows shifted against each other
/// (kernel_boxes.h). Rows may be read up to `halfWidth` planes of the grid before their beginning and after their end; values there and in
/// padding are arbitrary.
struct FlatRows
{
	float* node[kRateSums] = {};   ///< null: records
	float* region[kRateSums] = {}; ///< node and region rows are each other's scratch
	const int* x = nullptr;        ///< grid coordinates of each node
	const int* y = nullptr;
};

/// Inputs of the implicit step's kernels besides the nodes, tables and records of MatchView (kernel_rates.h).
struct RateView
{
	const MatchView* match = nullptr;
	float* regionCentre[3] = {};           ///< c of each region, cells, relative to the frame's centre, world axes
	float* inverseInertia[6] = {};         ///< T^-1 of each region, as xx, yy, zz, yz, xz, xy
	const float* regionFraction = nullptr; ///< g_r; null: 1
	const float* pull = nullptr;           ///< of each node: sum of its regions' g_r / C; null: 1
	FlatRows flat;                         ///< of a lattice that fills its grid
	float volume = 0.0f;                   ///< resistance to a change of volume relative to `stiffness`
	const float* rate[3] = {};             ///< v
	float* result[3] = {};
	float stiffness = 0.0f;  ///< G
	float tautMoment = 0.0f; ///< regions whose second moment has grown by this factor resist rotation; 0: none
	/// Of the nodes from the rest shape in the body's frame, cells; null for soft bodies and those of several parts.
	const float* displacement[3] = {};
	float shift[3] = {}; ///< a rigid motion removed from v before summing
	float turn[3] = {};
};

/// Arrays of a substep's loops over a body's nodes before and after contacts (kernel_motion.h). Component by component, padded as above.
struct MotionView
{
	float* x[3] = {};               ///< m
	float* v[3] = {};               ///< m/s
	float* kept[3] = {};            ///< out: copy of the new positions
	const float* mass = nullptr;    ///< kg; 0 in padding
	const float* freedom = nullptr; ///< 0 in padding
};

/// Velocity range of the nodes and of rest (zero), m/s. `worst` is 0 while every number is finite, and NaN otherwise.
struct VelocityBounds
{
	float low[3] = {}, high[3] = {};
	float worst = 0.0f;
};

/// Sums over nodes: m, m x, m |v|^2; `worst` as above, for positions.
struct MotionSums
{
	double mass = 0.0;        ///< kg
	double moment[3] = {};    ///< kg m
	double squareSpeed = 0.0; ///< kg m^2/s^2
	float worst = 0.0f;
};

/// Sums of records over lists: to[i] = scale[i] ( sum of weight[k] from[k] over the list of i ) + base[ baseOf[i] ].
struct RecordSums
{
	const float* from = nullptr;
	const std::uint32_t* start = nullptr;
	const std::uint32_t* member = nullptr;
	const float* weight = nullptr; ///< of each record of `from`; null: 1
	const float* scale = nullptr;  ///< null: 1
	float factor = 1.0f;           ///< multiplies `scale`
	const float* base = nullptr;   ///< null: 0
	const std::uint32_t* baseOf = nullptr;
	float* sum = nullptr; ///< out: the unscaled sums; may be null
	float* to = nullptr;
};

/// Weight factor of a pinned node in the far levels' sums, so that a support is not dragged along by the body. Measured on supported bars
/// of 64 cells (docs/design/step.md): at 4 their ends yield by 9 %, from 64 on too few of the supported nodes pull.
inline constexpr float kPinnedWeight = 12.0f;

/// Range begins are multiples of 16; the end may be the padded count.
struct Kernels
{
	/// Adds the body frame's sums over the nodes of the range to `sums` (kFrameSums floats); lane sums are folded in a fixed tree.
	void ( *frameSums )( const MatchView&, int begin, int end, float* sums );
	/// Computes u, and each node's record a_i (u, u q^T).
	void ( *nodeRecords )( const MatchView&, int begin, int end );
	/// Replaces each record of the lattice plane z by its sum over 2w + 1 positions along x and y.
	void ( *boxPlane )( const MatchView&, float* records, int z );
	/// Sums records, fits rotations and writes each region's record b_r (L - 1, c - L c0). Returns the number of lanes whose fit did not
	/// converge; their indices are appended to `open`.
	int ( *fitRegions )( const MatchView&, int begin, int end, std::uint32_t* open );
	/// Writes the record of one region whose rotation was found elsewhere (quaternion already stored).
	void ( *finishRegion )( const MatchView&, int region );
	/// e = goal - position, y = (1 - s) alpha e - s u + k (e - e before), s the body fraction; adds the impulse sums of the range
	/// (kImpulseSums floats).
	void ( *scatter )( const MatchView&, int begin, int end, float* sums );
	/// v += freedom y_w
	void ( *apply )( const MatchView&, int begin, int end );
	/// The matrix whose rotation is fitted for one region, row-major: the same as in fitRegions.
	void ( *regionMatrix )( const MatchView&, int region, float* matrix );

	/// F of each region of the range from rest to the current shape, plastic flow included, 9 floats per region from `begin` on, row-major,
	/// in the body's frame; padding regions are skipped.
	void ( *deformations )( const MatchView&, int begin, int end, float* gradients );

	/// Lists must not be empty.
	void ( *sumRecords )( const RecordSums&, int begin, int end );

	// The implicit step (kernel_rates.h), in calling order; box sums run between writing and gathering records.
	void ( *inertiaRecords )( const RateView&, int begin, int end );
	bool ( *regionInertias )( const RateView&, int begin, int end );
	void ( *rateSums )( const RateView&, const float* const* velocity, int begin, int end, float* sums );
	void ( *rateRecords )( const RateView&, int begin, int end );
	/// As boxPlane, for the records of kRateFloats floats that rateRecords and rigidRates write.
	void ( *boxPlaneHalf )( const MatchView&, float* records, int z );
	/// As boxPlane, for all kRecordFloats floats: the rates of bodies that conserve their volume.
	void ( *boxPlaneFull )( const MatchView&, float* records, int z );
	/// Replaces it with flat rows: the nodes' or the regions' rows are summed along x, into the others', then along y and back. The gather
	/// sums along z.
	void ( *boxRows )( const RateView&, bool isOfRegions, int axis, int begin, int end );
	void ( *rigidRates )( const RateView&, int begin, int end );
	void ( *resist )( const RateView&, int begin, int end );
	void ( *resistPart )( const RateView&, int begin, int end );
	void ( *finishResist )( const RateView&, int begin, int end );

	/// v += h freedom g; extends `bounds` by the new velocities.
	void ( *push )( const MotionView&, const float* gravity, float h, int begin, int end, VelocityBounds& bounds );
	/// x += h v; adds to `sums`.
	void ( *advance )( const MotionView&, float h, int begin, int end, MotionSums& sums );

	// For vectors padded to whole lanes, used by the solver.
	/// a . b in double, 16 independent sums folded pairwise by halves.
	double ( *dot )( const float* a, const float* b, int size );
	/// Sums over the nodes of each component of r ( 1, arm ): 12 doubles, the plain sums first, then arm by arm
	/// (ImplicitMotion::affineSums). Components are `padded` apart.
	void ( *affineSums )( const float* r, const float* arms, const float* free, int padded, double* sums );
	/// z += V free + L arm, `motion` in the order of `affineSums`.
	void ( *addAffine )( const float* motion, const float* arms, const float* free, int padded, float* z );

	const char* name;
};

enum class KernelTarget : int
{
	Baseline, ///< SSE2, NEON, or the compiler's lowering of four-float vectors
	Avx2,
	Avx512
};

/// The table of a target, or null where this build or this processor does not support it.
const Kernels* findKernels( KernelTarget target );

/// The widest table this processor supports.
const Kernels& bestKernels();

} // namespace pliant
