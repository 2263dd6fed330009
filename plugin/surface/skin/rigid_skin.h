#pragma once

// The skin of a body that moves as one rigid body: what was skinned last in full is turned and shifted, at a tenth of the cost. Whether it
// does is asked of its nodes, as they are against as they were when it was skinned in full, so that nothing adds up. Beyond Steinemann et
// al. 2008, section 7.
//
// A vertex is x = sum w_k ( x_k + F_k ( X - x0_k ) ). Nodes off a rigid motion by e at most change F_k by about e over the region's width,
// and X is at most as far from x0_k as that is wide: together some 2 e, 3 e at the worst. So nodes may be off by a third of what vertices
// may.

#include "matching/node_state.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <vector>

namespace pliant {

class TaskRunner;

class RigidSkin
{
public:
	enum class Since
	{
		Bent,  ///< to be skinned in full
		Still, ///< what is shown is as it should be
		Moved  ///< `turn` has what was skinned in full go where it should be
	};

	/// The skin has just been made in full of these nodes. `rotations`: as in SkinPose; `flow`: the same, or null; `hasGradients`: the
	/// nodes' F are from their places, which say enough then.
	void keep( const NodeState& nodes, const float* rotations, const float* flow, bool hasGradients );
	/// What was kept is of no use: nodes or vertices are others now, or what was shown was not the nodes' alone.
	void forget() { m_isKept = false; }
	bool isKept() const { return m_isKept; }

	/// What the nodes, those that were kept, have done since. `tolerance`: how far a vertex may be from where it should be, m; `cell`: edge
	/// of a finest cell, m. Goes on from what it said last.
	Since ask( const NodeState& nodes, const float* rotations, const float* flow, double tolerance, double cell );

	/// 3 floats a vertex, of as many vertices: those of the skin that was kept, where the last `ask` has them. The same bits on any thread
	/// count.
	void turn( const std::vector<float>& positions, const std::vector<float>& normals, std::vector<float>& positionsNow,
		std::vector<float>& normalsNow, TaskRunner* runner = nullptr ) const;

	std::size_t bytes() const { return ( m_position.size() + m_rotation.size() + m_flow.size() ) * sizeof( float ); }

private:
	struct Motion
	{
		Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
		Eigen::Vector3d shift = Eigen::Vector3d::Zero();
	};
	bool areInOneLine( const NodeState& nodes ) const;
	Motion fit( const NodeState& nodes, const float* rotations ) const;
	bool follows( const Motion& motion, const NodeState& nodes, const float* rotations, double tolerance, double cell ) const;

	std::vector<float> m_position, m_rotation, m_flow; ///< 3, 4 and 9 floats a node, when it was skinned in full
	Eigen::Vector3d m_origin = Eigen::Vector3d::Zero();
	Motion m_shown; ///< since then
	bool m_isKept = false;
	bool m_asksTurns = true; ///< nodes' rotations count too
};

} // namespace pliant
