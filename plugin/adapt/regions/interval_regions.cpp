#include "adapt/regions/interval_regions.h"

#include "adapt/constants.h"
#include "adapt/octree/bucket_moore.h"
#include "lattice/table.h"
#include "threads/parallel.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace pliant {

namespace {

/// First distance that cannot be in a region: d <= w is in, and d < ( 1 + eps ) w may be.
std::uint32_t limitOf( std::uint32_t width, float eps )
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

/// Steps 1 and 2 for one owner after another.
///
/// Distances are ascending, so a virtual node's interval [a, b] starts at its first simulation node reached and ends at its last. Nothing
/// is reached from ( 1 + eps ) w on, hence b < ( 1 + eps ) w exactly for complete nodes. Top-down, the paper inserts the first node with a
/// <= w and b < ( 1 + eps ) w: the largest complete one above a simulation node within w.
class RegionSearch
{
public:
	explicit RegionSearch( const IntervalInput& input ) : m_input( input ), m_cover( input.octree ) {}

	void append( std::uint32_t owner, std::uint32_t width, float eps, std::vector<std::uint32_t>& own )
	{
		const auto& reached = m_search.from( m_input.graph, owner, limitOf( width, eps ) );
		m_cover.clear();
		for ( const BucketMoore::Reached& r : reached )
		{
			m_cover.add( m_input.cut.node[r.node] );
		}
		const std::size_t first = own.size();
		for ( const BucketMoore::Reached& r : reached )
		{
			if ( r.distance > width )
			{
				break;
			}
			if ( const std::uint32_t node = m_cover.largestAbove( m_input.cut.node[r.node] ); node != kNoNode )
			{
				own.push_back( node );
			}
		}
		std::sort( own.begin() + std::ptrdiff_t( first ), own.end(),
			[this]( std::uint32_t a, std::uint32_t b ) { return m_input.octree.cellStart[a] < m_input.octree.cellStart[b]; } );
	}

private:
	const IntervalInput& m_input;
	Cover m_cover;
	BucketMoore m_search;
};

/// Own rows of all slots, computed in parallel: steps 1 and 2 of section 4.2.
Rows searchRows( const IntervalInput& input, const IntervalRegions& regions, TaskRunner* runner )
{
	const std::uint32_t count = std::uint32_t( input.cut.count() );
	const std::uint32_t tasks = ( count + kRegionsPerTask - 1 ) / kRegionsPerTask;
	std::vector<Rows> parts( tasks );
	auto search = [&]( int task ) {
		RegionSearch scratch( input );
		Rows& rows = parts[std::size_t( task )];
		const std::uint32_t first = std::uint32_t( task ) * kRegionsPerTask;
		for ( std::uint32_t slot = first; slot < std::min( count, first + kRegionsPerTask ); ++slot )
		{
			scratch.append( slot, regions.width[slot], regions.eps, rows.entry );
			rows.close();
		}
	};
	runTasks( runner, int( tasks ), search );
	Rows all;
	for ( const Rows& part : parts )
	{
		for ( std::size_t k = 1; k < part.start.size(); ++k )
		{
			all.start.push_back( std::uint32_t( all.entry.size() ) + part.start[k] );
		}
		all.entry.insert( all.entry.end(), part.entry.begin(), part.entry.end() );
	}
	return all;
}

/// Appends the largest octree nodes whose simulation nodes are all in `slots` (ascending), in depth-first order.
void appendLargest( const IntervalInput& input, const std::vector<std::uint32_t>& slots, Cover& cover, std::vector<std::uint32_t>& nodes )
{
	cover.clear();
	for ( const std::uint32_t slot : slots )
	{
		cover.add( input.cut.node[slot] );
	}
	for ( const std::uint32_t slot : slots )
	{
		if ( const std::uint32_t node = cover.largestAbove( input.cut.node[slot] ); node != kNoNode )
		{
			nodes.push_back( node );
		}
	}
}

/// 2^l cells, in half cells.
double spacingOf( const Octree& octree, std::uint32_t node )
{
	return kUnitsPerCell * std::ldexp( 1.0, octree.levelOf( node ) );
}

/// Returns the simulation nodes of each row. Rows and slots are in depth-first order, so the result is ascending.
Rows spread( const IntervalInput& input, const Rows& nodes )
{
	Rows rows;
	const std::vector<SlotSpan> spans = slotSpans( input.octree, input.cut );
	rows.start.reserve( nodes.start.size() );
	for ( std::size_t r = 0; r + 1 < nodes.start.size(); ++r )
	{
		for ( std::uint32_t k = nodes.start[r]; k < nodes.start[r + 1]; ++k )
		{
			const SlotSpan span = spans[nodes.entry[k]];
			for ( std::uint32_t slot = span.first; slot < span.end; ++slot )
			{
				rows.entry.push_back( slot );
			}
		}
		rows.close();
	}
	return rows;
}

/// Returns the rows that hold each slot, ascending.
Rows transposed( const Rows& rows )
{
	Rows result;
	const auto forEntries = [&rows]( auto&& visit ) {
		for ( std::uint32_t r = 0; r + 1 < std::uint32_t( rows.start.size() ); ++r )
		{
			for ( std::uint32_t k = rows.start[r]; k < rows.start[r + 1]; ++k )
			{
				visit( rows.entry[k], r );
			}
		}
	};
	sortIntoRows( rows.start.size() - 1, forEntries, result.start, result.entry );
	return result;
}

/// Step 3. A row that includes its column is kept; otherwise their union is expressed by the largest complete nodes.
void symmetrize( const IntervalInput& input, const Rows& own, IntervalRegions& regions )
{
	const Rows in = spread( input, own );
	const Rows by = transposed( in );
	Cover cover( input.octree );
	std::vector<std::uint32_t> both;
	regions.start.assign( 1, 0 );
	regions.node.clear();
	for ( std::size_t r = 0; r + 1 < in.start.size(); ++r )
	{
		const auto inFirst = in.entry.begin() + in.start[r], inEnd = in.entry.begin() + in.start[r + 1];
		const auto byFirst = by.entry.begin() + by.start[r], byEnd = by.entry.begin() + by.start[r + 1];
		if ( std::includes( inFirst, inEnd, byFirst, byEnd ) )
		{
			regions.node.insert( regions.node.end(), own.entry.begin() + own.start[r], own.entry.begin() + own.start[r + 1] );
			regions.start.push_back( std::uint32_t( regions.node.size() ) );
			continue;
		}
		both.clear();
		std::set_union( inFirst, inEnd, byFirst, byEnd, std::back_inserter( both ) );
		appendLargest( input, both, cover, regions.node );
		regions.start.push_back( std::uint32_t( regions.node.size() ) );
	}
}

} // namespace

