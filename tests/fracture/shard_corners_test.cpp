// Shards that touch at edges and corners of cells alone.

#include "lattice/pieces.h"
#include "support/shard_block.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <utility>

namespace pliant {
namespace {

using test::ShardBlock;

/// The lattice with only those links whose cells share a face.
Lattice withFacesAlone( const Lattice& lattice )
{
	std::vector<CellLink> diagonal;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( j > i && ( lattice.coordinate[i].cast<int>() - lattice.coordinate[j].cast<int>() ).cwiseAbs().sum() > 1 )
			{
				diagonal.push_back( CellLink{ i, j } );
			}
		}
	}
	return withoutLinks( lattice, diagonal );
}

// A thrown cube of 2 197 cells kept a piece of 64 shards that hung together by 124 links over edges and corners: such a border has no area,
// so that no crack could start at it. The piece flapped, never became rigid and cost 40 ms a step.
TEST( ShardCorners, HoldNothing )
{
	for ( const auto& [strain, crumbs] :
		{ std::pair( 1.1f, 0.0f ), std::pair( 2.0f, 0.0f ), std::pair( 5.0f, 0.0f ), std::pair( 5.0f, 0.1f ) } )
	{
		Fracture fracture = test::shards( 0.14f );
		fracture.crumbFraction = crumbs;
		ShardBlock block( 14, 14, 14, fracture );
		block.stretchTo( 0, strain * test::kShardBlockStrain );
		for ( int i = 0; i < block.nodes.count; ++i ) // pulled hardest at one end, and to its side
		{
			const Vec3 at = block.nodes.x.get( i );
			block.nodes.x.set( i, at + strain * test::kShardBlockStrain * at.x() * Vec3( at.x(), at.x(), 0 ) );
		}
		const Lattice open = withoutLinks( block.lattice, block.run() );
		const std::size_t pieces = connectedParts( open ).size();
		std::printf( "%.1f of the breaking strain, %.2f in crumbs: %d pieces\n", double( strain ), double( crumbs ), int( pieces ) );
		EXPECT_GT( pieces, 1u );
		// Where crumbs have come off, the rest of a shard itself may hang by an edge.
		EXPECT_LE( connectedParts( withFacesAlone( open ) ).size(), crumbs > 0.0f ? pieces + pieces / 10 : pieces );
	}
}

} // namespace
} // namespace pliant
