#include "adapt/regions/hierarchical_sum.h"

#include <cstring>

namespace pliant {

namespace {

/// sum = records[ term[0] ] + records[ term[1] ] + ..., in that order.
template <int floats>
inline void addRecords( const float* records, const std::uint32_t* term, const std::uint32_t* end, float* sum )
{
	float total[floats] = {};
	for ( ; term != end; ++term )
	{
		const float* const record = records + std::size_t( *term ) * floats;
		for ( int k = 0; k < floats; ++k )
		{
			total[k] += record[k];
		}
	}
	std::memcpy( sum, total, sizeof( total ) );
}

template <int floats>
void sumVirtualNodes( const SumPlan& plan, float* records )
{
	for ( int v = 0; v < plan.virtualNodes; ++v )
	{
		const std::uint32_t* const child = plan.child.data();
		float* const sum = records + std::size_t( plan.slots + v ) * floats;
		addRecords<floats>( records, child + plan.childStart[std::size_t( v )], child + plan.childStart[std::size_t( v ) + 1], sum );
	}
}

bool isSimulated( const Cut& cut, std::uint32_t slot, std::uint32_t node )
{
	return cut.node[slot] == node;
}

/// Marks the virtual nodes that occur in a region, and those below them.
std::vector<std::uint8_t> findNeeded( const Octree& octree, const Cut& cut, const IntervalRegions& intervals )
{
	std::vector<std::uint8_t> isNeeded( octree.parent.size(), 0 );
	for ( const std::uint32_t node : intervals.node )
	{
		isNeeded[node] = !isSimulated( cut, slotsUnder( octree, cut, node ).first, node );
	}
	// Parents have larger ids than their children. Nothing below a simulation node is needed.
	for ( std::uint32_t node = std::uint32_t( octree.nodeCount() ); node-- > octree.levelStart[1]; )
	{
		for ( std::uint32_t k = octree.childStart[node]; k < octree.childStart[node + 1] && isNeeded[node] != 0; ++k )
		{
			const std::uint32_t child = octree.child[k];
			isNeeded[child] = !isSimulated( cut, slotsUnder( octree, cut, child ).first, child );
		}
	}
	return isNeeded;
}

} // namespace

SumPlan planSums( const Octree& octree, const Cut& cut, const IntervalRegions& intervals )
{
	SumPlan plan;
	plan.slots = cut.count();
	const std::vector<std::uint8_t> isNeeded = findNeeded( octree, cut, intervals );
	std::vector<std::uint32_t> recordOf( octree.parent.size(), kNoNode );
	for ( std::uint32_t slot = 0; slot < std::uint32_t( cut.count() ); ++slot )
	{
		recordOf[cut.node[slot]] = slot;
	}
	plan.childStart.push_back( 0 );
	for ( std::uint32_t node = 0; node < std::uint32_t( octree.nodeCount() ); ++node )
	{
		if ( isNeeded[node] == 0 )
		{
			continue;
		}
		for ( std::uint32_t k = octree.childStart[node]; k < octree.childStart[node + 1]; ++k )
		{
			plan.child.push_back( recordOf[octree.child[k]] );
		}
		plan.childStart.push_back( std::uint32_t( plan.child.size() ) );
		recordOf[node] = std::uint32_t( plan.records() );
		++plan.virtualNodes;
	}
	plan.start = intervals.start;
	plan.term.reserve( intervals.node.size() );
	for ( const std::uint32_t node : intervals.node )
	{
		plan.term.push_back( recordOf[node] );
	}
	return plan;
}

void depthSum( const SumPlan& plan, float* records )
{
	sumVirtualNodes<kSumFloats>( plan, records );
}

void depthSumHalf( const SumPlan& plan, float* records )
{
	sumVirtualNodes<kSumFloats / 2>( plan, records );
}

} // namespace pliant
