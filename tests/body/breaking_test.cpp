// A body that breaks: conserved totals over its pieces, and each piece as an independent body. Ohta et al. 2009, "Fracturing".

#include "body/breaking.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/inverted_fraction.h"
#include "support/pulled_bar.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

using test::substep;

std::unique_ptr<Body> makeBody( std::shared_ptr<const Lattice> lattice, const Adaptivity& settings = {}, const Material& material = {} )
{
	Result<std::unique_ptr<Body>> made = Body::create( std::move( lattice ), material, {}, nullptr, settings );
	EXPECT_TRUE( made.ok() ) << made.status.sentence;
	return std::move( made.value );
}

std::vector<CellLink> linksAcross( const Lattice& lattice, const Vec3& normal, float offset )
{
	std::vector<CellLink> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( i < j && ( normal.dot( lattice.restCentre[i] ) < offset ) != ( normal.dot( lattice.restCentre[j] ) < offset ) )
			{
				links.push_back( CellLink{ i, j } );
			}
		}
	}
	return links;
}

/// Adds rotation, pulsation and translation.
void stir( Body& body, unsigned seed )
{
	test::Seeded random( seed );
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const Vec3 x0 = body.nodes().x0.get( i );
		body.nodes().v.set( i, Vec3( 1.0f, 2.0f, -0.5f ) + Vec3( 3.0f, -1.0f, 2.0f ).cross( x0 ) + 0.5f * x0 + random.inBox( 0.5f ) );
	}
	for ( int k = 0; k < 20; ++k )
	{
		substep( body, 1.0f / 240.0f, 0.5f );
	}
}

struct Whole
{
	double mass = 0.0, energy = 0.0;
	Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero(); ///< about the world's origin
};

void add( Whole& whole, const Body& body )
{
	const BodySums sums = body.sums();
	whole.mass += sums.mass;
	whole.energy += sums.kineticEnergy;
	whole.momentum += sums.momentum;
	whole.spin += sums.spin + ( body.nodes().origin + sums.centre ).cross( sums.momentum );
}

TEST( Breaking, RefusesInvalidSettings )
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 3, 3, 3, 0.1f ) );
	auto body = makeBody( lattice );
	Fracture fracture;
	fracture.rule = BreakRule::Distance;
	EXPECT_TRUE( body->setFracture( fracture ).ok() );
	for ( const float bad : { 0.0f, -1.0f, 11.0f, std::nanf( "" ) } )
	{
		Fracture wrong = fracture;
		wrong.breakStrain = bad;
		EXPECT_EQ( body->setFracture( wrong ).code, ResultCode::BadSettings );
	}
	Fracture wrong = fracture;
	wrong.maxPieces = 0;
	EXPECT_EQ( body->setFracture( wrong ).code, ResultCode::BadSettings );
	ToughnessField field;
	field.fraction = []( const float*, const float*, void* ) { return 0.0f; };
	EXPECT_EQ( body->setFracture( fracture, field ).code, ResultCode::BadArgument );
	EXPECT_NE( body->breaking(), nullptr ); // the settings stay as they were
	Material cluster = test::explicitMaterial();
	cluster.method = Method::SingleCluster;
	EXPECT_EQ( makeBody( lattice, {}, cluster )->setFracture( fracture ).code, ResultCode::BadSettings );
	EXPECT_EQ( body->setMaterial( cluster ).code, ResultCode::BadMaterial );

	// Strength is in pascals: a stiffer body breaks at less strain.
	fracture.strength = 1e4f;
	EXPECT_TRUE( body->setFracture( fracture ).ok() );
	const float longest = std::sqrt( body->breaking()->limits.lengthSquared[0] );
	Material stiffer = body->material();
	stiffer.youngsModulus *= 2.0f;
	EXPECT_TRUE( body->setMaterial( stiffer ).ok() );
	EXPECT_NEAR( std::sqrt( body->breaking()->limits.lengthSquared[0] ) - 0.1f, ( longest - 0.1f ) / 2.0f, 1e-6f );

	fracture.rule = BreakRule::Never;
	EXPECT_TRUE( body->setFracture( fracture ).ok() );
	EXPECT_EQ( body->breaking(), nullptr );
}

