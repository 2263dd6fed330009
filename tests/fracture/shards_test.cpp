// BreakRule::Shards: the division of a body, the course of cracks, and their drawing.

#include "fracture/constants.h"
#include "fracture/shards/shard_cracks.h"
#include "lattice/pieces.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/shard_block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace pliant {
namespace {

using test::shards;
using Block = test::ShardBlock;

/// Links between cells of different shards.
std::vector<CellLink> allBorders( const Block& block )
{
	std::vector<CellLink> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( block.lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = block.lattice.linkStart[i]; k < block.lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = block.lattice.linkTo[k];
			if ( j > i && block.cracks.shards()[i] != block.cracks.shards()[j] )
			{
				links.push_back( CellLink{ i, j } );
			}
		}
	}
	return links;
}

TEST( Shards, HaveTheSizeThatWasSetAndHangTogether )
{
	for ( const float size : { 0.2f, 0.3f } )
	{
		for ( const unsigned seed : { 1u, 2u, 3u } )
		{
			Fracture fracture = shards( size );
			fracture.shardSeed = seed;
			const Block block( 20, 20, 20, fracture );
			const auto cells = block.cellsOfShards();
			const double mean = std::cbrt( 1.0 / double( cells.size() ) ); // m: the block has 1 m^3
			EXPECT_NEAR( mean / double( size ), 1.0, 0.2 ) << cells.size() << " shards";
			EXPECT_EQ( connectedParts( withoutLinks( block.lattice, allBorders( block ) ) ).size(), cells.size() );
			for ( const auto& [shard, own] : cells )
			{
				EXPECT_GE( double( own.size() ), kShardSliver * 8000.0 / double( cells.size() ) * 0.9 );
			}
		}
	}
	const Block slab( 40, 30, 1, shards( 0.25f ) ); // as thin as a pane
	EXPECT_NEAR( std::sqrt( 3.0 / double( slab.cellsOfShards().size() ) ) / 0.25, 1.0, 0.25 );
}

TEST( Shards, AreThoseOfTheSeed )
{
	Fracture fracture = shards( 0.2f );
	const Block first( 12, 12, 12, fracture ), again( 12, 12, 12, fracture );
	EXPECT_EQ( first.cracks.shards(), again.cracks.shards() );
	fracture.shardSeed = 2;
	EXPECT_NE( first.cracks.shards(), Block( 12, 12, 12, fracture ).cracks.shards() );
}

TEST( Shards, AreLongAlongTheGrain )
{
	Fracture fracture = shards( 0.15f );
	fracture.grain[1] = 2.0f;
	fracture.grainLength = 4.0f;
	const Block block( 16, 40, 16, fracture );
	Vec3 sum = Vec3::Zero();
	for ( const auto& [shard, own] : block.cellsOfShards() )
	{
		Vec3 low = block.lattice.restCentre[own.front()], high = low;
		for ( const std::uint32_t cell : own )
		{
			low = low.cwiseMin( block.lattice.restCentre[cell] );
			high = high.cwiseMax( block.lattice.restCentre[cell] );
		}
		sum += high - low;
	}
	EXPECT_GT( sum.y(), 2.0f * sum.x() );
	EXPECT_GT( sum.y(), 2.0f * sum.z() );
}

