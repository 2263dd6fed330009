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
	/// Follows new numbers or regions: `nodeNow` by previous number, kNoNode where the node is gone; empty: numbers are unchanged.
	void renumber( const std::vector<std::uint32_t>& nodeNow );
	/// Number of queries by nodes since construction: a measure of the cost.
	long long queryCount() const { return m_queryCount; }

private:
	/// State of a node when it last searched for near nodes.
	struct Record
	{
		Vec3 position; ///< less the mean displacement at that time
		float radius;  ///< of its sphere; less than 0: no sphere, or no search yet
	};

	float radiusOf( int node ) const;
	void applyNumbers();
	bool hasSameRow( std::uint32_t node ) const;
	void measureMeanMotion( const NodeState& nodes );
	void findOutdated( const NodeState& nodes );
	void follow( const NodeState& nodes );
	void update( const NodeState& nodes );

	const SoftBody* m_soft = nullptr;
	double m_step = 0.0;
	const std::vector<std::uint32_t>* m_rowStart = nullptr; ///< of each node: those a region holds with it
	const std::vector<std::uint32_t>* m_rowTo = nullptr;
	Vec3 m_meanDisplacement = Vec3::Zero(),
		 m_meanVelocity = Vec3::Zero(); ///< mean displacement of all nodes since positions were first recorded; and mean velocity
	double m_margin = 0.0;              ///< m
	bool m_isRelinked = true;
	std::vector<std::uint64_t> m_pairs;
	std::vector<Record> m_records;
	std::vector<std::uint32_t> m_recordedStart, m_recordedTo; ///< rows at the last update
	bool m_isRenumbered = false;                              ///< node numbers differ from those of the stored rows
	std::vector<std::uint32_t> m_newNumber, m_oldNumber;      ///< present number of each node of the stored rows; and the reverse
	std::vector<std::uint32_t> m_outdated;
	std::vector<std::uint8_t> m_isOutdated;
	std::vector<ClosePairs::Sphere> m_spheres;
	ClosePairs m_close;
	long long m_queryCount = 0;
};

} // namespace pliant
