#include "adapt/moments/fine_update.h"

#include "adapt/constants.h"
#include "lattice/reach.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace pliant {

namespace {

/// Appends the rows of cells `cell` to `end` - 1, which are unchanged.
void appendRows( const FineRegions& before, const CellChange& change, const OctreeUpdate& tree, std::uint32_t cell, std::uint32_t end,
	FineRegions& fine )
{
	if ( change.isWhole() ) // same numbers: copied in one run
	{
		const RegionSet& set = before.set;
		const std::uint32_t moved = std::uint32_t( fine.set.member.size() ) - set.start[cell]; // wraps where preceding rows shrank
		const auto from = []( const auto& array, std::uint32_t k ) { return array.begin() + std::ptrdiff_t( k ); };
		fine.set.member.insert( fine.set.member.end(), from( set.member, set.start[cell] ), from( set.member, set.start[end] ) );
		fine.set.size.insert( fine.set.size.end(), from( set.size, cell ), from( set.size, end ) );
		fine.mass.insert( fine.mass.end(), from( before.mass, cell ), from( before.mass, end ) );
		std::transform( from( set.start, cell + 1 ), from( set.start, end + 1 ), std::back_inserter( fine.set.start ),
			[moved]( std::uint32_t k ) { return k + moved; } );
		return;
	}
	for ( ; cell < end; ++cell )
	{
		const std::uint32_t old = change.cellBefore[cell];
		const auto first = before.set.member.begin() + before.set.start[old], last = before.set.member.begin() + before.set.start[old + 1];
		const std::size_t at = fine.set.member.size();
		fine.set.member.insert( fine.set.member.end(), first, last );
		for ( std::size_t k = at; !change.isWhole() && k < fine.set.member.size(); ++k )
		{
			fine.set.member[k] = tree.nodeNow[fine.set.member[k]];
		}
		fine.set.start.push_back( std::uint32_t( fine.set.member.size() ) );
		fine.set.size.push_back( before.set.size[old] );
		fine.mass.push_back( before.mass[old] );
	}
}

} // namespace

FineUpdate updateFineRegions( const FineRegions& before, const CellChange& change, const OctreeUpdate& tree, FineRegions scratch )
{
	FineUpdate update;
	FineRegions& fine = update.fine;
	fine = std::move( scratch );
	fine.set.start.clear();
	fine.set.member.clear();
	fine.set.size.clear();
	fine.mass.clear();
	const std::uint32_t cells = std::uint32_t( change.now.cellCount() );
	Reach reach( change.now );
	// A region of w links changes where a link changed that starts within w - 1 current links: on a path that no longer exists, the first
	// broken link is still reachable.
	update.collected = reach.from( change.touched, before.set.halfWidth - 1 );
	fine.set.halfWidth = before.set.halfWidth;
	fine.set.start.reserve( std::size_t( cells ) + 1 );
	fine.set.start.push_back( 0 );
	fine.set.member.reserve( before.set.member.size() );
	fine.set.size.reserve( cells );
	fine.mass.reserve( cells );
	std::uint32_t next = 0;
	for ( const std::uint32_t cell : update.collected )
	{
		appendRows( before, change, tree, next, cell, fine );
		const std::vector<std::uint32_t>& found = reach.from( cell, before.set.halfWidth );
		fine.set.member.insert( fine.set.member.end(), found.begin(), found.end() );
		fine.set.start.push_back( std::uint32_t( fine.set.member.size() ) );
		fine.set.size.push_back( std::uint16_t( found.size() ) );
		fine.mass.push_back( inMassUnits( double( change.now.fill[cell] ) / double( found.size() ) ) );
		next = cell + 1;
	}
	appendRows( before, change, tree, next, cells, fine );
	return update;
}

namespace {

/// Moves the moments of nodes to their new indices. Those of cells are most of the data; a cell's number never increases, so they can be
/// moved in place.
FineMoments moveMoments( const FineMoments& before, FineMoments reused, const CellChange& change, const OctreeUpdate& tree )
{
	const std::size_t nodes = tree.octree.parent.size(), cells = tree.octree.levelStart[1],
					  cellsBefore = std::size_t( change.before.cellCount() );
	const bool isInPlace = !reused.covariance.empty();
	const auto& from = reused.covariance.empty() ? before.covariance : reused.covariance;
	FineMoments moments;
	decltype( moments.covariance ) above;
	if ( isInPlace )
	{
		above.assign( from.begin() + std::ptrdiff_t( cellsBefore ), from.end() );
		moments = std::move( reused );
		for ( std::size_t n = 0; n < cells && !change.isWhole(); ++n )
		{
			moments.covariance[n] = moments.covariance[tree.nodeBefore[n]];
		}
		moments.covariance.resize( cells );
	}
	const auto& old = isInPlace ? above : from;
	const std::size_t first = moments.covariance.size(), oldFirst = isInPlace ? cellsBefore : 0;
	if ( moments.covariance.capacity() < nodes ) // nearly every update adds nodes, and a reallocation copies all
	{
		moments.covariance.reserve( std::size_t( kMomentsCapacity * double( nodes ) ) );
	}
	for ( std::size_t n = first; n < nodes; ++n )
	{
		if ( tree.nodeBefore[n] != kNoNode )
		{
			moments.covariance.push_back( old[tree.nodeBefore[n] - oldFirst] );
		}
		else
		{
			moments.covariance.emplace_back();
		}
	}
	return moments;
}

} // namespace

FineMoments updateFineMoments(
	const FineMoments& before, FineMoments reused, const CellChange& change, const OctreeUpdate& tree, const FineUpdate& update )
{
	const Octree& octree = tree.octree;
	const RegionSet& set = update.fine.set;
	FineMoments moments = moveMoments( before, std::move( reused ), change, tree );
	std::vector<std::uint8_t> isOld( octree.parent.size(), 1 ); // 0: to be measured again
	for ( const std::uint32_t cell : update.collected )
	{
		for ( std::uint32_t k = set.start[cell]; k < set.start[cell + 1]; ++k ) // the cell, and all in whose regions its weight changed
		{
			isOld[set.member[k]] = 0;
		}
	}
	for ( std::uint32_t n = 0; n < std::uint32_t( octree.nodeCount() ); ++n ) // children precede their parents
	{
		if ( isOld[n] != 0 && tree.nodeBefore[n] != kNoNode )
		{
			continue;
		}
		if ( n < octree.levelStart[1] )
		{
			measureFineRegion( change.now, update.fine, n, moments );
		}
		else
		{
			sumFineMoments( octree, change.now, n, moments );
		}
		if ( octree.parent[n] != kNoNode )
		{
			isOld[octree.parent[n]] = 0;
		}
	}
	return moments;
}

} // namespace pliant
