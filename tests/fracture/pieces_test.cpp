// Links removed from a lattice and restored, and the connected parts that result.

#include "lattice/pieces.h"
#include "support/block_lattice.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace pliant {
namespace {

/// All links whose cells lie on different sides of x = at.
std::vector<CellLink> linksAcross( const Lattice& lattice, int at )
{
	std::vector<CellLink> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( i < j && ( lattice.coordinate[i].x() < at ) != ( lattice.coordinate[j].x() < at ) )
			{
				links.push_back( CellLink{ i, j } );
			}
		}
	}
	return links;
}

std::vector<CellLink> someLinks( const Lattice& lattice, double fraction, unsigned seed )
{
	std::mt19937 random( seed );
	std::vector<CellLink> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			if ( i < lattice.linkTo[k] && random() < fraction * double( random.max() ) )
			{
				links.push_back( CellLink{ i, lattice.linkTo[k] } );
			}
		}
	}
	return links;
}

TEST( Pieces, ACutThroughABarLeavesTwoWholeLattices )
{
	const Lattice bar = makeBlockLattice( 6, 3, 3, 0.1f );
	const std::vector<CellLink> cut = linksAcross( bar, 4 );
	ASSERT_EQ( cut.size(), 49u ); // 9 cells a side, all pairs that touch: ( 3 * 3 - 2 )^2
	const Lattice open = withoutLinks( bar, cut );
	EXPECT_EQ( open.linkCount(), bar.linkCount() - 49 );
	EXPECT_TRUE( validate( open ).ok() ) << validate( open ).sentence;
	const auto parts = connectedParts( open );
	ASSERT_EQ( parts.size(), 2u );
	const Lattice big = extractCells( open, parts[0] ), small = extractCells( open, parts[1] );
	EXPECT_EQ( big.cellCount(), 36 );
	EXPECT_EQ( small.cellCount(), 18 );
	for ( const Lattice* part : { &big, &small } )
	{
		EXPECT_TRUE( validate( *part ).ok() ) << validate( *part ).sentence;
	}
	// Each is a block by itself, at its position.
	EXPECT_EQ( small.linkTo, makeBlockLattice( 2, 3, 3, 0.1f ).linkTo );
	EXPECT_NEAR( small.massCentre.x(), 0.2, 1e-7 );
	EXPECT_NEAR( ( small.massCentre + small.restCentre[0].cast<double>() - bar.restCentre[parts[1][0]].cast<double>() ).norm(), 0.0, 1e-7 );
}

TEST( Pieces, LinksPutBackAreAsIfTheyHadNeverBeenOut )
{
	for ( unsigned seed = 1; seed <= 40; ++seed )
	{
		const Lattice blob = test::makeBlobLattice( 9, 0.05f, seed );
		const std::vector<CellLink> out = someLinks( blob, 0.05 * double( seed % 20 ), seed );
		const Lattice open = withoutLinks( blob, out );
		ASSERT_TRUE( validate( open ).ok() ) << seed << ": " << validate( open ).sentence;
		const Lattice back = withLinks( open, out );
		EXPECT_EQ( back.linkTo, blob.linkTo ) << seed;
		EXPECT_EQ( back.linkStart, blob.linkStart ) << seed;
		EXPECT_EQ( back.isSurface, blob.isSurface ) << seed;
	}
}

/// From cell to cell: the reference implementation of connectedParts().
std::vector<std::vector<std::uint32_t>> walkedParts( const Lattice& lattice )
{
	std::vector<std::vector<std::uint32_t>> parts;
	std::set<std::uint32_t> seen;
	for ( std::uint32_t first = 0; first < std::uint32_t( lattice.cellCount() ); ++first )
	{
		if ( !seen.insert( first ).second )
		{
			continue;
		}
		std::vector<std::uint32_t> part = { first };
		for ( std::size_t k = 0; k < part.size(); ++k )
		{
			for ( std::uint32_t l = lattice.linkStart[part[k]]; l < lattice.linkStart[part[k] + 1]; ++l )
			{
				if ( seen.insert( lattice.linkTo[l] ).second )
				{
					part.push_back( lattice.linkTo[l] );
				}
			}
		}
		std::sort( part.begin(), part.end() );
		parts.push_back( std::move( part ) );
	}
	return parts;
}

TEST( Pieces, PartsAreWhatAWalkFinds )
{
	std::size_t most = 0;
	for ( unsigned seed = 1; seed <= 60; ++seed )
	{
		const Lattice blob = test::makeBlobLattice( 9, 0.05f, seed );
		const Lattice open = withoutLinks( blob, someLinks( blob, 0.5 + 0.5 * double( seed % 20 ) / 20.0, seed ) );
		const auto parts = connectedParts( open );
		ASSERT_EQ( parts, walkedParts( open ) ) << seed;
		most = std::max( most, parts.size() );
	}
	EXPECT_GT( most, 10u );
}

TEST( Pieces, PartsOfRandomCutsAreWholeAndLackNothing )
{
	for ( unsigned seed = 1; seed <= 40; ++seed )
	{
		const Lattice blob = test::makeBlobLattice( 9, 0.05f, seed );
		const Lattice open = withoutLinks( blob, someLinks( blob, 0.7 + 0.3 * double( seed % 10 ) / 10.0, seed ) );
		double mass = 0.0;
		Vec3d moment = Vec3d::Zero();
		int links = 0;
		std::set<std::uint32_t> seen;
		for ( const auto& cells : connectedParts( open ) )
		{
			const Lattice part = extractCells( open, cells );
			ASSERT_TRUE( validate( part ).ok() ) << seed << ": " << validate( part ).sentence;
			links += part.linkCount();
			for ( std::size_t i = 0; i < cells.size(); ++i )
			{
				EXPECT_TRUE( seen.insert( cells[i] ).second );
				EXPECT_EQ( part.fill[i], blob.fill[cells[i]] );
				mass += part.fill[i];
				moment += double( part.fill[i] ) * ( part.massCentre - blob.massCentre + part.restCentre[i].cast<double>() );
			}
		}
		EXPECT_EQ( int( seen.size() ), blob.cellCount() );
		EXPECT_EQ( links, open.linkCount() );
		EXPECT_NEAR( moment.norm() / mass, 0.0, 1e-7 );
	}
}

} // namespace
} // namespace pliant
