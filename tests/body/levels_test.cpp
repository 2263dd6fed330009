// Changes of levels during motion: conservation, restoration, and the criteria for splitting and merging.

#include "body/levels/levels.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"
#include "support/inverted_fraction.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::substep;

std::unique_ptr<Body> makeAdaptive( std::shared_ptr<const Lattice> lattice, const Adaptivity& settings, const Material& material = {} )
{
	Result<std::unique_ptr<Body>> made = Body::create( std::move( lattice ), material, {}, nullptr, settings );
	EXPECT_TRUE( made.ok() ) << made.status.sentence;
	return std::move( made.value );
}

Adaptivity levels( int count )
{
	Adaptivity settings;
	settings.coarseLevels = count;
	return settings;
}

/// Returns up to `most` octree nodes of the cut above the finest level.
std::vector<std::uint32_t> coarseNodes( const Body& body, std::size_t most )
{
	std::vector<std::uint32_t> nodes;
	for ( const std::uint32_t node : body.levels()->cut().node )
	{
		if ( body.levels()->octree().levelOf( node ) > 0 && nodes.size() < most )
		{
			nodes.push_back( node );
		}
	}
	return nodes;
}

TEST( Levels, RefuseInvalidSettings )
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 4, 4, 4, 0.1f ) );
	Adaptivity settings = levels( 9 );
	EXPECT_EQ( Body::create( lattice, {}, {}, nullptr, settings ).status.code, ResultCode::BadSettings );
	settings = levels( 1 );
	settings.refineStrain = std::nanf( "" );
	EXPECT_EQ( Body::create( lattice, {}, {}, nullptr, settings ).status.code, ResultCode::BadSettings );
	Material cluster = test::explicitMaterial();
	cluster.method = Method::SingleCluster;
	EXPECT_EQ( Body::create( lattice, cluster, {}, nullptr, levels( 1 ) ).status.code, ResultCode::BadSettings );
}

// Where the surface is slanted, big nodes at its edge have planar regions. Their cells' offsets across the plane must not rotate the
// regions, or the body would be strained by a third at rest.
TEST( Levels, NothingStrainsAtRestHoweverSlantedTheSurface )
{
	for ( const double degrees : { 15.0, 30.0, 40.0 } )
	{
		const double angle = degrees * 3.14159265358979323846 / 180.0;
		const Vec3d along( std::cos( angle ), std::sin( angle ), 0.0 ), across( -std::sin( angle ), std::cos( angle ), 0.0 );
		const auto isInside = [&]( int x, int y, int ) {
			const Vec3d p( x - 23.5, y - 23.5, 0.0 );
			return std::fabs( p.dot( along ) ) < 20.0 && std::fabs( p.dot( across ) ) < 4.0;
		};
		const auto lattice = std::make_shared<const Lattice>( test::makeShapeLattice( { 48, 48, 8 }, 0.05f, isInside ) );
		for ( int count = 1; count <= 3; ++count )
		{
			Adaptivity settings = levels( count );
			settings.refineStrain = 0.01f;
			const auto body = makeAdaptive( lattice, settings );
			const int nodes = body->nodeCount();
			for ( int k = 0; k < 40; ++k )
			{
				body->adaptLevels( 1.0f / 240.0f );
				substep( *body, 1.0f / 240.0f, 1.0f );
			}
			EXPECT_EQ( body->nodeCount(), nodes );
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				EXPECT_LT( ( body->nodes().x.get( i ) - body->nodes().x0.get( i ) ).norm(), 1e-6f )
					<< degrees << " degrees, " << count << " levels, node " << i;
			}
		}
	}
}

