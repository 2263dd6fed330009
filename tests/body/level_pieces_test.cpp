// Bodies with levels whose links break and heal: reused data equals rebuilt data. Steinemann et al. 2008, 5.1.

#include "adapt/moments/fine_update.h"
#include "body/breaking.h"
#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"
#include "support/same_levels.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

constexpr float kPieceStep = 1.0f / 240.0f;

using test::expectNear;
using test::expectNearBase;
using test::expectNearTables;
using test::linksAtFour;

void expectNearNodes( const NodeState& got, const NodeState& wanted, float allowed )
{
	ASSERT_EQ( got.count, wanted.count );
	EXPECT_EQ( got.mass, wanted.mass );
	EXPECT_EQ( got.freedom, wanted.freedom );
	for ( int i = 0; i < got.count; ++i )
	{
		ASSERT_LE( ( got.x0.get( i ) - wanted.x0.get( i ) ).norm(), allowed );
		ASSERT_LE( ( got.x.get( i ) - wanted.x.get( i ) ).norm(), allowed );
		ASSERT_LE( ( got.v.get( i ) - wanted.v.get( i ) ).norm(), allowed );
	}
}

/// Two bodies with the same history; one reuses data, the other rebuilds it.
struct BodyPair
{
	std::unique_ptr<Body> body, reference;

	template <class Act>
	void both( Act&& act )
	{
		act( *body );
		act( *reference );
	}
};

BodyPair makePair( unsigned seed, int coarseLevels, int halfWidth, bool isSoftInParts )
{
	std::mt19937 random( seed );
	const auto lattice = std::make_shared<const Lattice>(
		test::makeBlobLattice( 16, 0.05f, seed, 6, [&random]( int, int ) { return random() % 12 != 0; } ) );
	Adaptivity settings;
	settings.coarseLevels = coarseLevels;
	settings.refineStrain = 0.04f;
	settings.mergeDelay = 0.02f;
	Material material = test::explicitMaterial();
	material.regionHalfWidth = halfWidth;
	material.yieldStrain = 0.02f;
	material.plasticCreep = 10.0f;
	StiffnessField field;
	if ( isSoftInParts )
	{
		field.fraction = []( const float* p, void* ) { return p[0] > 0.4f ? 0.5f : 1.0f; };
	}
	const auto make = [&] { return std::move( Body::create( lattice, material, {}, nullptr, settings, field ).value ); };
	BodyPair pair{ make(), make() };
	pair.both( [seed]( Body& body ) {
		test::Seeded shake( seed );
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			const Vec3 x0 = body.nodes().x0.get( i );
			body.nodes().v.set(
				i, Vec3( 3.0f, -1.0f, 2.0f ).cross( x0 ) + 2.0f * Vec3( x0.x(), -x0.y(), 0.5f * x0.z() ) + shake.inBox( 0.5f ) );
		}
		EXPECT_TRUE( body.setFracture( [] {
							 Fracture f;
							 f.rule = BreakRule::Distance;
							 f.breakStrain = 5.0f;
							 return f;
						 }() )
						 .ok() );
	} );
	return pair;
}

/// Returns random links through a ball or a disc, and some of those cut before.
void cutByChance( BodyPair& pair, std::mt19937& random, std::vector<CellLink>& gone )
{
	const Lattice& lattice = pair.body->lattice();
	const Vec3 middle = lattice.restCentre[random() % lattice.restCentre.size()];
	const float reach = lattice.cellSize * float( 1 + random() % 4 );
	const int axis = int( random() % 3 );
	const bool isPlane = random() % 2 == 0;
	std::vector<CellLink> broken, healed;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			const Vec3 a = lattice.restCentre[i] - middle, b = lattice.restCentre[j] - middle;
			const bool goesThrough = isPlane ? ( a[axis] < 0.0f ) != ( b[axis] < 0.0f ) : random() % 3 == 0;
			if ( i < j && a.norm() < reach && goesThrough )
			{
				broken.push_back( CellLink{ i, j } );
			}
		}
	}
	for ( std::size_t k = gone.size(); k-- > 0; )
	{
		if ( random() % 3 == 0 )
		{
			healed.push_back( gone[k] );
			gone.erase( gone.begin() + std::ptrdiff_t( k ) );
		}
	}
	gone.insert( gone.end(), broken.begin(), broken.end() );
	std::sort( gone.begin(), gone.end() );
	std::sort( healed.begin(), healed.end() );
	pair.both( [&]( Body& body ) {
		body.breakLinks( broken );
		body.healLinks( healed );
		while ( body.mustRefineToBreak() )
		{
			body.refineToBreak();
		}
	} );
}

