#pragma once

// The nodes of an explicitly stepped body that contacts touch, as a body of their own in an implicit system. Such a body takes part with
// its masses alone, which couple no two of its nodes: those without contacts keep their velocities of free flight, and need no unknowns.

#include "body/implicit/implicit_motion.h"

#include <vector>

namespace pliant {

class TouchedNodes
{
public:
	/// Starts a substep without touched nodes. All arguments must live until store(). `parts`: null: one part.
	void begin( NodeState& nodes, const Vec3Array& velocityBefore, const ConnectedParts* parts );
	/// Returns the index of a node of the body in the system; the first call for a node adds it.
	int add( int node );
	/// Makes the system of the nodes added.
	void finish();
	/// Returns the body's first node in a connected part of the system.
	int firstOf( int part ) const { return m_touched[m_parts.areSeveral() ? m_parts.node[m_parts.start[std::size_t( part )]] : 0]; }
	/// Copies the velocities of the touched nodes back to the body.
	void store();

	/// Until finish() its nodes are those of the body, and nothing else of it may be read.
	ImplicitMotion& motion() { return m_motion; }
	/// Velocities of the touched nodes at the start of the substep, m/s.
	const Vec3Array& velocityBefore() const { return m_before; }

private:
	void listParts();

	NodeState* m_all = nullptr;
	const Vec3Array* m_allBefore = nullptr;
	const ConnectedParts* m_allParts = nullptr;
	NodeState m_nodes;
	Vec3Array m_before;
	ConnectedParts m_parts;
	ImplicitMotion m_motion;
	std::vector<int> m_index;               ///< by node of the body; -1: not touched
	std::vector<int> m_touched;             ///< the body's node, by index
	std::vector<std::uint32_t> m_partIndex; ///< by part of the body; scratch of listParts
};

} // namespace pliant
