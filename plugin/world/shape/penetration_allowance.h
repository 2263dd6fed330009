#pragma once

// Allowed penetration of nodes that a change of levels created inside what the body touches: a coarse node's sphere leaves out the corners
// of its cube, where its parts appear. Pushed out at the solver's rate, they would gain many times the body's energy. So a new node may
// stay as deep as it first is, until it has come out; a calm body's allowance is reduced over time (SoftBodySystem::endCollision).

#include <cstdint>
#include <vector>

namespace pliant {

class Archive;

class PenetrationAllowance
{
public:
	/// Follows a change of levels. `nodeNow`: by previous number, kNoNode where the node is gone; nodes without a previous number are new.
	void follow( const std::vector<std::uint32_t>& nodeNow, int nodeCount );
	/// The allowance of a fragment. `nodeBefore`: for each of its nodes, the number in the parent.
	static PenetrationAllowance of( const PenetrationAllowance& parent, const std::vector<std::uint32_t>& nodeBefore );

	/// Whether any node has an allowance; otherwise nothing is looked up or stored.
	bool isAny() const { return !m_allowed.empty(); }
	/// The allowed part of a node's penetration `depth`, 0 to depth, m; recorded until the end of the phase.
	double allowedDepth( int node, double depth );
	/// After all contacts of a collision phase: limits each allowance to the largest depth recorded, less `out`, m.
	void endPhase( double out );
	/// Writes or reads the allowances of a body of this many nodes.
	void archive( Archive& archive, int nodeCount );

private:
	std::vector<float> m_allowed; ///< by node, m; infinity until measured; empty: no node has one
	std::vector<float> m_found;   ///< largest depth recorded in this phase
};

} // namespace pliant
