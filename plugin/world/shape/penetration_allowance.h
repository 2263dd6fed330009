#pragma once

// Nodes that a change of levels brought into the world inside what the body touches: a big node's ball leaves out its cube's corners, and
// its parts stand there. Pushed out at the solver's own pace they are shot out, with many times the energy that the body came with. So as
// deep as a new node stands in anything at first it may go on standing, and no deeper, until it has come out; what is calm is let come out
// by itself (SoftBodySystem::endCollision).

#include <cstdint>
#include <vector>

namespace pliant {

class PenetrationAllowance
{
public:
	/// A change of levels. `nodeNow`: by number before, kNoNode for what is gone; who is nobody's number is new.
	void follow( const std::vector<std::uint32_t>& nodeNow, int nodeCount );
	/// Of a piece. `nodeBefore`: by its nodes, what they were in the body before.
	static PenetrationAllowance of( const PenetrationAllowance& parent, const std::vector<std::uint32_t>& nodeBefore );

	/// Whether any node may stand in something; else nothing is asked and nothing is kept.
	bool isAny() const { return !m_leave.empty(); }
	/// How much of the `depth` that a node is in something now it may be, 0 to depth, m; noted for the phase's end.
	double leave( int node, double depth );
	/// After all contacts of a collision phase: no node may be deeper from now on than it was in any of them, less `out`, m.
	void endPhase( double out );

private:
	std::vector<float> m_leave; ///< by node, m; infinity until it has been measured; empty: none has any
	std::vector<float> m_found; ///< in this phase
};

} // namespace pliant
