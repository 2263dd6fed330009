// Links that are too long. Ohta et al. 2009, "Fracturing".

#include "fracture/link_limits.h"
#include "support/block_body.h"
#include "support/block_lattice.h"

#include <gtest/gtest.h>

#include <limits>

namespace pliant {
namespace {

void stretchAlongX( NodeState& nodes, float by )
{
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.x[std::size_t( i )] *= by;
	}
}

TEST( LinkLimits, BreakAtTheirStrainInEveryDirectionAndNotBefore )
{
	const Lattice block = makeBlockLattice( 3, 3, 3, 0.1f );
	const LinkLimits limits = limitLinks( block, 0.2f, {} );
	EXPECT_EQ( limits.to.size(), std::size_t( block.linkCount() ) );
	std::vector<CellLink> found;
	NodeState nodes = test::restNodes( block );
	findOverstretched( limits, nodes, found );
	EXPECT_TRUE( found.empty() );
	stretchAlongX( nodes, 1.199f );
	findOverstretched( limits, nodes, found );
	EXPECT_TRUE( found.empty() );
	// Along x only: a diagonal link is stretched less than the body is.
	nodes = test::restNodes( block );
	stretchAlongX( nodes, 1.201f );
	findOverstretched( limits, nodes, found );
	EXPECT_EQ( found.size(), 18u ); // two along x in each of nine rows
	for ( const CellLink& link : found )
	{
		EXPECT_EQ( link.b - link.a, 1u );
	}
	// ( 1.2^2 - 1 ) 2 + 1 = s^2: now the face diagonals too; ( 1.2^2 - 1 ) 3 + 1: those through the cells' corners.
	for ( const auto& [stretch, links] : { std::pair{ 1.372f, 18u + 2u * 24u }, std::pair{ 1.525f, 18u + 2u * 24u + 2u * 16u } } )
	{
		nodes = test::restNodes( block );
		stretchAlongX( nodes, stretch );
		found.clear();
		findOverstretched( limits, nodes, found );
		EXPECT_EQ( found.size(), links );
	}
}

TEST( LinkLimits, ToughnessScalesTheStrainAndInfinityNeverBreaks )
{
	const Lattice bar = makeBlockLattice( 4, 1, 1, 0.1f );
	const LinkLimits limits = limitLinks( bar, 0.1f, { 1.0f, 3.0f, std::numeric_limits<float>::infinity() } );
	NodeState nodes = test::restNodes( bar );
	stretchAlongX( nodes, 1.2f );
	std::vector<CellLink> found;
	findOverstretched( limits, nodes, found );
	ASSERT_EQ( found.size(), 1u );
	EXPECT_EQ( found[0].a, 0u );
	stretchAlongX( nodes, 1000.0f );
	found.clear();
	findOverstretched( limits, nodes, found );
	EXPECT_EQ( found.size(), 2u );
}

TEST( LinkLimits, PiecesKeepTheirLinksToughness )
{
	const Lattice bar = makeBlockLattice( 5, 2, 1, 0.1f );
	std::vector<float> toughness;
	for ( int k = 0; k < bar.linkCount(); ++k )
	{
		toughness.push_back( float( k + 1 ) );
	}
	const LinkLimits limits = limitLinks( bar, 0.1f, toughness );
	std::vector<CellLink> cut;
	for ( std::uint32_t i = 0; i < std::uint32_t( bar.cellCount() ); ++i )
	{
		for ( std::uint32_t k = limits.start[i]; k < limits.start[i + 1]; ++k )
		{
			if ( ( bar.coordinate[i].x() < 2 ) != ( bar.coordinate[limits.to[k]].x() < 2 ) )
			{
				cut.push_back( CellLink{ i, limits.to[k] } );
			}
		}
	}
	const Lattice open = withoutLinks( bar, cut );
	for ( const auto& cells : connectedParts( open ) )
	{
		const Lattice part = extractCells( open, cells );
		const LinkLimits now = limitLinks( part, 0.1f, inheritToughness( limits, part, cells ) );
		ASSERT_EQ( now.toughness.size(), std::size_t( part.linkCount() ) );
		const LinkLimits inherited = inheritLimits( limits, part, cells, 0.1f ); // the fast computation
		EXPECT_EQ( inherited.start, now.start );
		EXPECT_EQ( inherited.to, now.to );
		EXPECT_EQ( inherited.toughness, now.toughness );
		EXPECT_EQ( inherited.weakest, now.weakest );
		for ( std::uint32_t i = 0; i < std::uint32_t( part.cellCount() ); ++i )
		{
			for ( std::uint32_t k = now.start[i]; k < now.start[i + 1]; ++k )
			{
				const auto row = limits.to.begin() + limits.start[cells[i]];
				const auto old = std::find( row, limits.to.begin() + limits.start[cells[i] + 1], cells[now.to[k]] ) - limits.to.begin();
				EXPECT_EQ( now.toughness[k], limits.toughness[std::size_t( old )] );
				EXPECT_FLOAT_EQ( now.lengthSquared[k], limits.lengthSquared[std::size_t( old )] );
				EXPECT_EQ( inherited.lengthSquared[k], limits.lengthSquared[std::size_t( old )] );
			}
		}
	}
}

} // namespace
} // namespace pliant