// Uniform bodies and bodies with levels, cut in half by a slanted plane while tumbling.
TEST( Breaking, PiecesKeepMassMomentumSpinAndEnergy )
{
	for ( const int coarse : { 0, 2 } )
	{
		for ( unsigned seed = 1; seed <= 6; ++seed )
		{
			const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 14, 0.05f, seed ) );
			Adaptivity settings;
			settings.coarseLevels = coarse;
			auto body = makeBody( lattice, settings );
			stir( *body, seed );
			body->breakLinks( linksAcross( *lattice, Vec3( 1.0f, 0.4f, -0.3f ).normalized(), 0.02f ) );
			while ( body->mustRefineToBreak() )
			{
				body->refineToBreak();
			}
			Whole before, after;
			add( before, *body );
			BreakReport report;
			const std::vector<BodyPiece> pieces = body->breakApart( report, 1000 );
			ASSERT_GE( pieces.size(), 2u );
			int cells = 0;
			for ( const BodyPiece& piece : pieces )
			{
				add( after, *piece.body );
				cells += piece.body->lattice().cellCount();
				EXPECT_TRUE( validate( piece.body->lattice() ).ok() ) << validate( piece.body->lattice() ).sentence;
				if ( const Levels* levels = piece.body->levels() )
				{
					EXPECT_TRUE( validate( levels->octree(), piece.body->lattice() ).ok() );
					EXPECT_TRUE( validate( levels->cut(), levels->octree() ).ok() );
				}
			}
			EXPECT_EQ( cells, lattice->cellCount() );
			EXPECT_GT( report.area, 0.0 );
			EXPECT_NEAR( after.mass / before.mass, 1.0, 1e-12 );
			EXPECT_NEAR( ( after.momentum - before.momentum ).norm() / before.momentum.norm(), 0.0, 1e-12 );
			EXPECT_NEAR( ( after.spin - before.spin ).norm() / before.spin.norm(), 0.0, 1e-12 );
			EXPECT_NEAR( after.energy / before.energy, 1.0, 1e-12 );
		}
	}
}

TEST( Breaking, PiecesAreIndependentBodies )
{
	// A bar is cut in two. At rest nothing moves. Stirred, each half keeps its momentum and angular momentum and returns to its rest shape.
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 12, 4, 4, 0.05f ) );
	for ( const int coarse : { 0, 1 } )
	{
		Adaptivity settings;
		settings.coarseLevels = coarse;
		auto body = makeBody( lattice, settings );
		stir( *body, 7 );
		body->breakLinks( linksAcross( *lattice, Vec3::UnitX(), 0.0f ) );
		while ( body->mustRefineToBreak() )
		{
			body->refineToBreak();
		}
		BreakReport report;
		std::vector<BodyPiece> pieces = body->breakApart( report, 1000 );
		ASSERT_EQ( pieces.size(), 2u );
		for ( BodyPiece& piece : pieces )
		{
			Whole before, after;
			add( before, *piece.body );
			for ( int k = 0; k < 600; ++k )
			{
				substep( *piece.body, 1.0f / 240.0f, 0.5f );
			}
			add( after, *piece.body );
			EXPECT_NEAR( ( after.momentum - before.momentum ).norm() / before.momentum.norm(), 0.0, 1e-5 );
			EXPECT_NEAR( ( after.spin - before.spin ).norm() / before.spin.norm(), 0.0, 1e-4 );
			EXPECT_LE( after.energy, before.energy * 1.001 + 0.5 * before.energy ); // stored elastic energy may be released
			const Placement fit = piece.body->bestFit();
			double worst = 0.0;
			for ( int i = 0; i < piece.body->nodeCount(); ++i )
			{
				const Vec3d at = fit.position + fit.rotation * piece.body->nodes().x0.get( i ).cast<double>();
				worst = std::max( worst, ( piece.body->nodes().worldPosition( i ) - at ).norm() );
			}
			EXPECT_LT( worst, 0.02 ); // it still rotates
		}
	}
}

TEST( Breaking, ABarPulledTooFarBreaksAtItsWeakestLayer )
{
	// Both ends are pulled apart slowly; the middle layer has half the toughness.
	for ( const int coarse : { 0, 1 } )
	{
		const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 16, 4, 4, 0.05f ) );
		Adaptivity settings;
		settings.coarseLevels = coarse;
		auto body = makeBody( lattice, settings );
		Fracture fracture;
		fracture.rule = BreakRule::Distance;
		fracture.breakStrain = 0.2f;
		ToughnessField field;
		field.fraction = []( const float* point, const float*, void* ) { return std::fabs( point[0] ) < 0.01f ? 0.5f : 1.0f; };
		ASSERT_TRUE( body->setFracture( fracture, field ).ok() );
		int broken = 0;
		float pulled = 0.0f;
		for ( int k = 0; k < 4000 && broken == 0; ++k )
		{
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				const float x0 = body->nodes().x0.get( i ).x();
				if ( std::fabs( x0 ) > 0.3f )
				{
					body->setPinned( i, true );
					body->nodes().v.set( i, Vec3( x0 > 0.0f ? 0.05f : -0.05f, 0.0f, 0.0f ) );
				}
			}
			body->adaptLevels( 1.0f / 240.0f );
			substep( *body, 1.0f / 240.0f, 0.5f );
			pulled += 0.1f / 240.0f;
			body->testLinks( 1.0f / 240.0f );
			while ( body->mustRefineToBreak() )
			{
				body->refineToBreak();
			}
			if ( body->hasBrokenLinks() )
			{
				BreakReport report;
				std::vector<BodyPiece> pieces = body->breakApart( report, 1000 );
				broken = report.links;
				EXPECT_GT( report.energy, 0.0 );
				body = std::move( pieces[0].body );
			}
		}
		EXPECT_GT( broken, 0 );
		EXPECT_NEAR( pulled / 0.6f, 0.1f, 0.02f );
	}
}

