// The set of colliding nodes and their sizes after links are broken or healed: equal to those of a full computation.

#include "body/breaking.h"
#include "body/levels/levels.h"
#include "fracture/cut_links.h"
#include "lattice/inside/inside_distance.h"
#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/shapes.h"
#include "world/shape/node_colliders.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace pliant {
namespace {

struct Counts
{
	int whole = 0, pieces = 0, deeper = 0, nearer = 0;
};

/// Cuts a disc through some cell, or a ball; now and then restores earlier cuts.
void cutByChance( Body& body, const Lattice& whole, test::Seeded& random )
{
	const std::vector<Vec3d> positions = body.cellPositions();
	const Vec3d& at = positions[std::size_t( random.uniform( 0.0f, 0.999f ) * float( positions.size() ) )];
	const Vec3d normal = random.inBox( 1.0f ).cast<double>();
	const double reach = double( random.uniform( 0.08f, 0.4f ) );
	const bool isBall = random.uniform( 0.0f, 1.0f ) < 0.3f;
	body.breakLinks( isBall ? linksCut( body.lattice(), positions, SphereCut{ at, reach / 2 } )
							: linksCut( body.lattice(), positions, PlaneCut{ at, normal, reach } ) );
	if ( random.uniform( 0.0f, 1.0f ) < 0.2f )
	{
		body.healLinks( linksToHeal( whole, body.lattice(), body.firstCells(), positions, 1.5 ) );
	}
	while ( body.mustRefineToBreak() )
	{
		body.refineToBreak();
	}
}

void compare( const BodyPiece& piece, const NodeColliders& before, bool isWhole, Counts& counts )
{
	const Lattice& lattice = piece.body->lattice();
	const Octree& octree = piece.body->levels()->octree();
	ASSERT_FALSE( piece.treeBefore.empty() );
	const NodeColliders wanted = measureColliders( lattice, octree );
	const NodeColliders got = followColliders(
		lattice, octree, before, CollidersChange{ piece.treeBefore, piece.cellBefore, piece.touched } );
	EXPECT_EQ( got.depth, wanted.depth );
	EXPECT_EQ( got.collides, wanted.collides );
	ASSERT_EQ( got.radius.size(), wanted.radius.size() );
	for ( std::size_t n = 0; n < got.radius.size(); ++n )
	{
		EXPECT_NEAR( got.radius[n], wanted.radius[n], isWhole ? 0.0f : 1e-5f * wanted.radius[n] );
	}
	for ( std::size_t cell = 0; cell < wanted.depth.size(); ++cell )
	{
		const int then = before.depth[piece.cellBefore[cell]], now = wanted.depth[cell];
		counts.deeper += now > then ? 1 : 0;
		counts.nearer += now < then && now > 0 ? 1 : 0;
	}
	( isWhole ? counts.whole : counts.pieces ) += 1;
}

/// The inside distances equal those of a flood fill over all cells.
void compareInside( const BodyPiece& piece, const Lattice& before, int& followed )
{
	const std::vector<std::uint32_t> then = floodInside( before );
	std::vector<std::uint32_t> depth;
	for ( const std::uint32_t cell : piece.cellBefore )
	{
		depth.push_back( then[cell] );
	}
	if ( updateInside( piece.body->lattice(), piece.touched, depth ) )
	{
		++followed;
		EXPECT_EQ( depth, floodInside( piece.body->lattice() ) );
	}
}

TEST( NodeColliders, FollowCutsAndHealing )
{
	Counts counts;
	int followed = 0;
	for ( unsigned seed = 1; seed <= 9; ++seed )
	{
		const auto whole = std::make_shared<const Lattice>( test::makeBlobLattice( 24, 0.05f, seed ) );
		Adaptivity settings;
		settings.coarseLevels = 1 + int( seed % 3 );
		std::unique_ptr<Body> body = std::move( Body::create( whole, test::explicitMaterial(), {}, nullptr, settings ).value );
		test::Seeded random( seed );
		for ( int event = 0; event < 14; ++event )
		{
			cutByChance( *body, *whole, random );
			if ( !body->hasBrokenLinks() )
			{
				continue;
			}
			const NodeColliders before = measureColliders( body->lattice(), body->levels()->octree() );
			const Lattice latticeBefore = body->lattice();
			BreakReport report;
			std::vector<BodyPiece> pieces = body->breakApart( report, 1000 );
			for ( const BodyPiece& piece : pieces )
			{
				compare( piece, before, pieces.size() == 1, counts );
				compareInside( piece, latticeBefore, followed );
			}
			ASSERT_FALSE( HasFailure() ) << "seed " << seed << " event " << event;
			body = std::move( pieces[0].body );
		}
	}
	std::printf(
		"%d whole, %d pieces; %d cells nearer to the surface, %d deeper\n", counts.whole, counts.pieces, counts.nearer, counts.deeper );
	EXPECT_GT( counts.whole, 40 );
	EXPECT_GT( counts.pieces, 40 );
	EXPECT_GT( counts.nearer, 500 );
	EXPECT_GT( counts.deeper, 500 );
	EXPECT_GT( followed, 50 );
}

} // namespace
} // namespace pliant