void run( Body& body, int steps )
{
	for ( int k = 0; k < steps; ++k )
	{
		body.adaptLevels( kPieceStep );
		ASSERT_EQ( test::substep( body, kPieceStep, 0.5f ), BodyHealth::Good );
	}
}

void expectNear( const Body& got, const Body& wanted, float allowed )
{
	expectNearBase( got.levels()->base(), wanted.levels()->base(), allowed );
	EXPECT_EQ( got.levels()->cut().node, wanted.levels()->cut().node );
	EXPECT_EQ( got.levels()->cut().slotOfCell, wanted.levels()->cut().slotOfCell );
	expectNearTables( *got.levels()->tables(), *wanted.levels()->tables(), allowed );
	expectNearNodes( got.nodes(), wanted.nodes(), allowed );
	EXPECT_EQ( got.breaking()->limits.to, wanted.breaking()->limits.to );
	EXPECT_EQ( got.breaking()->limits.lengthSquared, wanted.breaking()->limits.lengthSquared );
	EXPECT_EQ( got.firstCells(), wanted.firstCells() );
}

/// A piece's positions are those of the whole, translated: one rounding each.
constexpr float kRounding = 2e-5f;

struct Count
{
	int whole = 0, pieces = 0, reordered = 0, refined = 0, flowed = 0;
};

void breakAndCompare( BodyPair& pair, std::mt19937& random, std::vector<CellLink>& gone, Count& count )
{
	cutByChance( pair, random, gone );
	BreakReport report;
	std::vector<BodyPiece> got = pair.body->breakApart( report, 1000 );
	std::vector<BodyPiece> wanted = pair.reference->breakApart( report, 1000, PieceBuild::FromScratch );
	ASSERT_EQ( got.size(), wanted.size() );
	EXPECT_EQ( pair.body->firstCells(), pair.reference->firstCells() ); // indices in the report
	EXPECT_EQ( pair.body->nodeCount(), pair.reference->nodeCount() );
	const bool isWhole = got.size() == 1;
	( isWhole ? count.whole : count.pieces ) += int( got.size() );
	for ( std::size_t k = 0; k < got.size(); ++k )
	{
		EXPECT_EQ( got[k].cellBefore, wanted[k].cellBefore );
		EXPECT_EQ( got[k].nodeBefore, wanted[k].nodeBefore );
		count.reordered += std::is_sorted( got[k].nodeBefore.begin(), got[k].nodeBefore.end() ) ? 0 : 1;
		expectNear( *got[k].body, *wanted[k].body, isWhole ? 0.0f : kRounding );
	}
	pair.body = std::move( got[0].body );
	pair.reference = std::move( wanted[0].body );
}

TEST( LevelPieces, OfABodyWithChangedLinksEqualNewOnesToTheBit )
{
	Count count;
	for ( unsigned seed = 1; seed <= 8; ++seed )
	{
		std::mt19937 random( seed );
		BodyPair pair = makePair( seed, 1 + int( seed % 3 ), 1 + int( seed / 2 % 2 ), seed % 4 == 0 );
		std::vector<CellLink> gone;
		pair.both( []( Body& body ) { run( body, 6 ); } );
		for ( int round = 0; round < 12; ++round )
		{
			const int before = count.pieces;
			breakAndCompare( pair, random, gone, count );
			if ( HasFailure() || count.pieces > before )
			{
				break; // pieces are compared below
			}
			pair.both( []( Body& body ) { run( body, 8 ); } );
			expectNear( *pair.body, *pair.reference, 0.0f );
			EXPECT_EQ( pair.body->hasFlowed(), pair.reference->hasFlowed() );
			count.flowed += pair.body->hasFlowed() ? 1 : 0;
			count.refined += int( pair.body->levels()->lastChange().source.size() > 0 );
			ASSERT_FALSE( HasFailure() ) << "seed " << seed << " round " << round;
		}
	}
	std::printf( "%d whole, %d with nodes in another order, %d with levels changed since, %d that had flowed\n", count.whole,
		count.reordered, count.refined, count.flowed );
	EXPECT_GT( count.whole, 40 );
	EXPECT_GT( count.reordered, 0 );
	EXPECT_GT( count.refined, 20 );
	EXPECT_GT( count.flowed, 20 );
}