TEST( Shards, BreakAtTheStrengthAndInOneCrackAcrossThePull )
{
	for ( int k = 0; k < 6; ++k )
	{
		const int axis = k / 2, length = k % 2 == 0 ? 16 : 30;
		Block bar( axis == 0 ? length : 8, axis == 1 ? length : 8, axis == 2 ? length : 8, shards( 0.2f ) );
		bar.stretchTo( axis, 0.98f * test::kShardBlockStrain );
		EXPECT_TRUE( bar.run().empty() );
		bar.stretchTo( axis, 1.02f * test::kShardBlockStrain );
		const std::vector<CellLink> broken = bar.run();
		ASSERT_FALSE( broken.empty() );
		const auto parts = connectedParts( withoutLinks( bar.lattice, broken ) );
		EXPECT_GE( parts.size(), 2u );
		// A crack unloads 0.4 m on either side: in 0.8 m there may be one more piece, in 1.5 m more cracks.
		EXPECT_LE( parts.size(), length == 16 ? 3u : 5u );
		// The crack is between whole shards.
		for ( const auto& part : parts )
		{
			std::set<std::uint32_t> own;
			for ( const std::uint32_t cell : part )
			{
				own.insert( bar.cracks.shards()[cell] );
			}
			std::size_t cells = 0;
			for ( const std::uint32_t shard : own )
			{
				cells += std::size_t( std::count( bar.cracks.shards().begin(), bar.cracks.shards().end(), shard ) );
			}
			EXPECT_EQ( cells, part.size() );
		}
	}
}

TEST( Shards, AStrongPullMakesMorePiecesAndToughMaterialFewer )
{
	const auto piecesAt = []( float strain, float toughness ) {
		Fracture fracture = shards( 0.2f );
		fracture.toughness = toughness;
		Block block( 24, 12, 12, fracture );
		block.stretchTo( 0, strain );
		const std::vector<CellLink> broken = block.run();
		return connectedParts( withoutLinks( block.lattice, broken ) ).size();
	};
	const std::size_t few = piecesAt( 1.05f * test::kShardBlockStrain, 0.0f );
	EXPECT_GT( piecesAt( 4.0f * test::kShardBlockStrain, 0.0f ), few );
	// E e^2 / 2 over two shards of 0.2 m is 84 J/m^2 of border.
	EXPECT_EQ( piecesAt( 1.05f * test::kShardBlockStrain, 20.0f ), few );
	EXPECT_EQ( piecesAt( 1.05f * test::kShardBlockStrain, 400.0f ), 1u );
}

TEST( Shards, CrumbsAreWhereTheLoadIsAndAtMostTheirShare )
{
	for ( const float share : { 0.0f, 0.02f, 0.1f } )
	{
		Fracture fracture = shards( 0.25f );
		fracture.crumbFraction = share;
		Block block( 16, 16, 16, fracture );
		const Vec3 corner = block.nodes.x.get( 0 );
		for ( int i = 0; i < block.nodes.count; ++i ) // a corner is pulled off
		{
			const Vec3 at = block.nodes.x.get( i );
			block.nodes.x.set(
				i, at - 0.6f * Block::kCell * std::exp( -( at - corner ).norm() / ( 3.0f * Block::kCell ) ) * Vec3( 1, 2, 1 ) );
		}
		const std::vector<std::uint32_t> before = block.cracks.shards();
		static_cast<void>( block.run() );
		double crumbs = 0.0, far = 0.0;
		for ( std::uint32_t i = 0; i < std::uint32_t( before.size() ); ++i )
		{
			crumbs += before[i] != block.cracks.shards()[i] ? 1.0 : 0.0;
			far = before[i] != block.cracks.shards()[i]
				? std::max( far, double( ( block.lattice.restCentre[i] - block.lattice.restCentre[0] ).norm() ) )
				: far;
		}
		EXPECT_LE( crumbs, double( share ) * 4096.0 );
		EXPECT_EQ( crumbs > 0.0, share > 0.0f );
		EXPECT_LT( far, 0.6 );
	}
}

