// Cells that may break, and cells that break at twice the strain because of their neighbours.

#include "body/levels/level_nodes.h"
#include "fracture/cell_positions.h"
#include "fracture/link_limits.h"
#include "lattice/pieces.h"
#include "support/block_lattice.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pliant {
namespace {

TEST( CellRefinementStates, AreTheSameRememberedOrLookedAtAnew )
{
	std::mt19937 random( 3 );
	Lattice lattice = makeBlockLattice( 12, 8, 8, 0.05f );
	const Octree octree = buildOctree( lattice, 2 );
	std::vector<std::uint8_t> isSplit( octree.parent.size(), 0 );
	const auto cutNow = [&] { return selectCut( octree, [&]( std::uint32_t node ) { return isSplit[node] == 0; } ); };
	Cut cut = cutNow();
	CellRefinementStates kept;
	unsigned version = 0;
	int changed = 0;
	std::size_t fewest = lattice.fill.size(), most = 0;
	std::vector<CellRefinementState> last;
	for ( int step = 0; step < 200; ++step )
	{
		if ( step % 23 == 5 ) // nodes are split, or merged again
		{
			for ( std::uint32_t node = octree.levelStart[1]; node < std::uint32_t( isSplit.size() ); ++node )
			{
				isSplit[node] = random() % 8 != 0;
			}
			cut = cutNow();
			++version;
		}
		if ( step % 31 == 17 ) // links go
		{
			std::vector<CellLink> gone;
			for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice.cellCount() ); ++cell )
			{
				for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
				{
					if ( lattice.linkTo[k] > cell && random() % 2 == 0 )
					{
						gone.push_back( CellLink{ cell, lattice.linkTo[k] } );
					}
				}
			}
			lattice = withoutLinks( lattice, gone );
			kept.forget();
		}
		CellRefinementStates anew;
		const std::vector<CellRefinementState> wanted = anew.update( lattice, cut, version );
		const std::vector<CellRefinementState>& got = kept.update( lattice, cut, version );
		ASSERT_EQ( got, wanted ) << "step " << step;
		changed += got != last ? 1 : 0;
		last = got;
		const std::size_t count = std::size_t( std::count( got.begin(), got.end(), CellRefinementState::AmongFine ) );
		fewest = std::min( fewest, count );
		most = std::max( most, count );
	}
	EXPECT_GT( changed, 10 );
	EXPECT_GT( most, fewest + 100 );
}

/// A bar of cells along x, the lower half of which consists of nodes of eight cells.
struct HalfBig
{
	Lattice lattice = makeBlockLattice( 8, 2, 2, 1.0f );
	Octree octree = buildOctree( lattice, 1 );
	Cut cut = selectCut( octree, [&]( std::uint32_t node ) { return octree.levelOf( node ) == 1 && octree.restCentre[node].x() < 0.0f; } );
};

TEST( CellRefinementStates, SayWhatACellIsAndWhatIsBesideIt )
{
	HalfBig bar;
	CellRefinementStates refinementStates;
	const std::vector<CellRefinementState>& standing = refinementStates.update( bar.lattice, bar.cut, 0 );
	ASSERT_EQ( bar.cut.count(), 2 + 16 );
	for ( std::size_t cell = 0; cell < standing.size(); ++cell )
	{
		const float x = bar.lattice.restCentre[cell].x();
		EXPECT_EQ( standing[cell],
			x < 0.0f       ? CellRefinementState::InCoarse
				: x < 1.0f ? CellRefinementState::NextToCoarse
						   : CellRefinementState::AmongFine )
			<< x;
	}
}

// Links of length 1 that may be stretched by a tenth; next to coarse nodes by two tenths, and inside of them by any amount.
TEST( CellRefinementStates, LinksBesideBigNodesBearTwiceTheStrain )
{
	HalfBig bar;
	const LinkLimits limits = limitLinks( bar.lattice, 0.1f, {} );
	CellRefinementStates refinementStates;
	const std::vector<CellRefinementState>& standing = refinementStates.update( bar.lattice, bar.cut, 0 );
	for ( const float strain : { 0.05f, 0.11f, 0.19f, 0.21f } )
	{
		NodeState nodes;
		resizeNodes( nodes, bar.cut.count() );
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3 rest = bar.octree.restCentre[bar.cut.node[i]];
			nodes.x0.set( i, rest );
			nodes.x.set( i, Vec3( rest.x() * ( 1.0f + strain ), rest.y(), rest.z() ) );
		}
		std::vector<CellLink> found;
		findOverstretched( limits, CellPositions( nodes, bar.cut, standing ), found );
		int alongHere = 0, alongBeside = 0;
		for ( const CellLink& link : found )
		{
			ASSERT_TRUE( standing[link.a] != CellRefinementState::InCoarse && standing[link.b] != CellRefinementState::InCoarse );
			const Vec3 along = bar.lattice.restCentre[link.b] - bar.lattice.restCentre[link.a];
			const bool isBeside = standing[link.a] == CellRefinementState::NextToCoarse ||
				standing[link.b] == CellRefinementState::NextToCoarse;
			( isBeside ? alongBeside : alongHere ) += along.cwiseAbs().sum() < 1.5f ? 1 : 0;
		}
		EXPECT_EQ( alongHere, strain > 0.1f ? 8 : 0 ) << strain;   // four a layer, between the third fine layer and the fourth, and ...
		EXPECT_EQ( alongBeside, strain > 0.2f ? 4 : 0 ) << strain; // ... between the first, which is next to coarse nodes, and the second
	}
}

} // namespace
} // namespace pliant