TEST( Levels, ChangedInFlightKeepMomentumSpinAndNearlyAllEnergy )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 18, 0.05f, 4 ) );
	const std::unique_ptr<Body> body = makeAdaptive( lattice, levels( 2 ) );
	NodeState& nodes = body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 x = nodes.x.get( i );
		nodes.v.set( i, Vec3( 1.0f, -0.5f, 0.2f ) + Vec3( 2.0f, 3.0f, -1.0f ).cross( x ) + Vec3( 0.8f * x.x(), 0.0f, 0.0f ) );
	}
	for ( int k = 0; k < 20; ++k )
	{
		substep( *body, 1.0f / 240.0f, 1.0f );
	}
	double worstMomentum = 0.0, worstSpin = 0.0, worstEnergy = 0.0;
	for ( int round = 0; round < 10; ++round )
	{
		const std::vector<std::uint32_t> split = coarseNodes( *body, 12 );
		for ( const bool isSplit : { true, false } )
		{
			const BodySums before = body->sums();
			body->changeLevels( isSplit ? split : std::vector<std::uint32_t>(), isSplit ? std::vector<std::uint32_t>() : split );
			const BodySums now = body->sums();
			worstMomentum = std::max( worstMomentum, ( now.momentum - before.momentum ).norm() / before.momentum.norm() );
			worstSpin = std::max( worstSpin, ( now.spin - before.spin ).norm() / before.spin.norm() );
			worstEnergy = std::max( worstEnergy, std::abs( now.kineticEnergy / before.kineticEnergy - 1.0 ) );
			substep( *body, 1.0f / 240.0f, 1.0f );
		}
	}
	std::printf( "20 changes of levels: momentum %.1e (at most 1e-6), spin %.1e (1e-6), kinetic energy %.2e (0.01) of what there was\n",
		worstMomentum, worstSpin, worstEnergy );
	EXPECT_LT( worstMomentum, 1e-6 );
	EXPECT_LT( worstSpin, 1e-6 );
	EXPECT_LT( worstEnergy, 0.01 );
}

TEST( Levels, OfARoundTripHaveTheSameRegionsToTheBit )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 18, 0.05f, 5 ) );
	for ( const RegionRule rule : { RegionRule::Multiplicity, RegionRule::Union } )
	{
		Adaptivity settings = levels( 3 );
		settings.regions = rule;
		const std::unique_ptr<Body> body = makeAdaptive( lattice, settings );
		const std::shared_ptr<const RegionTables> before = body->levels()->tables();
		for ( const std::size_t most : { std::size_t( 3 ), std::size_t( 1000 ) } )
		{
			const std::vector<std::uint32_t> split = coarseNodes( *body, most );
			body->changeLevels( split, {} );
			EXPECT_NE( body->levels()->tables()->matrix->member, before->matrix->member );
			body->changeLevels( {}, split );
			const RegionTables& now = *body->levels()->tables();
			EXPECT_EQ( now.matrix->member, before->matrix->member );
			EXPECT_EQ( now.matrix->mass, before->matrix->mass );
			EXPECT_EQ( now.matrix->fraction, before->matrix->fraction );
			EXPECT_EQ( now.beta, before->beta );
			EXPECT_EQ( now.eta, before->eta );
			EXPECT_EQ( now.pull, before->pull );
			EXPECT_EQ( now.moments.inverseMass, before->moments.inverseMass );
			for ( int k = 0; k < 6; ++k )
			{
				EXPECT_EQ( now.moments.moment[k], before->moments.moment[k] );
				EXPECT_EQ( now.moments.inverseMoment[k], before->moments.inverseMoment[k] );
			}
		}
	}
}

TEST( Levels, IncrementalTablesEqualNewOnes )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 18, 0.05f, 6 ) );
	Adaptivity settings = levels( 3 );
	settings.softening = Softening::EnergyTensor;
	const Material material = test::explicitMaterial();
	const std::unique_ptr<Body> body = makeAdaptive( lattice, settings, material );
	const std::shared_ptr<const LevelBase> base = buildLevelBase( *lattice, material, settings );
	std::mt19937 random( 3 );
	for ( int round = 0; round < 6; ++round )
	{
		std::vector<std::uint32_t> split;
		for ( const std::uint32_t node : coarseNodes( *body, 1000 ) )
		{
			if ( random() % 3 == 0 )
			{
				split.push_back( node );
			}
		}
		body->changeLevels( split, {} );
		const Cut& cut = body->levels()->cut();
		const LevelRegions regions = buildLevelRegions( RegionInput{ *base, *lattice, material, settings }, cut );
		const auto wanted = buildLevelTables( *base, *lattice, cut, regions, LevelSettings{ material, settings, {} } );
		const RegionTables& got = *body->levels()->tables();
		EXPECT_EQ( got.beta, wanted->beta );
		EXPECT_EQ( got.eta, wanted->eta );
		EXPECT_EQ( got.pull, wanted->pull );
		for ( int k = 0; k < 9; ++k )
		{
			EXPECT_EQ( got.blend[k], wanted->blend[k] );
		}
	}
}

TEST( Levels, ChildrenFollowTheirParentsRegion )
{
	// A uniformly stretched body stays uniformly stretched when all of it is split: no node jumps.
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 8, 8, 8, 0.1f ) );
	const std::unique_ptr<Body> body = makeAdaptive( lattice, levels( 2 ) );
	const Vec3 stretch( 1.2f, 0.9f, 1.0f );
	NodeState& nodes = body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, nodes.x0.get( i ).cwiseProduct( stretch ) );
	}
	body->accelerateTowardGoals( 0.01f, 1.0f, nullptr ); // measures the regions; velocities are not applied
	body->changeLevels( coarseNodes( *body, 1000 ), {} );
	ASSERT_GT( body->nodeCount(), 8 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		EXPECT_LT( ( nodes.x.get( i ) - nodes.x0.get( i ).cwiseProduct( stretch ) ).norm(), 1e-5f );
	}
}