// Two arms in one block are connected at their ends, and through a cell of the block above. When the ends separate, the order of the two
// arms' cells is swapped, and the row of the connecting cell, in which nothing else has changed, must be updated.
TEST( LevelPieces, RowsFollowCellsThatChangeTheirOrder )
{
	const Eigen::Vector3i cells[] = {
		{ 0, 0, 3 }, { 1, 0, 3 }, { 2, 0, 3 }, { 0, 1, 3 }, { 3, 1, 3 }, { 0, 2, 3 }, { 1, 3, 3 }, { 2, 2, 4 } };
	const auto lattice = std::make_shared<const Lattice>( test::makeShapeLattice( { 4, 4, 5 }, 0.05f, [&cells]( int x, int y, int z ) {
		return std::find( std::begin( cells ), std::end( cells ), Eigen::Vector3i( x, y, z ) ) != std::end( cells );
	} ) );
	Adaptivity settings;
	settings.coarseLevels = 2;
	const auto cut = [&]( PieceBuild road ) {
		const std::unique_ptr<Body> body = std::move( Body::create( lattice, test::explicitMaterial(), {}, nullptr, settings ).value );
		EXPECT_EQ( body->nodeCount(), 8 );
		body->breakLinks( { CellLink{ 1, 2 } } );
		BreakReport report;
		return body->breakApart( report, 1000, road );
	};
	const std::vector<BodyPiece> got = cut( PieceBuild::Reuse ), wanted = cut( PieceBuild::FromScratch );
	ASSERT_EQ( got.size(), 1u );
	ASSERT_FALSE( std::is_sorted( got[0].nodeBefore.begin(), got[0].nodeBefore.end() ) );
	EXPECT_EQ( got[0].nodeBefore, wanted[0].nodeBefore );
	expectNearTables( *got[0].body->levels()->tables(), *wanted[0].body->levels()->tables(), 0.0f );
	expectNearNodes( got[0].body->nodes(), wanted[0].body->nodes(), 0.0f );
}

/// Returns the links across a plane through the body.
std::vector<CellLink> slabOf( const Lattice& lattice, const Vec3& normal )
{
	std::vector<CellLink> slab;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( i < j && ( normal.dot( lattice.restCentre[i] ) < 0.013f ) != ( normal.dot( lattice.restCentre[j] ) < 0.013f ) )
			{
				slab.push_back( CellLink{ i, j } );
			}
		}
	}
	return slab;
}

TEST( LevelPieces, ThatBrokeOffEqualNewOnesUpToRounding )
{
	Count count;
	for ( unsigned seed = 11; seed <= 18; ++seed )
	{
		std::mt19937 random( seed );
		BodyPair pair = makePair( seed, 1 + int( seed % 3 ), 1 + int( seed / 2 % 2 ), seed % 4 == 0 );
		const std::vector<CellLink> slab = slabOf( pair.body->lattice(), Vec3( 1.0f, 0.4f, -0.3f ).normalized() );
		pair.both( [&slab]( Body& body ) {
			run( body, 6 );
			body.breakLinks( slab );
		} );
		std::vector<CellLink> gone;
		breakAndCompare( pair, random, gone, count );
		ASSERT_FALSE( HasFailure() ) << "seed " << seed;
	}
	std::printf( "%d pieces\n", count.pieces );
	EXPECT_GE( count.pieces, 16 );
}