std::vector<std::uint32_t> intervalWidths( const Octree& octree, const Cut& cut, float halfWidth )
{
	std::vector<std::uint32_t> width;
	width.reserve( cut.node.size() );
	for ( const std::uint32_t node : cut.node )
	{
		width.push_back( std::uint32_t( std::round( spacingOf( octree, node ) * std::max( 1.0, double( halfWidth ) ) ) ) );
	}
	return width;
}

std::vector<SlotSpan> slotSpans( const Octree& octree, const Cut& cut )
{
	std::vector<SlotSpan> spans( octree.parent.size(), SlotSpan{ kNoNode, 0 } );
	for ( std::uint32_t slot = 0; slot < std::uint32_t( cut.count() ); ++slot )
	{
		for ( std::uint32_t node = cut.node[slot]; node != kNoNode; node = octree.parent[node] )
		{
			spans[node] = { std::min( spans[node].first, slot ), slot + 1 };
		}
	}
	return spans;
}

IntervalRegions findIntervalRegions( const IntervalInput& input, std::vector<std::uint32_t> width, float eps, TaskRunner* runner )
{
	IntervalRegions regions;
	regions.eps = eps;
	regions.width = std::move( width );
	symmetrize( input, searchRows( input, regions, runner ), regions );
	return regions;
}

} // namespace pliant
