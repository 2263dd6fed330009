#pragma once

// Steps 1 and 2 of Steinemann et al. 2008, section 4.2.

#include "adapt/regions/interval_regions.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant {

/// First distance that cannot be in a region: d <= w is in, and d < ( 1 + eps ) w may be.
inline std::uint32_t limitOf( std::uint32_t width, float eps )
{
	return std::max( width + 1, std::uint32_t( std::ceil( ( 1.0 + double( eps ) ) * width ) ) );
}

/// Finds the octree nodes whose simulation nodes have all been added: the complete ones.
class Cover
{
public:
	explicit Cover( const Octree& octree ) : m_octree( octree ), m_state( octree.parent.size() ) {}

	void clear() { ++m_round; }

	void add( std::uint32_t simulationNode )
	{
		std::uint32_t node = simulationNode;
		stateOf( node ).isComplete = true;
		for ( std::uint32_t parent = m_octree.parent[node]; parent != kNoNode; parent = m_octree.parent[parent] )
		{
			State& state = stateOf( parent );
			if ( ++state.completeChildren < m_octree.childStart[parent + 1] - m_octree.childStart[parent] )
			{
				return;
			}
			state.isComplete = true;
		}
	}

	/// Returns the largest complete node above an added one, or kNoNode where it was returned before.
	std::uint32_t largestAbove( std::uint32_t simulationNode )
	{
		std::uint32_t node = simulationNode;
		for ( std::uint32_t parent = m_octree.parent[node]; parent != kNoNode && stateOf( parent ).isComplete;
			  parent = m_octree.parent[node] )
		{
			node = parent;
		}
		return std::exchange( stateOf( node ).isListed, true ) ? kNoNode : node;
	}

private:
	struct State
	{
		std::uint32_t round = 0;
		std::uint16_t completeChildren = 0;
		bool isComplete = false;
		bool isListed = false;
	};

	State& stateOf( std::uint32_t node )
	{
		State& state = m_state[node];
		if ( state.round != m_round )
		{
			state = {};
			state.round = m_round;
		}
		return state;
	}

	const Octree& m_octree;
	std::vector<State> m_state;
	std::uint32_t m_round = 0;
};

struct Rows
{
	std::vector<std::uint32_t> start{ 0 }, entry;

	void close() { start.push_back( std::uint32_t( entry.size() ) ); }
};

/// Own rows of all slots, computed in parallel.
Rows searchRows( const IntervalInput& input, const IntervalRegions& regions, TaskRunner* runner );

/// Appends the largest octree nodes whose simulation nodes are all in `slots` (ascending), in depth-first order.
void appendLargest( const IntervalInput& input, const std::vector<std::uint32_t>& slots, Cover& cover, std::vector<std::uint32_t>& nodes );

} // namespace pliant