TEST( Shards, AreThoseOfGivenCentres )
{
	GivenCentres given;
	for ( int k = 0; k < 4; ++k ) // four centres, of which the middle two form one shard
	{
		given.position.emplace_back( -0.3 + 0.2 * k, 0.0, 0.0 );
		given.shard.push_back( k == 0 ? 5u : k == 3 ? 9u : 7u );
	}
	Block block( 16, 8, 8, shards( 0.2f ), given );
	const auto cells = block.cellsOfShards();
	ASSERT_EQ( cells.size(), 3u );
	std::vector<std::size_t> sizes;
	for ( const auto& [shard, own] : cells )
	{
		sizes.push_back( own.size() );
	}
	std::sort( sizes.begin(), sizes.end() );
	EXPECT_EQ( sizes, ( std::vector<std::size_t>{ 256, 256, 512 } ) );
	block.stretchTo( 0, 1.05f * test::kShardBlockStrain );
	const std::vector<CellLink> broken = block.run();
	ASSERT_FALSE( broken.empty() );
	for ( const CutTrace& trace : block.cracks.tracesOf( block.lattice, broken ) )
	{
		const double from = std::fabs( double( trace.point.x() ) + 0.2 ), to = std::fabs( double( trace.point.x() ) - 0.2 );
		EXPECT_LT( std::min( from, to ), 1e-5 );
		EXPECT_NEAR( double( trace.normal.x() ), 1.0, 1e-5 );
	}
}

TEST( Shards, LieInRingsAboutTheImpact )
{
	Fracture fracture = shards( 0.15f );
	fracture.shardPattern = ShardPattern::Rings;
	Block pane( 40, 40, 1, fracture );
	EXPECT_EQ( pane.cellsOfShards().size(), 1u ); // until it breaks
	EXPECT_TRUE( pane.cracks.canBreak() );
	const Vec3 impact( 0.35f, -0.2f, 0.0f );
	for ( int i = 0; i < pane.nodes.count; ++i )
	{
		const Vec3 at = pane.nodes.x.get( i ), away = at - impact;
		pane.nodes.x.set( i, at + 0.15f * std::exp( -away.norm() / 0.2f ) * away );
	}
	EXPECT_FALSE( pane.run().empty() );
	double near = 0.0, far = 0.0;
	int nears = 0, fars = 0;
	for ( const auto& [shard, own] : pane.cellsOfShards() )
	{
		Vec3 middle = Vec3::Zero();
		for ( const std::uint32_t cell : own )
		{
			middle += pane.lattice.restCentre[cell] / float( own.size() );
		}
		const bool isNear = ( middle - impact ).norm() < 0.4f;
		( isNear ? near : far ) += double( own.size() );
		( isNear ? nears : fars ) += 1;
	}
	EXPECT_GT( nears, 6 );
	EXPECT_GT( fars, 6 );
	EXPECT_GT( far / fars, 1.5 * near / nears ); // larger farther away
}

TEST( Shards, LinksThatNeverBreakHold )
{
	const Lattice lattice = makeBlockLattice( 30, 8, 8, Block::kCell );
	Block tough(
		30, 8, 8, shards( 0.2f ), {}, std::vector<float>( std::size_t( lattice.linkCount() ), std::numeric_limits<float>::infinity() ) );
	tough.stretchTo( 0, 5.0f * test::kShardBlockStrain );
	EXPECT_TRUE( tough.run().empty() );
	Block twice( 30, 8, 8, shards( 0.2f ), {}, std::vector<float>( std::size_t( lattice.linkCount() ), 2.0f ) );
	twice.stretchTo( 0, 1.9f * test::kShardBlockStrain );
	EXPECT_TRUE( twice.run().empty() );
	twice.stretchTo( 0, 2.1f * test::kShardBlockStrain );
	EXPECT_FALSE( twice.run().empty() );
}

TEST( Shards, PiecesKeepThem )
{
	Fracture fracture = shards( 0.2f );
	fracture.crumbFraction = 0.1f;
	const Block block( 12, 12, 12, fracture );
	std::vector<std::uint32_t> cells;
	for ( std::uint32_t i = 0; i < 12 * 12 * 12; i += 3 )
	{
		cells.push_back( i );
	}
	const ShardCracks piece( block.cracks, extractCells( block.lattice, cells ), cells, 1.0 / 3.0 );
	ASSERT_EQ( piece.shards().size(), cells.size() );
	for ( std::size_t i = 0; i < cells.size(); ++i )
	{
		EXPECT_EQ( piece.shards()[i], block.cracks.shards()[cells[i]] );
	}
	EXPECT_EQ( piece.law().toughness, block.cracks.law().toughness );
	EXPECT_TRUE( piece.canBreak() );
}

