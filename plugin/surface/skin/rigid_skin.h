#pragma once

// The skin of a body that moves as a rigid body: the last full skin is rotated and translated, at a tenth of the cost. The decision
// compares the nodes with their state at the last full skinning, so errors do not accumulate. Not in Steinemann et al. 2008, section 7.
//
// A vertex is x = sum w_k ( x_k + F_k ( X - x0_k ) ). If nodes deviate from a rigid motion by at most e, F_k changes by about e over the
// width of a region, and X is at most that width away from x0_k: together about 2 e, at worst 3 e. So nodes may deviate by a third of the
// vertices' tolerance.

#include "matching/node_state.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <vector>

namespace pliant {

class TaskRunner;

class RigidSkin
{
public:
	enum class Change
	{
		Bent,  ///< full skinning is required
		Still, ///< the shown skin is still correct
		Moved  ///< `turn` computes the correct skin from the last full one
	};

	/// Stores the nodes of a full skinning. `rotations`: as in SkinPose; `flow`: the same, or null; `hasGradients`: the nodes' F follow
	/// from their positions, so that these suffice for the comparison.
	void keep( const NodeState& nodes, const float* rotations, const float* flow, bool hasGradients );
	/// Discards the stored nodes: nodes or vertices have changed, or the shown skin depended on more than the nodes.
	void forget() { m_isKept = false; }
	bool isKept() const { return m_isKept; }

	/// Classifies the motion of the stored nodes since the last full skinning. `tolerance`: largest error of a vertex, m; `cell`: edge
	/// length of a finest cell, m. Starts from the motion found last.
	Change classify( const NodeState& nodes, const float* rotations, const float* flow, double tolerance, double cell );

	/// Applies the motion found by the last `classify` to the full skin. All arrays: 3 floats per vertex. The same bits for any number of
	/// threads.
	void turn( const std::vector<float>& positions, const std::vector<float>& normals, std::vector<float>& positionsNow,
		std::vector<float>& normalsNow, TaskRunner* runner = nullptr ) const;

private:
	struct Motion
	{
		Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
		Eigen::Vector3d shift = Eigen::Vector3d::Zero();
	};
	bool areCollinear( const NodeState& nodes ) const;
	Motion fit( const NodeState& nodes, const float* rotations ) const;
	bool follows( const Motion& motion, const NodeState& nodes, const float* rotations, double tolerance, double cell ) const;

	std::vector<float> m_position, m_rotation, m_flow; ///< 3, 4 and 9 floats per node at the last full skinning
	Eigen::Vector3d m_origin = Eigen::Vector3d::Zero();
	Motion m_shown; ///< motion since then
	bool m_isKept = false;
	bool m_comparesRotations = true; ///< whether nodes' rotations are compared too
};

} // namespace pliant