// Cracked bodies and fragments are refined in groups like the intact body; refined node by node, bars on coarse levels would break too
// early.
TEST( LevelPieces, AreRefinedTogetherLikeTheBody )
{
	for ( const PieceBuild road : { PieceBuild::Reuse, PieceBuild::FromScratch } )
	{
		for ( const bool comesApart : { false, true } )
		{
			Adaptivity settings;
			settings.coarseLevels = 1;
			const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 8, 4, 4, 0.1f ) );
			Result<std::unique_ptr<Body>> made = Body::create( lattice, test::explicitMaterial(), {}, nullptr, settings );
			Fracture fracture;
			fracture.rule = BreakRule::Plane;
			fracture.breakStrain = 0.2f;
			ASSERT_TRUE( made.value->setFracture( fracture ).ok() );
			const float together = made.value->levels()->together();
			ASSERT_LT( together, 1.0f );
			made.value->breakLinks( linksAtFour( *lattice, comesApart ? 4 : 1 ) );
			while ( made.value->mustRefineToBreak() )
			{
				made.value->refineToBreak();
			}
			BreakReport report;
			const std::vector<BodyPiece> pieces = made.value->breakApart( report, 10, road );
			ASSERT_EQ( pieces.size(), comesApart ? 2u : 1u );
			for ( const BodyPiece& piece : pieces )
			{
				EXPECT_EQ( piece.body->levels()->together(), together );
			}
		}
	}
}

// Requests survive fracture events: a game that cuts in each frame may request finer nodes ahead of the blade.
TEST( LevelPieces, KeepTheRequestsOfTheBody )
{
	for ( const PieceBuild road : { PieceBuild::Reuse, PieceBuild::FromScratch } )
	{
		for ( const int most : { 4, 1 } ) // a full cut; a notch
		{
			Adaptivity settings;
			settings.coarseLevels = 1;
			const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 8, 4, 4, 0.1f ) );
			const std::unique_ptr<Body> body = std::move( Body::create( lattice, test::explicitMaterial(), {}, nullptr, settings ).value );
			const auto isAtAnEnd = []( const Body& of, int node ) { return std::abs( of.nodes().x.get( node ).x() ) > 0.25f; };
			body->breakLinks( linksAtFour( *lattice, most ) );
			while ( body->mustRefineToBreak() )
			{
				body->refineToBreak();
			}
			int asked = 0;
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				if ( body->levels()->levelOf( i ) == 1 && isAtAnEnd( *body, i ) )
				{
					body->requestSplit( i );
					++asked;
				}
			}
			ASSERT_EQ( asked, 8 );
			BreakReport report;
			const std::vector<BodyPiece> pieces = body->breakApart( report, 10, road );
			ASSERT_EQ( pieces.size(), most == 4 ? 2u : 1u );
			for ( const BodyPiece& piece : pieces )
			{
				for ( int k = 0; k < 8; ++k )
				{
					piece.body->adaptLevels( kPieceStep );
				}
				for ( int i = 0; i < piece.body->nodeCount(); ++i )
				{
					EXPECT_FALSE( piece.body->levels()->levelOf( i ) == 1 && isAtAnEnd( *piece.body, i ) ) << most;
				}
			}
		}
	}
}

// The time that nodes have been quiet before a crack opens counts towards the delay of merging.
TEST( LevelPieces, AreMergedWhenTheBodyWouldBe )
{
	for ( const PieceBuild road : { PieceBuild::Reuse, PieceBuild::FromScratch } )
	{
		for ( const int most : { 4, 1 } ) // a full cut; a notch
		{
			Adaptivity settings;
			settings.coarseLevels = 1;
			settings.refineStrain = 0.2f;
			settings.mergeDelay = 0.1f;
			const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 8, 4, 4, 0.1f ) );
			Result<std::unique_ptr<Body>> made = Body::create( lattice, test::explicitMaterial(), {}, nullptr, settings );
			const auto run = []( Body& body, int substeps ) {
				for ( ; substeps > 0; --substeps )
				{
					body.adaptLevels( kPieceStep );
					ASSERT_EQ( test::substep( body, kPieceStep, 1.0f ), BodyHealth::Good );
				}
			};
			made.value->changeLevels( made.value->levels()->cut().node, {} );
			run( *made.value, 20 );
			made.value->breakLinks( linksAtFour( *lattice, most ) );
			int nodes = 0;
			BreakReport report;
			for ( const BodyPiece& piece : made.value->breakApart( report, 10, road ) )
			{
				run( *piece.body, 12 );
				nodes += piece.body->nodeCount();
			}
			EXPECT_EQ( nodes, 16 );
		}
	}
}

} // namespace
} // namespace pliant
