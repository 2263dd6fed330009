// Ohta's regions as a matrix: Ohta et al. 2009, "Preprocessing" and eq. 6.

#include "adapt/constants.h"
#include "adapt/regions/region_matrix.h"

#include <algorithm>

namespace pliant {

namespace {

/// The unions as a pattern: rows, the mass m( a, r ) of each member in each, and W_a = sum over r of m_r m( a, r ) / m_a. Full cells.
struct UnionPattern
{
	RegionMatrix matrix; ///< start and member only
	std::vector<double> value, cover;
};

UnionPattern findUnions( const Octree& octree, const Cut& cut, const FineRegions& fine )
{
	// Each cell counts once, regardless of the number of fine regions under r that hold it.
	const std::uint32_t count = std::uint32_t( cut.count() );
	UnionPattern pattern;
	pattern.matrix.start.push_back( 0 );
	pattern.cover.assign( count, 0.0 );
	std::vector<std::uint32_t> seenBy( octree.cells.size(), kNoNode ), members;
	std::vector<double> covered( count, 0.0 );
	for ( std::uint32_t r = 0; r < count; ++r )
	{
		const std::uint32_t node = cut.node[r];
		members.clear();
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			for ( std::uint32_t m = fine.set.start[octree.cells[k]]; m < fine.set.start[octree.cells[k] + 1]; ++m )
			{
				const std::uint32_t cell = fine.set.member[m], slot = cut.slotOfCell[cell];
				if ( seenBy[cell] == r )
				{
					continue;
				}
				seenBy[cell] = r;
				if ( covered[slot] == 0.0 )
				{
					members.push_back( slot );
				}
				covered[slot] += octree.mass[cell]; // node i of level 0 is cell i
			}
		}
		std::sort( members.begin(), members.end() );
		for ( const std::uint32_t a : members )
		{
			pattern.matrix.member.push_back( a );
			pattern.value.push_back( covered[a] );
			pattern.cover[a] += octree.mass[node] * covered[a] / octree.mass[cut.node[a]];
			covered[a] = 0.0;
		}
		pattern.matrix.start.push_back( std::uint32_t( pattern.matrix.member.size() ) );
	}
	return pattern;
}

} // namespace

RegionMatrix buildUnionRegions( const Octree& octree, const Cut& cut, const FineRegions& fine, UnionWeights weights )
{
	const std::uint32_t count = std::uint32_t( cut.count() );
	UnionPattern pattern = findUnions( octree, cut, fine );
	RegionMatrix& matrix = pattern.matrix;
	matrix.mass.resize( matrix.member.size() );
	matrix.fraction.resize( matrix.member.size() );
	for ( std::uint32_t r = 0; r < count; ++r )
	{
		const double ofRegion = octree.mass[cut.node[r]];
		for ( std::uint32_t k = matrix.start[r]; k < matrix.start[r + 1]; ++k )
		{
			const std::uint32_t a = matrix.member[k];
			const auto first = matrix.member.begin() + matrix.start[a], last = matrix.member.begin() + matrix.start[a + 1];
			const std::size_t back = std::size_t( std::lower_bound( first, last, r ) - matrix.member.begin() ); // exists by symmetry
			if ( weights == UnionWeights::Conserving )
			{
				matrix.mass[k] = inMassUnits( ofRegion * pattern.value[k] / pattern.cover[a] );
				matrix.fraction[back] = matrix.mass[k];
			}
			else
			{
				matrix.mass[k] = inMassUnits( pattern.value[k] );
				matrix.fraction[back] = inMassUnits( ofRegion * pattern.value[k] / octree.mass[cut.node[a]] );
			}
		}
	}
	matrix.unit.assign( count, kMassUnit );
	if ( weights == UnionWeights::Conserving )
	{
		weighUnits( octree, cut, matrix );
	}
	return std::move( pattern.matrix );
}

} // namespace pliant