TEST( Levels, FollowStrainUpAndDown )
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 16, 8, 8, 0.05f ) );
	Adaptivity settings = levels( 2 );
	settings.refineStrain = 0.1f;
	settings.mergeDelay = 0.2f;
	Material material = test::explicitMaterial();
	material.damping = 20.0f;
	const std::unique_ptr<Body> body = makeAdaptive( lattice, settings, material );
	const int atRest = body->nodeCount();
	NodeState& nodes = body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.v.set( i, Vec3( 8.0f * nodes.x0.get( i ).x(), 0.0f, 0.0f ) );
	}
	int most = 0;
	for ( int k = 0; k < 600; ++k )
	{
		body->adaptLevels( 1.0f / 240.0f );
		substep( *body, 1.0f / 240.0f, 0.5f );
		most = std::max( most, body->nodeCount() );
	}
	EXPECT_GT( most, 2 * atRest );
	EXPECT_EQ( body->nodeCount(), atRest );
	EXPECT_LT( test::shapeError( *body ), 1e-3 );
}

// Compression does not break a body, so compressed nodes need no refinement and may be merged. Stretched nodes stay fine while the rest is
// merged; without any delay they would be merged and split again in turn.
TEST( Levels, OfABreakableBodyFollowTensionNotCompression )
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 8, 8, 8, 0.05f ) );
	for ( const float delay : { 0.05f, 0.0f } )
	{
		Adaptivity settings = levels( 2 );
		settings.mergeDelay = delay;
		const std::unique_ptr<Body> body = makeAdaptive( lattice, settings );
		Fracture fracture;
		fracture.breakStrain = 0.2f; // refined at half of it
		fracture.rule = BreakRule::Distance;
		ASSERT_TRUE( body->setFracture( fracture ).ok() );
		const auto nodesAt = [&]( const Vec3& stretch, int looks ) {
			for ( int k = 0; k < looks; ++k )
			{
				body->adaptLevels( 1.0f / 240.0f );
				NodeState& nodes = body->nodes();
				for ( int i = 0; i < nodes.count; ++i )
				{
					nodes.x.set( i, nodes.x0.get( i ).cwiseProduct( stretch ) );
					nodes.v.set( i, Vec3::Zero() );
				}
				body->accelerateTowardGoals( 1.0f / 240.0f, 1.0f, nullptr );
			}
			return body->nodeCount();
		};
		EXPECT_EQ( nodesAt( Vec3( 1.0f, 1.0f, 0.8f ), 60 ), 8 );
		EXPECT_EQ( nodesAt( Vec3( 1.09f, 1.0f, 1.0f ), 60 ), 8 );
		EXPECT_EQ( nodesAt( Vec3( 1.11f, 1.0f, 1.0f ), 60 ), 512 ) << delay;
		EXPECT_EQ( nodesAt( Vec3( 1.11f, 1.0f, 1.0f ), 1 ), 512 ) << delay;
		EXPECT_EQ( nodesAt( Vec3( 0.9f, 0.9f, 0.9f ), 60 ), 8 ) << delay;
	}
}

// Nodes that come to rest one by one are merged a few times a second, not at every review.
TEST( Levels, MergeNodesTogetherThatComeToRestOneByOne )
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 16, 8, 8, 0.05f ) );
	Adaptivity settings = levels( 1 );
	settings.mergeDelay = 0.2f;
	const std::unique_ptr<Body> body = makeAdaptive( lattice, settings );
	const std::vector<std::uint32_t> blocks = coarseNodes( *body, 1000 );
	body->changeLevels( blocks, {} );
	const unsigned before = body->levels()->version();
	constexpr int kSteps = 240;
	for ( int k = 0; k < kSteps; ++k ) // from one end on, the requests stop for a block per substep
	{
		for ( int i = 0; i < body->nodeCount() && k < int( blocks.size() ); ++i )
		{
			if ( body->levels()->levelOf( i ) == 0 &&
				body->levels()->octree().parent[body->levels()->cut().node[std::size_t( i )]] > blocks[std::size_t( k )] )
			{
				body->keepNode( i );
			}
		}
		body->adaptLevels( 1.0f / 240.0f );
	}
	EXPECT_EQ( body->nodeCount(), int( blocks.size() ) );
	EXPECT_LE( body->levels()->version() - before, 7u ); // every tenth of a second; at every review it would be 33
}

