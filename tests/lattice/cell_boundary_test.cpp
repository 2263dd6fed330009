// The closed surfaces of a lattice's cells.

#include "lattice/faces/cell_boundary.h"
#include "support/block_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace pliant {
namespace {

/// The same lattice with the selected cells and links only.
Lattice reduced( const Lattice& from, const std::function<bool( int )>& hasCell, const std::function<bool( int, int )>& hasLink )
{
	Lattice to = from;
	std::vector<std::uint32_t> now( from.fill.size(), 0xffffffffu );
	to.coordinate.clear();
	to.fill.clear();
	to.restCentre.clear();
	to.isSurface.clear();
	for ( int i = 0; i < from.cellCount(); ++i )
	{
		if ( hasCell( i ) )
		{
			now[std::size_t( i )] = std::uint32_t( to.fill.size() );
			to.coordinate.push_back( from.coordinate[std::size_t( i )] );
			to.fill.push_back( from.fill[std::size_t( i )] );
			to.restCentre.push_back( from.restCentre[std::size_t( i )] );
			to.isSurface.push_back( 1 );
		}
	}
	to.linkStart.assign( 1, 0 );
	to.linkTo.clear();
	for ( int i = 0; i < from.cellCount(); ++i )
	{
		for ( std::uint32_t k = from.linkStart[std::size_t( i )]; hasCell( i ) && k < from.linkStart[std::size_t( i ) + 1]; ++k )
		{
			const int j = int( from.linkTo[k] );
			if ( hasCell( j ) && hasLink( i, j ) )
			{
				to.linkTo.push_back( now[std::size_t( j )] );
			}
		}
		if ( hasCell( i ) )
		{
			to.linkStart.push_back( std::uint32_t( to.linkTo.size() ) );
		}
	}
	return to;
}

bool all( int )
{
	return true;
}

bool allLinks( int, int )
{
	return true;
}

/// Every edge is traversed equally often in both directions.
bool isClosed( const CellBoundary& boundary )
{
	std::vector<std::pair<std::uint32_t, std::uint32_t>> forward, backward;
	for ( const auto& quad : boundary.quads )
	{
		for ( std::size_t k = 0; k < 4; ++k )
		{
			forward.emplace_back( quad[k], quad[( k + 1 ) % 4] );
			backward.emplace_back( quad[( k + 1 ) % 4], quad[k] );
		}
	}
	std::sort( forward.begin(), forward.end() );
	std::sort( backward.begin(), backward.end() );
	return forward == backward;
}

TEST( CellBoundary, OfABlockIsItsBox )
{
	const CellBoundary boundary = findBoundary( makeBlockLattice( 3, 2, 4, 0.5f ) );
	EXPECT_EQ( boundary.surfaceCount(), 1 );
	EXPECT_EQ( boundary.quads.size(), 2u * ( 3 * 2 + 2 * 4 + 3 * 4 ) );
	EXPECT_EQ( boundary.pointCount(), 4 * 3 * 5 - 2 * 1 * 3 );
	EXPECT_NEAR( boundary.restVolume[0], 3.0, 1e-6 );
	EXPECT_NEAR( boundary.displaced, 1.0, 1e-6 );
	EXPECT_TRUE( isClosed( boundary ) );
	for ( int p = 0; p < boundary.pointCount(); ++p )
	{
		EXPECT_LE( std::abs( boundary.restPosition[std::size_t( p )].y() ), 0.5f + 1e-6f );
	}
}

TEST( CellBoundary, HasASurfaceAroundEachCavity )
{
	const Lattice block = makeBlockLattice( 3, 3, 5, 0.5f );
	const auto isHole = [&block]( int i ) {
		const auto& at = block.coordinate[std::size_t( i )];
		return at.x() == 1 && at.y() == 1 && ( at.z() == 1 || at.z() == 3 );
	};
	const CellBoundary boundary = findBoundary( reduced(
		block, [&]( int i ) { return !isHole( i ); }, allLinks ) );
	ASSERT_EQ( boundary.surfaceCount(), 3 );
	std::vector<double> volumes = boundary.restVolume;
	std::sort( volumes.begin(), volumes.end() );
	EXPECT_NEAR( volumes[0], -0.125, 1e-6 );
	EXPECT_NEAR( volumes[1], -0.125, 1e-6 );
	EXPECT_NEAR( volumes[2], 45 * 0.125, 1e-5 );
	EXPECT_TRUE( isClosed( boundary ) );
	EXPECT_NEAR( boundary.displaced, 1.0, 1e-6 );
}

TEST( CellBoundary, ACutHasTwoSidesAndAnOpenedCavityIsNone )
{
	const Lattice block = makeBlockLattice( 3, 3, 3, 1.0f );
	const auto sideOf = [&block]( int i ) { return block.coordinate[std::size_t( i )].z() > 1; };
	const CellBoundary cut = findBoundary( reduced( block, all, [&]( int i, int j ) { return sideOf( i ) == sideOf( j ); } ) );
	ASSERT_EQ( cut.surfaceCount(), 2 );
	EXPECT_NEAR( std::max( cut.restVolume[0], cut.restVolume[1] ), 18, 1e-5 );
	EXPECT_NEAR( std::min( cut.restVolume[0], cut.restVolume[1] ), 9, 1e-5 );
	EXPECT_TRUE( isClosed( cut ) );
	// A shaft from the centre to the outside.
	const auto isShaft = [&block]( int i ) {
		const auto& at = block.coordinate[std::size_t( i )];
		return at.x() == 1 && at.y() == 1 && at.z() > 0;
	};
	const CellBoundary open = findBoundary( reduced(
		block, [&]( int i ) { return !isShaft( i ); }, allLinks ) );
	EXPECT_EQ( open.surfaceCount(), 1 );
	EXPECT_NEAR( open.restVolume[0], 25, 1e-5 );
}

TEST( CellBoundary, WallsThatMeetAtEdgesKeepInsideAndOutsideApart )
{
	// A ring of four cells that touch at edges only, closed above and below: its middle is a cavity.
	const Lattice block = makeBlockLattice( 3, 3, 3, 1.0f );
	const auto isThere = [&block]( int i ) {
		const auto& at = block.coordinate[std::size_t( i )];
		const bool isRing = at.z() == 1 && ( at.x() == 1 ) != ( at.y() == 1 );
		return isRing || ( at.z() != 1 && at.x() == 1 && at.y() == 1 );
	};
	const CellBoundary boundary = findBoundary( reduced( block, isThere, allLinks ) );
	ASSERT_EQ( boundary.surfaceCount(), 2 );
	EXPECT_NEAR( std::min( boundary.restVolume[0], boundary.restVolume[1] ), -1, 1e-5 );
	const CellBoundary loose = findBoundary( reduced( block, isThere, []( int, int ) { return false; } ) );
	EXPECT_EQ( loose.surfaceCount(), 6 ) << "six cells, each by itself";
}

} // namespace
} // namespace pliant
