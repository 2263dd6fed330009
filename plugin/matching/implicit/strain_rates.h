#pragma once

// The operator of the implicit step for one body: the response of its regions' stiffness to node velocities. docs/design/implicit.md.
//
//   A v = m ( v + G ( v - P v ) ),   P v at node i = sum over its regions r of g_r ( vc_r + w_r x ( x_i - c_r ) ) / C_i
//   vc_r = sum a v / M_r,   w_r = T_r^-1 sum a ( x - c_r ) x v,   T_r = sum a ( |x - c_r|^2 1 - ( x - c_r )( x - c_r )^T )
//
// with the weights a, C of shape matching (region_moments.h). P_r projects onto the region's rigid motions at the current node positions,
// so 1 - P is symmetric under the masses, positive semidefinite, and zero for rigid motions of the whole body: rotations are not braked,
// and momentum is conserved. Rivers and James 2007, section 5, use the same projection for damping. It is the derivative of the matching
// force for unstrained regions. Of the contribution of strain only tension is added, where the step does not resolve it: T is raised, so
// that a rotated region is pulled back (kernels/kernel_inertia.h, raiseTaut). Compression, which can make the derivative indefinite, is
// left out.
//
// A collinear region has no inertia about its line, and float precision does not resolve the small inertia of a slightly bent one: such T
// are raised too. Where any T is raised, P removes slightly less than a rigid motion. To stay symmetric, and zero for rigid motions of the
// whole body, the operator is then ( 1 - Q ) ( 1 - P ) ( 1 - Q ), Q the projection onto those.
//
// Material::volumeKeeping kappa adds kappa times the second derivative of the energy of volume conservation (storeVolumeRate in
// kernels/kernel_rates.h), with the gradients that the last matching stored: A v = m ( v + G ( v - P v + volume V v ) ).
//
// Nodes on several levels: a region's energy is ( 1 - eta ) | n |^2 + | F - R |^2 in J_fine = J C, n the non-affine part of the motion
// (level_tables.h). With g_r = b_r max( 1 - eta, largest stretch of C ) the operator is an upper bound of that, and equal to it for affine
// motions where C is isotropic.
//
// A body in several unlinked parts (connected_parts.h): each part's own rigid motion is removed before anything is summed, and the kernels
// use positions relative to each part's centre. Only strain is then summed, multiplied by G and rounded, however far apart the parts are.

#include "matching/implicit/flat_boxes.h"
#include "matching/kernels/kernels.h"
#include "matching/node_state.h"
#include "matching/regions/connected_parts.h"

#include <Eigen/Core>

#include <array>
#include <memory>
#include <vector>

namespace pliant {

class LatticeMatcher;
class TaskRunner;
struct RegionTables;
struct SumPlan;

/// Rigid-body properties of a connected part, or of a body in one part.
struct WholePart
{
	double mass = 0.0;                                     ///< kg
	Eigen::Vector3d centre = Eigen::Vector3d::Zero();      ///< of mass, relative to the origin, m
	Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity(); ///< about the centre, kg m^2
	Eigen::Matrix3d inverseInertia = Eigen::Matrix3d::Identity();
};

class StrainRates
{
public:
	/// Measures the centres and inertias of the regions from the current nodes and tables, using the matcher's records as scratch. Both
	/// arguments must stay unchanged for as long as `resist` is called. `stiffness`: the largest G with which it will be; regions that are
	/// taut for that resist rotation. 0: none do.
	void prepare( LatticeMatcher& matcher, NodeState& nodes, TaskRunner* runner, float stiffness = 0.0f );

	/// Uses the reference implementation from the next `prepare` on: boxes are summed by records.
	void sumByRecords() { m_sumsByRecords = true; }

	/// Measures the body's mass, centre and inertia only. `parts`: as above, must live as long as the nodes; null: one part.
	void measureBody( const NodeState& nodes, const ConnectedParts* parts = nullptr );

	/// to = A v for free nodes, 0 for the others: m ( v + stiffness ( v - P v ) ). Arrays are `padded` long each, component by component.
	/// With `volume`, the resistance to changes of volume relative to `stiffness`: m ( v + stiffness ( v - P v + volume V v ) ).
	void resist( const float* v, float stiffness, float* to, TaskRunner* runner, float volume = 0.0f );

	/// The mean of A's three diagonal entries of a node is m ( 1 + stiffness diagonal[i] ).
	const AlignedArray<float>& diagonal() const { return m_diagonal; }
	const ConnectedParts& parts() const { return *m_parts; }
	/// The body, or one of its parts where it has several.
	const WholePart& whole( int part = 0 ) const { return m_wholes[std::size_t( part )]; }
	/// True where some region is nearly collinear or taut: `resist` then takes two more passes over the nodes.
	bool hasRaisedRegions() const { return m_isRaised; }

private:
	void measureFractions( const RegionTables& tables );
	void measureDiagonal( const RegionTables& tables );
	void measureRegions( TaskRunner* runner ); ///< positions and inertias
	enum class RecordSize : int
	{
		Half,  ///< rates
		Whole, ///< inertias
		Full   ///< rates of bodies that conserve their volume
	};
	void sumRecords( float* records, RecordSize size, TaskRunner* runner );
	void sumRates( bool isOfRegions, TaskRunner* runner );
	void measureRigidMotion( const float* const* velocity, TaskRunner* runner );
	void applyRegions( TaskRunner* runner );
	// For a body in several parts.
	void centreParts( const NodeState& nodes );
	void centreFrames( const NodeState& nodes );
	void measureDisplacements( const Eigen::Matrix3d& frame );
	void removeRigidMotion( const float* const* from, float* const* to ) const;
	void resistByPart( const float* v, float* to, TaskRunner* runner );

	const Kernels* m_kernels = nullptr;
	MatchView m_view;
	RateView m_rates;
	int m_padded = 0;
	bool m_gridHasHoles = false;
	std::size_t m_recordFloats = 0;
	bool m_isRaised = false; ///< some region's inertia is raised
	AlignedArray<float> m_centres[3], m_inverseInertias[6], m_diagonal;
	AlignedArray<float> m_fraction, m_pull; ///< of nodes on several levels; empty on a uniform lattice
	FlatBoxes m_boxes;                      ///< of a lattice that fills its grid
	bool m_sumsByRecords = false;
	const LatticeMatcher* m_measuredOf = nullptr; ///< the matcher for which diagonal and fractions were measured
	unsigned m_measuredVersion = 0;
	std::shared_ptr<const SumPlan> m_plan;
	std::vector<std::array<float, kRateSums>> m_partial;
	std::vector<char> m_raised; ///< of each chunk
	const ConnectedParts* m_parts = nullptr;
	std::vector<WholePart> m_wholes; ///< of each part
	// Of a body in several parts: positions relative to each part's centre, m; v without each part's rigid motion.
	AlignedArray<float> m_positions, m_strained;
	AlignedArray<float> m_displacements; ///< of the nodes from the rest shape in the body's frame, cells; stale for soft bodies
};

} // namespace pliant
