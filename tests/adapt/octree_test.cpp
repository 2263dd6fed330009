// The octree and cuts through it: Steinemann et al. 2008, section 4.1; Ohta et al. 2009, "Preprocessing".

#include "adapt/constants.h"
#include "adapt/octree/cut.h"
#include "support/block_lattice.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

using test::makeBlobLattice;
using test::makeShapeLattice;

TEST( Octree, KeepsItsInvariantsOnShapesWithCutLinks )
{
	for ( unsigned seed = 1; seed <= 8; ++seed )
	{
		std::mt19937 random( seed );
		const Lattice lattice = makeBlobLattice( 15, 0.1f, seed, 6, [&random]( int, int ) { return random() % 4 != 0; } );
		ASSERT_TRUE( validate( lattice ).ok() );
		for ( int levels = 0; levels <= kMaxCoarseLevels; ++levels )
		{
			const Octree octree = buildOctree( lattice, levels );
			EXPECT_TRUE( validate( octree, lattice ).ok() ) << validate( octree, lattice ).sentence;
			EXPECT_EQ( octree.levels, levels + 1 );
		}
	}
}

TEST( Octree, OfACubeHalvesItsEdgeEachLevel )
{
	const Octree octree = buildOctree( makeBlockLattice( 8, 8, 8, 0.5f ), 3 );
	ASSERT_EQ( octree.nodeCount(), 512 + 64 + 8 + 1 );
	EXPECT_DOUBLE_EQ( octree.mass.back(), 512.0 );
	// Second moment of n points a cell apart along an edge: (n^2 - 1) / 12.
	EXPECT_NEAR( octree.spread.back()[0], 63.0 / 12.0, 1e-5 );
	EXPECT_NEAR( octree.spread[512][2], 3.0 / 12.0, 1e-6 );
	EXPECT_NEAR( octree.spread[512][5], 0.0, 1e-6 );
}

TEST( Octree, WhatABlockHoldsInTwoUnconnectedPartsIsTwoNodes )
{
	// Two plates with an empty layer between them, both within one block of level 2.
	const Lattice lattice = makeShapeLattice( { 4, 4, 4 }, 1.0f, []( int, int, int z ) { return z == 0 || z == 3; } );
	const Octree octree = buildOctree( lattice, 2 );
	EXPECT_EQ( octree.levelStart[3] - octree.levelStart[2], 2u );
	EXPECT_DOUBLE_EQ( octree.mass[octree.levelStart[2]], 16.0 );
}

TEST( Cut, ByMassAndInsideCoverEveryCellOnce )
{
	const Lattice lattice = makeBlobLattice( 20, 0.1f, 3 );
	const Octree octree = buildOctree( lattice, 3 );
	for ( const float fraction : { 0.25f, 0.5f, 1.0f } )
	{
		const Cut cut = selectCut( octree, keepsByMass( octree, fraction ) );
		EXPECT_TRUE( validate( cut, octree ).ok() ) << validate( cut, octree ).sentence;
		for ( const std::uint32_t node : cut.node )
		{
			const int level = octree.levelOf( node );
			EXPECT_TRUE( level == 0 || octree.mass[node] >= fraction * std::pow( 8.0, level ) );
		}
	}
	const Cut inside = selectCut( octree, [&octree]( std::uint32_t node ) { return octree.isSurface[node] == 0; } );
	EXPECT_TRUE( validate( inside, octree ).ok() );
	EXPECT_LT( inside.count(), lattice.cellCount() );
	for ( const std::uint32_t node : inside.node )
	{
		EXPECT_TRUE( octree.isSurface[node] == 0 || octree.levelOf( node ) == 0 );
	}
}

TEST( Cut, ChangedAndChangedBackIsTheSame )
{
	const Lattice lattice = makeBlobLattice( 16, 0.1f, 5 );
	const Octree octree = buildOctree( lattice, 3 );
	const Cut cut = selectCut( octree, keepsByMass( octree, 0.5f ) );
	std::vector<std::uint32_t> split;
	for ( const std::uint32_t node : cut.node )
	{
		if ( octree.levelOf( node ) > 0 && split.size() < 9 )
		{
			split.push_back( node );
		}
	}
	const Cut finer = changeCut( octree, cut, split, {} );
	ASSERT_TRUE( validate( finer, octree ).ok() );
	EXPECT_GT( finer.count(), cut.count() );
	const Cut back = changeCut( octree, finer, {}, split );
	EXPECT_EQ( back.node, cut.node );
	EXPECT_EQ( back.slotOfCell, cut.slotOfCell );
}

} // namespace
} // namespace pliant