TEST( Shards, BordersAreContinuousSurfaces )
{
	// Each trace is on its link, at equal distance from both shards' centres in the bent space, so that the traces of neighbouring links on
	// one border are on a smooth surface: within a seventh of a cell of each other's planes.
	Block block( 24, 12, 12, shards( 0.3f ) );
	block.stretchTo( 0, 1.05f * test::kShardBlockStrain );
	const std::vector<CellLink> broken = block.run();
	const std::vector<CutTrace> traces = block.cracks.tracesOf( block.lattice, broken );
	ASSERT_GT( traces.size(), 20u );
	int pairs = 0;
	for ( const CutTrace& a : traces )
	{
		EXPECT_NEAR( a.normal.norm(), 1.0f, 1e-4f );
		for ( const CutTrace& b : traces )
		{
			const bool isOneBorder = block.cracks.shards()[a.link.a] == block.cracks.shards()[b.link.a] &&
				block.cracks.shards()[a.link.b] == block.cracks.shards()[b.link.b];
			if ( isOneBorder && ( a.point - b.point ).norm() < 1.2f * Block::kCell )
			{
				EXPECT_LT( std::fabs( a.normal.dot( b.point - a.point ) ), 0.15f * Block::kCell );
				++pairs;
			}
		}
	}
	EXPECT_GT( pairs, 50 );
}

TEST( Shards, SettingsOutOfRangeAreRefused )
{
	EXPECT_TRUE( check( shards( 0.1f ) ).ok() );
	const float bad = std::numeric_limits<float>::quiet_NaN();
	const auto isRefused = []( const auto& change ) {
		Fracture fracture = shards( 0.1f );
		change( fracture );
		return check( fracture ).code == ResultCode::BadSettings;
	};
	for ( const float value : { 0.0f, -1.0f, 2e6f, bad } )
	{
		EXPECT_TRUE( isRefused( [value]( Fracture& f ) { f.shardSize = value; } ) );
	}
	for ( const float value : { -1.0f, 2e12f, bad } )
	{
		EXPECT_TRUE( isRefused( [value]( Fracture& f ) { f.toughness = value; } ) );
	}
	for ( const float value : { -0.1f, 1.1f, bad } )
	{
		EXPECT_TRUE( isRefused( [value]( Fracture& f ) { f.crumbFraction = value; } ) );
	}
	for ( const float value : { 0.5f, 101.0f, bad } )
	{
		EXPECT_TRUE( isRefused( [value]( Fracture& f ) { f.grainLength = value; } ) );
	}
	EXPECT_TRUE( isRefused( [bad]( Fracture& f ) { f.grain[2] = bad; } ) );
	EXPECT_TRUE( isRefused( []( Fracture& f ) { f.shardPattern = ShardPattern( 7 ); } ) );
	EXPECT_TRUE( isRefused( []( Fracture& f ) { f.rule = BreakRule( 9 ); } ) );
}

TEST( Shards, ABudgetOutOfRangeIsRefused )
{
	EXPECT_TRUE( check( DebrisBudget{} ).ok() );
	EXPECT_FALSE( check( DebrisBudget{ -1, 0, 1.0f, 0 } ).ok() );
	EXPECT_FALSE( check( DebrisBudget{ 0, -1, 1.0f, 0 } ).ok() );
	EXPECT_FALSE( check( DebrisBudget{ 0, 0, 0.0f, 0 } ).ok() );
	EXPECT_FALSE( check( DebrisBudget{ 0, 0, std::numeric_limits<float>::quiet_NaN(), 0 } ).ok() );
	EXPECT_FALSE( check( DebrisBudget{ 0, 0, 1.0f, -5 } ).ok() );
}

} // namespace
} // namespace pliant
