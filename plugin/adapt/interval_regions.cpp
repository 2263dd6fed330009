#include "adapt/interval_regions.h"

#include "adapt/bucket_moore.h"
#include "threads/parallel.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace pliant {

namespace {

/// Searches of one task: enough to be worth its scratch.
constexpr std::uint32_t kRegionsPerTask = 256;

/// First distance that cannot be in a region: d <= w is in, and d < ( 1 + eps ) w may be.
std::uint32_t limitOf( std::uint32_t width, float eps )
{
	return std::max( width + 1, std::uint32_t( std::ceil( ( 1.0 + double( eps ) ) * width ) ) );
}

/// 2^l cells, in half cells.
double spacingOf( const Octree& octree, std::uint32_t node )
{
	return kUnitsPerCell * std::ldexp( 1.0, octree.levelOf( node ) );
}

/// Which octree nodes have all their simulation nodes among those added.
class Cover
{
public:
	explicit Cover( const Octree& octree ) : m_octree( octree ), m_state( octree.parent.size() ) {}

	void clear() { ++m_round; }

	void add( std::uint32_t simulationNode )
	{
		std::uint32_t node = simulationNode;
		stateOf( node ).isWhole = true;
		for ( std::uint32_t parent = m_octree.parent[node]; parent != kNoNode; parent = m_octree.parent[parent] )
		{
			State& state = stateOf( parent );
			if ( ++state.wholeChildren < m_octree.childStart[parent + 1] - m_octree.childStart[parent] )
			{
				return;
			}
			state.isWhole = true;
		}
	}

	/// The largest node above one added that is whole, or kNoNode where it was named already.
	std::uint32_t largestAbove( std::uint32_t simulationNode )
	{
		std::uint32_t node = simulationNode;
		for ( std::uint32_t parent = m_octree.parent[node]; parent != kNoNode && stateOf( parent ).isWhole; parent = m_octree.parent[node] )
		{
			node = parent;
		}
		return std::exchange( stateOf( node ).isNamed, true ) ? kNoNode : node;
	}

private:
	struct State
	{
		std::uint32_t round = 0;
		std::uint16_t wholeChildren = 0;
		bool isWhole = false;
		bool isNamed = false;
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

/// Steps 1 and 2 for one owner after another.
///
/// Distances come in ascending order. A virtual node's interval [a, b] so begins at its first simulation node reached and ends at its
/// last; nothing is reached from ( 1 + eps ) w on, hence b < ( 1 + eps ) w exactly for nodes that are whole. Going top-down, the paper
/// inserts the first node with a <= w and b < ( 1 + eps ) w: the largest whole one above a simulation node within w.
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

struct Rows
{
	std::vector<std::uint32_t> start{ 0 }, entry;

	void close() { start.push_back( std::uint32_t( entry.size() ) ); }
};

/// Own rows of some slots, in parallel, in their order.
Rows searchRows( const IntervalInput& input, const IntervalRegions& regions, const std::vector<std::uint32_t>& slots, TaskRunner* runner )
{
	const std::uint32_t count = std::uint32_t( slots.size() );
	const std::uint32_t tasks = ( count + kRegionsPerTask - 1 ) / kRegionsPerTask;
	std::vector<Rows> parts( tasks );
	auto search = [&]( int task ) {
		RegionSearch scratch( input );
		Rows& rows = parts[std::size_t( task )];
		const std::uint32_t first = std::uint32_t( task ) * kRegionsPerTask;
		for ( std::uint32_t k = first; k < std::min( count, first + kRegionsPerTask ); ++k )
		{
			scratch.append( slots[k], regions.width[slots[k]], regions.eps, rows.entry );
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

/// Simulation nodes of each row. Rows are in depth-first order and slots are too: they come ascending.
Rows spread( const IntervalInput& input, const std::vector<std::uint32_t>& start, const std::vector<std::uint32_t>& node )
{
	Rows rows;
	rows.start.reserve( start.size() );
	for ( std::size_t r = 0; r + 1 < start.size(); ++r )
	{
		for ( std::uint32_t k = start[r]; k < start[r + 1]; ++k )
		{
			const SlotSpan span = slotsUnder( input.octree, input.cut, node[k] );
			for ( std::uint32_t slot = span.first; slot < span.end; ++slot )
			{
				rows.entry.push_back( slot );
			}
		}
		rows.close();
	}
	return rows;
}

/// Which rows hold each slot, ascending.
Rows transposed( const Rows& rows )
{
	Rows result;
	const std::size_t count = rows.start.size() - 1;
	result.start.assign( count + 1, 0 );
	for ( const std::uint32_t slot : rows.entry )
	{
		++result.start[slot + 1];
	}
	for ( std::size_t i = 0; i < count; ++i )
	{
		result.start[i + 1] += result.start[i];
	}
	result.entry.resize( rows.entry.size() );
	std::vector<std::uint32_t> next( result.start.begin(), result.start.end() - 1 );
	for ( std::size_t r = 0; r < count; ++r )
	{
		for ( std::uint32_t k = rows.start[r]; k < rows.start[r + 1]; ++k )
		{
			result.entry[next[rows.entry[k]]++] = std::uint32_t( r );
		}
	}
	return result;
}

/// Step 3. A row that is its own column stays; else both together are named by the largest whole nodes.
void symmetrize( const IntervalInput& input, IntervalRegions& regions )
{
	const Rows in = spread( input, regions.ownStart, regions.own );
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
			regions.node.insert( regions.node.end(), regions.own.begin() + regions.ownStart[r],
			                     regions.own.begin() + regions.ownStart[r + 1] );
			regions.start.push_back( std::uint32_t( regions.node.size() ) );
			continue;
		}
		both.clear();
		std::set_union( inFirst, inEnd, byFirst, byEnd, std::back_inserter( both ) );
		cover.clear();
		for ( const std::uint32_t slot : both )
		{
			cover.add( input.cut.node[slot] );
		}
		for ( const std::uint32_t slot : both )
		{
			if ( const std::uint32_t node = cover.largestAbove( input.cut.node[slot] ); node != kNoNode )
			{
				regions.node.push_back( node );
			}
		}
		regions.start.push_back( std::uint32_t( regions.node.size() ) );
	}
}

/// Slots of nodes that stayed and must be searched anew, besides the new ones.
std::vector<std::uint32_t> slotsToSearch( const IntervalInput& to, const VisibilityUpdate& change, const VisibilityGraph& from,
                                          const IntervalRegions& old, const IntervalRegions& regions )
{
	const std::vector<std::uint32_t>& before = change.change.before;
	const std::vector<std::uint32_t>& after = change.change.after;
	std::vector<std::uint8_t> isDirty( before.size(), 0 );
	std::vector<std::uint32_t> gone, come;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( after.size() ); ++slot )
	{
		if ( after[slot] == kNoNode )
		{
			gone.push_back( slot );
		}
	}
	std::uint32_t limit = 0;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( before.size() ); ++slot )
	{
		if ( before[slot] == kNoNode )
		{
			come.push_back( slot );
		}
		isDirty[slot] = before[slot] == kNoNode || old.width[before[slot]] != regions.width[slot];
		limit = std::max( limit, limitOf( regions.width[slot], regions.eps ) );
	}
	for ( const std::uint32_t width : old.width )
	{
		limit = std::max( limit, limitOf( width, old.eps ) );
	}
	BucketMoore search;
	for ( const BucketMoore::Reached& r : search.fromAll( from, gone, limit ) )
	{
		if ( after[r.node] != kNoNode && r.distance < limitOf( old.width[r.node], old.eps ) )
		{
			isDirty[after[r.node]] = 1;
		}
	}
	for ( const BucketMoore::Reached& r : search.fromAll( to.graph, come, limit ) )
	{
		isDirty[r.node] |= r.distance < limitOf( regions.width[r.node], regions.eps );
	}
	std::vector<std::uint32_t> slots;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( isDirty.size() ); ++slot )
	{
		if ( isDirty[slot] != 0 )
		{
			slots.push_back( slot );
		}
	}
	return slots;
}

} // namespace