TEST( Breaking, PiecesAreMergedAsFarAsTheBodyWas )
{
	// Blocks of four cells: the slice has a quarter of each of four blocks, too little for nodes of its own.
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 8, 8, 8, 0.1f ) );
	Adaptivity settings;
	settings.coarseLevels = 2;
	settings.refineStrain = 0.2f;
	settings.mergeDelay = 0.1f;
	auto body = makeBody( lattice, settings );
	ASSERT_EQ( body->nodeCount(), 8 );
	body->breakLinks( linksAcross( *lattice, Vec3::UnitX(), -0.3f ) );
	while ( body->mustRefineToBreak() )
	{
		body->refineToBreak();
	}
	BreakReport report;
	for ( const BodyPiece& piece : body->breakApart( report, 1000 ) )
	{
		EXPECT_GT( piece.body->nodeCount(), 16 );
		for ( int k = 0; k < 100; ++k )
		{
			piece.body->adaptLevels( 1.0f / 240.0f );
			ASSERT_EQ( substep( *piece.body, 1.0f / 240.0f, 1.0f ), BodyHealth::Good );
		}
		EXPECT_EQ( piece.body->nodeCount(), piece.cellBefore.size() == 64 ? 4 : 8 );
	}
}

TEST( Breaking, PiecesHaveTheFarLevelsOfTheirLength )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = 1e7f; // beyond the reach of the finest level
	material.farLevels = 3;
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 48, 4, 4, 0.1f ) );
	auto body = makeBody( lattice, {}, material );
	stir( *body, 7 );
	body->breakLinks( linksAcross( *lattice, Vec3::UnitX(), -0.8f ) ); // pieces of 16 and 32 cells
	BreakReport report;
	Whole before, after;
	add( before, *body );
	std::vector<BodyPiece> pieces = body->breakApart( report, 1000 );
	ASSERT_EQ( pieces.size(), 2u );
	for ( BodyPiece& piece : pieces )
	{
		EXPECT_EQ( piece.body->material().farLevels, piece.body->nodeCount() == 32 * 16 ? 3 : 2 );
		for ( int k = 0; k < 300; ++k )
		{
			ASSERT_EQ( substep( *piece.body, 1.0f / 240.0f, 1.0f ), BodyHealth::Good );
		}
		EXPECT_EQ( test::invertedFraction( *piece.body ), 0.0f );
		add( after, *piece.body );
	}
	EXPECT_LT( ( after.momentum - before.momentum ).norm(), 1e-5 * before.momentum.norm() );
}

TEST( Breaking, InPlaneModeABarBreaksAcrossThePullAtTheSetStrain )
{
	// More angles: pliant_experiments pull. At 10 degrees, on one level, cells next to coarse nodes are stretched nearly twice as far.
	for ( const int coarse : { 0, 1, 2 } )
	{
		for ( const double degrees : { 0.0, 10.0, 20.0, 45.0 } )
		{
			const test::PullResult pulled = test::pullBar( { degrees, coarse, BreakRule::Plane, 0.1f, true } );
			EXPECT_NEAR( pulled.firstStrain, 0.1, 0.01 );
			EXPECT_LT( pulled.tilt, 10.0 );
			EXPECT_GE( pulled.pieces, 2 );
		}
	}
}

