#pragma once

// List of node pairs of a soft body that may touch, kept from step to step: Verlet's neighbour list, updated node by node.

#include "world/self/close_pairs.h"

#include <cstdint>
#include <vector>

namespace pliant {

class SoftBody;
struct NodeState;

class NearPairs
{
public:
	/// Pairs of nodes whose spheres may touch in this step, ascending, as lower number << 32 | higher; without those that a region holds
	/// together, or that share a third node in their regions.
	const std::vector<std::uint64_t>& of( const SoftBody& soft, double step );
	/// Follows a change of node numbers or regions: `nodeNow` by previous number, kNoNode where the node is gone. Empty: numbers are
	/// unchanged.
	void renumber( const std::vector<std::uint32_t>& nodeNow );
	/// Number of queries by nodes since construction: a measure of the cost.
	long long asked() const { return m_asked; }

private:
	/// State of a node when it last searched for near nodes.
	struct Then
	{
		Vec3 place;   ///< less the mean displacement at that time
		float radius; ///< of its sphere; less than 0: no sphere, or no search yet
	};

	float radiusOf( int node ) const;
	void takeNumbers();
	bool hasSameRow( std::uint32_t node ) const;
	void measureDrift( const NodeState& nodes );
	void findAsking( const NodeState& nodes );
	void follow( const NodeState& nodes );
	void ask( const NodeState& nodes );

	const SoftBody* m_soft = nullptr;
	double m_step = 0.0;
	const std::vector<std::uint32_t>* m_rowStart = nullptr; ///< of each node: those a region holds with it
	const std::vector<std::uint32_t>* m_rowTo = nullptr;
	Vec3 m_way = Vec3::Zero(),
		 m_drift = Vec3::Zero(); ///< mean displacement of all nodes since positions were first recorded; and mean velocity
	double m_margin = 0.0;       ///< m
	bool m_isRelinked = true;
	std::vector<std::uint64_t> m_pairs;
	std::vector<Then> m_then;
	std::vector<std::uint32_t> m_startThen, m_toThen; ///< rows at the last update
	bool m_hasNumbers = false;                        ///< node numbers differ from those of the stored rows
	std::vector<std::uint32_t> m_now, m_before;       ///< present number of each node of the stored rows; and the reverse
	std::vector<std::uint32_t> m_asking;
	std::vector<std::uint8_t> m_isAsking;
	std::vector<ClosePairs::Sphere> m_spheres;
	ClosePairs m_close;
	long long m_asked = 0;
};

} // namespace pliant
