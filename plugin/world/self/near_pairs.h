#pragma once

// Which nodes of a soft body may come to touch one another, kept from step to step: Verlet's neighbour list, node by node.

#include "world/self/close_pairs.h"

#include <cstdint>
#include <vector>

namespace pliant {

class SoftBody;
struct NodeState;

class NearPairs
{
public:
	/// Pairs of nodes whose spheres may touch in this step, ascending, as lower number << 32 | higher; but for those that one region holds
	/// together, or that both have a third in their regions.
	const std::vector<std::uint64_t>& of( const SoftBody& soft, double step );
	/// Nodes have other numbers, or other regions: `nodeNow` by the number before, kNoNode where the node is gone. Empty: the numbers they
	/// had.
	void renumber( const std::vector<std::uint32_t>& nodeNow );
	/// How many nodes have asked, since there are any: what it costs.
	long long asked() const { return m_asked; }

private:
	/// What was known of a node when it last asked which others are near.
	struct Then
	{
		Vec3 place;   ///< less the way that all had come by then
		float radius; ///< of its sphere; less than 0: it had none, or has never asked
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
	Vec3 m_way = Vec3::Zero(), m_drift = Vec3::Zero(); ///< that all have come, in the mean, since places were first noted; and mean speed
	double m_margin = 0.0;                             ///< m
	bool m_isRelinked = true;
	std::vector<std::uint64_t> m_pairs;
	std::vector<Then> m_then;
	std::vector<std::uint32_t> m_startThen, m_toThen; ///< rows
	bool m_hasNumbers = false;                        ///< others than those that rows have
	std::vector<std::uint32_t> m_now, m_before;       ///< of each node of the rows: its number now; and the other way round
	std::vector<std::uint32_t> m_asking;
	std::vector<std::uint8_t> m_isAsking;
	std::vector<ClosePairs::Sphere> m_spheres;
	ClosePairs m_close;
	long long m_asked = 0;
};

} // namespace pliant
