#pragma once

// The maps of nodes between two steps, for a renderer that draws more often than the world steps.
//
// Between the states b and n of two steps lies the best-fitting rigid motion, ( Q, c_b -> c_n ): the body's rotation by Q^t and the motion
// of its centre along a line. The remainder is linear in t, in the moving frame:
//
//     F( t ) = Q^t ( ( 1 - t ) F_b + t Q^-1 F_n )
//     s( t ) = c( t ) + Q^t ( ( 1 - t )( s_b - c_b ) + t Q^-1 ( s_n - c_n ) ),   c( t ) = ( 1 - t ) c_b + t c_n
//
// of maps x = F X + s. A rotating body keeps its size, as Bullet's rigid bodies do; blending x alone would shrink it. The cubes of nodes
// count with their moments in the fit, so that it is never undetermined.

#include "matching/node_state.h"

#include <Eigen/Geometry>

#include <vector>

namespace pliant {

class SkinBlend
{
public:
	/// Takes the maps of a state over: positions are relative to `origin`.
	void keep( AlignedArray<float>& maps, const Eigen::Vector3d& origin );
	/// The body has jumped, or is at rest: there is nothing to blend with.
	void forget() { m_isKept = false; }
	bool isKept() const { return m_isKept; }

	/// Nodes have changed: `source` is by node its node before. `shift`: rest positions are relative to a point this far away now, m.
	void renumber( const std::vector<std::uint32_t>& source, const Eigen::Vector3d& shift = Eigen::Vector3d::Zero() );
	/// The same for a change of levels that moves maps from `before` to `now` at once: the kept ones move by as much, so that the surface,
	/// with the offsets that undo that, stays where it was.
	void followLevels( const std::vector<std::uint32_t>& source, const AlignedArray<float>& before, const AlignedArray<float>& now );
	/// The maps of a piece: of nodes `source` of this body.
	SkinBlend ofPiece( const std::vector<std::uint32_t>& source, const Eigen::Vector3d& shift ) const;

	/// Writes the maps at `fraction` (0: kept, 1: `maps`) of the nodes' present maps. `cell`: edge of a finest cell, m.
	void between(
		const NodeState& nodes, const AlignedArray<float>& maps, double fraction, double cell, AlignedArray<float>& blended ) const;

	/// Adds `by`, m, to the positions of the state.
	void shift( const Eigen::Vector3d& by ) { m_origin += by; }

private:
	AlignedArray<float> m_before; ///< kSkinMapFloats per node
	Eigen::Vector3d m_origin = Eigen::Vector3d::Zero();
	bool m_isKept = false;
};

} // namespace pliant