TEST( Breaking, PiecesBeyondTheLimitStayWithTheHeaviest )
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 9, 2, 2, 0.1f ) );
	auto body = makeBody( lattice );
	std::vector<CellLink> all;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice->cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice->linkStart[i]; k < lattice->linkStart[i + 1]; ++k )
		{
			if ( i < lattice->linkTo[k] )
			{
				all.push_back( CellLink{ i, lattice->linkTo[k] } );
			}
		}
	}
	body->breakLinks( all );
	BreakReport report;
	const std::vector<BodyPiece> pieces = body->breakApart( report, 5 );
	ASSERT_EQ( pieces.size(), 5u );
	EXPECT_EQ( pieces[0].body->nodeCount(), 32 );
	for ( int k = 0; k < 200; ++k )
	{
		substep( *pieces[0].body, 1.0f / 240.0f, 0.5f );
	}
	EXPECT_NEAR( pieces[0].body->sums().momentum.norm(), 0.0, 1e-9 );
}

// Compares a piece's region tables, which reuse unchanged data, with the reference implementation, which rebuilds them.
TEST( Breaking, TablesOfPiecesEqualNewOnes )
{
	for ( unsigned seed = 1; seed <= 12; ++seed )
	{
		const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 12, 0.05f, seed ) );
		Material material = test::explicitMaterial();
		material.regionHalfWidth = 1 + int( seed % 2 );
		material.volumeKeeping = seed % 3 == 0 ? 0.5f : 0.0f; // needs inverses
		auto body = makeBody( lattice, {}, material );
		for ( int event = 0; event < 3; ++event )
		{
			test::Seeded random( 100 * seed + unsigned( event ) );
			const Vec3 normal = random.inBox( 1.0f ).normalized();
			body->breakLinks( linksAcross( body->lattice(), normal, random.uniform( -0.1f, 0.1f ) ) );
			BreakReport report;
			std::vector<BodyPiece> pieces = body->breakApart( report, 1000 );
			for ( const BodyPiece& piece : pieces )
			{
				const RegionTables& now = static_cast<const LatticeMatcher&>( piece.body->matcher() ).tables();
				const auto twin = buildRegionTables( piece.body->lattice(), material, Summation::Automatic );
				ASSERT_EQ( now.regions.size, twin->regions.size );
				ASSERT_EQ( now.usesGrid, twin->usesGrid );
				for ( int r = 0; r < piece.body->nodeCount(); ++r )
				{
					EXPECT_EQ( now.moments.nodeWeight[r], twin->moments.nodeWeight[r] );
					EXPECT_NEAR( now.moments.inverseMass[r], twin->moments.inverseMass[r], 1e-6f * twin->moments.inverseMass[r] );
					for ( int k = 0; k < 6; ++k )
					{
						EXPECT_NEAR( now.moments.moment[k][r], twin->moments.moment[k][r], 1e-5f );
						if ( !twin->moments.inverseMoment[k].empty() )
						{
							EXPECT_NEAR( now.moments.inverseMoment[k][r], twin->moments.inverseMoment[k][r], 1e-3f );
						}
						EXPECT_NEAR( now.moments.centre[k % 3][r], twin->moments.centre[k % 3][r], 1e-5f );
					}
				}
			}
			body = std::move( pieces[0].body );
		}
	}
}

TEST( Breaking, PiecesKeepPlasticShapes )
{
	Material material = test::explicitMaterial();
	material.yieldStrain = 0.01f;
	material.plasticCreep = 500.0f;
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 8, 3, 3, 0.05f ) );
	auto body = makeBody( lattice, {}, material );
	for ( int i = 0; i < body->nodeCount(); ++i ) // a bar stretched by half
	{
		const Vec3 x0 = body->nodes().x0.get( i );
		body->nodes().x.set( i, Vec3( 1.5f * x0.x(), x0.y(), x0.z() ) );
	}
	for ( int k = 0; k < 400; ++k )
	{
		substep( *body, 1.0f / 240.0f, 0.5f );
	}
	const float longer = body->nodes().x.get( 7 ).x() - body->nodes().x.get( 0 ).x();
	ASSERT_GT( longer, 1.1f * 0.35f ); // part of the stretch is permanent
	body->breakLinks( linksAcross( *lattice, Vec3::UnitX(), 0.0f ) );
	BreakReport report;
	std::vector<BodyPiece> pieces = body->breakApart( report, 10 );
	ASSERT_EQ( pieces.size(), 2u );
	const auto length = []( const Body& b ) { return b.nodes().x.get( 3 ).x() - b.nodes().x.get( 0 ).x(); };
	const float before = length( *pieces[0].body );
	for ( int k = 0; k < 400; ++k )
	{
		substep( *pieces[0].body, 1.0f / 240.0f, 0.5f );
	}
	EXPECT_NEAR( length( *pieces[0].body ), before, 0.01f * before );
}

} // namespace
} // namespace pliant
