#include "adapt/regions/interval_regions.h"

#include "adapt/regions/interval_search.h"
#include "lattice/table.h"

#include <iterator>

namespace pliant {

namespace {

/// 2^l cells, in half cells.
double spacingOf( const Octree& octree, std::uint32_t node )
{
	return kUnitsPerCell * std::ldexp( 1.0, octree.levelOf( node ) );
}

/// Returns the simulation nodes of each row. Rows and slots are in depth-first order, so the result is ascending.
Rows spread( const IntervalInput& input, const std::vector<std::uint32_t>& start, const std::vector<std::uint32_t>& node )
{
	Rows rows;
	const std::vector<SlotSpan> spans = slotSpans( input.octree, input.cut );
	rows.start.reserve( start.size() );
	for ( std::size_t r = 0; r + 1 < start.size(); ++r )
	{
		for ( std::uint32_t k = start[r]; k < start[r + 1]; ++k )
		{
			const SlotSpan span = spans[node[k]];
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
			regions.node.insert(
				regions.node.end(), regions.own.begin() + regions.ownStart[r], regions.own.begin() + regions.ownStart[r + 1] );
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
	Rows rows = searchRows( input, regions, runner );
	regions.ownStart = std::move( rows.start );
	regions.own = std::move( rows.entry );
	symmetrize( input, regions );
	return regions;
}

} // namespace pliant
