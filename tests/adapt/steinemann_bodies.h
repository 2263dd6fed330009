#pragma once

// Bodies and cuts for the tests of Steinemann et al. 2008.

#include "adapt/regions/interval_regions.h"
#include "support/shapes.h"

#include <vector>

namespace pliant::test {

/// A palm with fingers one cell thick and one empty cell apart.
inline Lattice makeFingers( int palm, int fingers, int length )
{
	const Eigen::Vector3i extent( 2 * fingers - 1, palm, palm + length );
	return makeShapeLattice( extent, 0.1f, [=]( int x, int y, int z ) { return z < palm || ( x % 2 == 0 && y < 2 ); } );
}

inline Lattice makeRandomBlob( unsigned seed, int cells = 14 )
{
	std::mt19937 random( seed );
	return makeBlobLattice( cells, 0.1f, seed, 5, [&random]( int, int ) { return random() % 6 != 0; } );
}

/// A random cut that can be changed a little: a switch for each octree node.
struct RandomCut
{
	RandomCut( const Octree& tree, unsigned seed ) : octree( tree ), random( seed ), keeps( tree.parent.size() )
	{
		for ( std::uint8_t& k : keeps )
		{
			k = random() % 3 == 0;
		}
	}

	Cut cut() const
	{
		return selectCut( octree, [this]( std::uint32_t n ) { return n >= octree.levelStart[1] && keeps[n] != 0; } );
	}

	/// Toggles some switches of coarse nodes: splits and merges, over several levels at once among them.
	void turn( int switches )
	{
		const std::uint32_t coarse = std::uint32_t( octree.nodeCount() ) - octree.levelStart[1];
		for ( int k = 0; k < switches && coarse > 0; ++k )
		{
			keeps[octree.levelStart[1] + std::uint32_t( random() % coarse )] ^= 1;
		}
	}

	const Octree& octree;
	std::mt19937 random;
	std::vector<std::uint8_t> keeps;
};

} // namespace pliant::test