enum class Start
{
	Flat,
	Mirrored,
	Scrambled,
	OnePoint,
	HundredTimesAsLong
};

void distort( NodeState& nodes, Start start )
{
	test::Seeded random( 4 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 x = nodes.x.get( i );
		switch ( start )
		{
			case Start::Flat: nodes.x.set( i, Vec3( x.x(), x.y(), 0.0f ) ); break;
			case Start::Mirrored: nodes.x.set( i, Vec3( x.x(), x.y(), -x.z() ) ); break;
			case Start::Scrambled: nodes.x.set( i, random.inBox( 0.9f ) ); break;
			case Start::OnePoint: nodes.x.set( i, Vec3::Zero() ); break;
			case Start::HundredTimesAsLong: nodes.x.set( i, 100.0f * x ); break;
		}
	}
}

TEST( Levels, RecoverFromAnyShapeWithTheInitialNodes )
{
	const auto lattice = std::make_shared<const Lattice>( test::makeBlobLattice( 18, 0.1f, 2 ) );
	for ( const float kappa : { 0.0f, 0.8f } )
	{
		for ( const Start start : { Start::Flat, Start::Mirrored, Start::Scrambled, Start::OnePoint, Start::HundredTimesAsLong } )
		{
			Material material = test::explicitMaterial();
			material.volumeKeeping = kappa;
			Adaptivity settings = levels( 2 );
			settings.refineStrain = 0.15f;
			const std::unique_ptr<Body> body = makeAdaptive( lattice, settings, material );
			const int before = body->nodeCount();
			distort( body->nodes(), start );
			const float h = 1.0f / 240.0f;
			int most = before;
			for ( int step = 0; step < 2400; ++step )
			{
				body->adaptLevels( h );
				ASSERT_EQ( substep( *body, h, 0.9f ), BodyHealth::Good );
				most = std::max( most, body->nodeCount() );
			}
			EXPECT_GT( most, 2 * before );
			EXPECT_EQ( body->nodeCount(), before ) << "start " << int( start ) << ", kappa " << kappa;
			EXPECT_LT( test::shapeError( *body ), 1e-5 );
			EXPECT_EQ( test::invertedFraction( *body ), 0.0f );
		}
	}
}

TEST( Levels, ABudgetSpreadsALargeRequestOverSteps )
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 16, 16, 16, 0.05f ) );
	Adaptivity settings = levels( 2 );
	settings.nodesPerStep = 100;
	const std::unique_ptr<Body> body = makeAdaptive( lattice, settings );
	int reviews = 0;
	for ( int most = body->nodeCount(); body->nodeCount() < lattice->cellCount() && reviews < 200; ++reviews )
	{
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			body->requestSplit( i );
		}
		for ( int k = 0; k < kSubstepsBetweenReviews; ++k )
		{
			body->adaptLevels( 1.0f / 240.0f );
			substep( *body, 1.0f / 240.0f, 0.5f );
		}
		EXPECT_LE( body->nodeCount(), most + 100 );
		most = body->nodeCount();
	}
	EXPECT_EQ( body->nodeCount(), lattice->cellCount() );
	EXPECT_GT( reviews, 40 );
}

// All reviews within a game step share its budget; the rest waits for the next one.
TEST( Levels, ABudgetHoldsForAWholeGameStep )
{
	const auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 16, 16, 16, 0.05f ) );
	Adaptivity settings = levels( 1 );
	settings.nodesPerStep = 128;
	settings.mergeDelay = 60.0f;
	const std::unique_ptr<Body> body = makeAdaptive( lattice, settings );
	const int before = body->nodeCount();
	body->openLevelBudget();
	for ( int i = 0; i < before; ++i )
	{
		body->requestSplit( i );
	}
	constexpr int kBroughtByOne = 128 / 8 * 7;
	for ( int step = 1; step <= 32; ++step )
	{
		for ( int k = 0; k < 3 * kSubstepsBetweenReviews; ++k )
		{
			const bool hasChanged = body->adaptLevels( 1.0f / 240.0f );
			EXPECT_EQ( hasChanged, k == 0 ) << "step " << step << ", substep " << k;
			substep( *body, 1.0f / 240.0f, 0.5f );
		}
		EXPECT_EQ( body->nodeCount(), before + step * kBroughtByOne );
		body->openLevelBudget();
	}
	EXPECT_EQ( body->nodeCount(), lattice->cellCount() );
}

} // namespace
} // namespace pliant
