#pragma once

// The operator of the implicit step for one body: what its regions' stiffness makes of nodes' speeds. docs/design/implicit.md.
//
//   A v = m ( v + G ( v - P v ) ),   P v at node i = sum over its regions r of g_r ( vc_r + w_r x ( x_i - c_r ) ) / C_i
//   vc_r = sum a v / M_r,   w_r = T_r^-1 sum a ( x - c_r ) x v,   T_r = sum a ( |x - c_r|^2 1 - ( x - c_r )( x - c_r )^T )
//
// with the weights a, C of shape matching (region_moments.h). P_r projects onto the region's rigid motions at the places the nodes have
// now, so 1 - P is symmetric under the masses and positive semidefinite, and is zero for rigid motions of the whole: no turn is braked, and
// no momentum moved. It is what the derivative of the matching force becomes where the regions are not strained; what strain adds (it can
// make the derivative indefinite) is left out. Rivers and James 2007, section 5, use the same projection to damp.
//
// A region in one line has no inertia about it, and floats do not say how little a slightly bent one has: such T are raised, and P then
// takes a little less than all of a rigid motion. To be symmetric still, and to leave rigid motions of the whole alone, the operator is ( 1
// - Q ) ( 1 - P ) ( 1 - Q ) then, Q the projection onto those.
//
// Nodes on several levels: a region asks for ( 1 - eta ) | n |^2 + | F - R |^2 in J_fine = J C, n what no affine motion explains
// (level_tables.h). With g_r = b_r max( 1 - eta, largest stretch of C ) the operator bounds that, and is its equal for affine motions where
// C is the same in all directions.
//
// A body in several parts that nothing links (connected_parts.h): each part's own rigid motion is taken off before anything is summed, and
// the kernels see places about each part's own centre. What is summed, multiplied by G and rounded is then strain alone, however far the
// parts are from each other.

#include "matching/implicit/flat_boxes.h"
#include "matching/implicit/sliced_rows.h"
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

/// A connected part of a body, or a body in one part, as a rigid thing.
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
	/// Nodes and tables as they are now: centres and inertias of the regions. The matcher's records are scratch here.
	/// Both must stay as they are for as long as `resist` is called.
	void prepare( LatticeMatcher& matcher, NodeState& nodes, TaskRunner* runner );

	/// The slow twin, from the next `prepare`: rows of regions on several levels are summed one by one, boxes by records.
	void sumRowByRow() { m_isRowByRow = true; }

	/// The part of it that says where the body is and how heavy. `parts`: as above, kept for as long as the nodes are; null: one.
	void measureBody( const NodeState& nodes, const ConnectedParts* parts = nullptr );

	/// to = A v for free nodes, 0 for the others: m ( v + stiffness ( v - P v ) ). Arrays are `padded` long each, component by component.
	void resist( const float* v, float stiffness, float* to, TaskRunner* runner );

	/// The mean of A's three diagonal entries of a node is m ( 1 + stiffness diagonal[i] ).
	const AlignedArray<float>& diagonal() const { return m_diagonal; }
	const ConnectedParts& parts() const { return *m_parts; }
	/// The body, or each of its parts, where it has several.
	const WholePart& whole( int part = 0 ) const { return m_wholes[std::size_t( part )]; }
	/// Whether a region is about a line: `resist` takes two more passes over the nodes then.
	bool hasThinRegions() const { return m_isRaised; }
	std::size_t bytes() const;

private:
	void measureFractions( const RegionTables& tables );
	void measureDiagonal( const RegionTables& tables );
	void measureRegions( TaskRunner* runner ); ///< where they are, and their inertias
	void sumRecords( float* records, bool isOfRates, TaskRunner* runner );
	void sumRates( bool isOfRegions, TaskRunner* runner );
	void measureRigidMotion( const float* const* speed, TaskRunner* runner );
	void applyRegions( TaskRunner* runner );
	// Of a body in several parts.
	void placeParts( const NodeState& nodes );
	void placeFrames( const NodeState& nodes );
	void takeRigidMotionOff( const float* const* from, float* const* to ) const;
	void resistByPart( const float* v, float* to, TaskRunner* runner );

	const Kernels* m_kernels = nullptr;
	MatchView m_view;
	RateView m_rates;
	int m_padded = 0;
	bool m_gridHasHoles = false;
	std::size_t m_recordFloats = 0;
	bool m_isRaised = false; ///< some region's inertia is more than it has
	AlignedArray<float> m_centres[3], m_inverseInertias[6], m_diagonal;
	AlignedArray<float> m_fraction, m_pull; ///< of nodes on several levels; empty on a uniform lattice
	SlicedRows m_rows;                      ///< the same
	FlatBoxes m_boxes;                      ///< of a lattice that fills its grid
	bool m_isRowByRow = false;
	const LatticeMatcher* m_measuredOf = nullptr; ///< what diagonal and shares were measured for, and which of its tables
	unsigned m_measuredVersion = 0;
	std::shared_ptr<const SumPlan> m_plan;
	std::vector<std::array<float, kRateSums>> m_partial;
	std::vector<char> m_raised; ///< of each chunk
	const ConnectedParts* m_parts = nullptr;
	std::vector<WholePart> m_wholes; ///< of each part
	AlignedArray<float> m_positions,
		m_strained; ///< of a body in several parts: from each part's centre, m; v without each part's rigid motion
};

} // namespace pliant
