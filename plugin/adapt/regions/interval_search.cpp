#include "adapt/regions/interval_search.h"

#include "adapt/constants.h"
#include "adapt/octree/bucket_moore.h"
#include "threads/parallel.h"

namespace pliant {

namespace {

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

} // namespace

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

} // namespace pliant