std::vector<std::uint32_t> intervalWidths( const Octree& octree, const Cut& cut, const std::vector<float>& halfWidthOfCell )
{
	std::vector<std::uint32_t> width;
	width.reserve( cut.node.size() );
	for ( const std::uint32_t node : cut.node )
	{
		double sum = 0.0;
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			sum += double( halfWidthOfCell[octree.cells[k]] );
		}
		width.push_back( std::uint32_t( std::round( spacingOf( octree, node ) * std::max( 1.0, sum / octree.cellCount[node] ) ) ) );
	}
	return width;
}

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

std::vector<std::uint32_t> constantWidths( const Octree& octree, const Cut& cut, float halfWidth )
{
	std::vector<std::uint32_t> width;
	width.reserve( cut.node.size() );
	for ( const std::uint32_t node : cut.node )
	{
		width.push_back( std::uint32_t( std::round( std::max( spacingOf( octree, node ), kUnitsPerCell * double( halfWidth ) ) ) ) );
	}
	return width;
}

IntervalRegions findIntervalRegions( const IntervalInput& input, std::vector<std::uint32_t> width, float eps, TaskRunner* runner )
{
	IntervalRegions regions;
	regions.eps = eps;
	regions.width = std::move( width );
	std::vector<std::uint32_t> slots( input.cut.node.size() );
	for ( std::uint32_t slot = 0; slot < std::uint32_t( slots.size() ); ++slot )
	{
		slots[slot] = slot;
	}
	Rows rows = searchRows( input, regions, slots, runner );
	regions.ownStart = std::move( rows.start );
	regions.own = std::move( rows.entry );
	symmetrize( input, regions );
	return regions;
}

IntervalUpdate updateIntervalRegions( const IntervalInput& to, const VisibilityUpdate& change, const VisibilityGraph& from,
                                      const IntervalRegions& old, std::vector<std::uint32_t> width, TaskRunner* runner )
{
	IntervalUpdate update;
	IntervalRegions& regions = update.regions;
	regions.eps = old.eps;
	regions.width = std::move( width );
	update.searched = slotsToSearch( to, change, from, old, regions );
	const Rows rows = searchRows( to, regions, update.searched, runner );
	regions.ownStart.assign( 1, 0 );
	std::size_t next = 0;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( to.cut.count() ); ++slot )
	{
		// Octree nodes keep their ids: a row that no change has touched stays as it is.
		const bool isAnew = next < update.searched.size() && update.searched[next] == slot;
		const std::size_t row = isAnew ? next++ : change.change.before[slot];
		const std::vector<std::uint32_t>& start = isAnew ? rows.start : old.ownStart;
		const std::vector<std::uint32_t>& entry = isAnew ? rows.entry : old.own;
		regions.own.insert( regions.own.end(), entry.begin() + start[row], entry.begin() + start[row + 1] );
		regions.ownStart.push_back( std::uint32_t( regions.own.size() ) );
	}
	symmetrize( to, regions );
	return update;
}

} // namespace pliant
