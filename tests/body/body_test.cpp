// One body without a world: placing, pinning, teleporting, bad numbers, bad input.

#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace pliant {
namespace {

constexpr float kStep = 1.0f / 240.0f;

TEST( Body, RefusesAnEmptyLatticeAndABadMaterial )
{
	EXPECT_EQ( Body::create( nullptr, {}, {} ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( Body::create( std::make_shared<Lattice>(), {}, {} ).status.code, ResultCode::BadArgument );
	Material bad = test::explicitMaterial();
	bad.density = 0.0f;
	const auto made = Body::create( std::make_shared<Lattice>( makeBlockLattice( 2, 2, 2, 0.1f ) ), bad, {} );
	EXPECT_EQ( made.status.code, ResultCode::BadMaterial );
	EXPECT_FALSE( made.value );
}

TEST( Body, HasTheMassOfItsMaterial )
{
	Material material = test::explicitMaterial();
	material.density = 500.0f;
	const auto body = test::makeBlock( 5, 4, 3, 0.1f, material );
	EXPECT_NEAR( body->sums().mass, 500.0 * 0.5 * 0.4 * 0.3, 1e-4 );
	material.density = 1000.0f;
	ASSERT_TRUE( body->setMaterial( material ).ok() );
	EXPECT_NEAR( body->sums().mass, 1000.0 * 0.5 * 0.4 * 0.3, 1e-4 );
}

TEST( Body, IsWhereItIsPlaced )
{
	const auto body = test::makeBlock( 5, 4, 3, 0.1f );
	const Placement placement{ Eigen::Quaterniond( Eigen::AngleAxisd( 1.0, Vec3d( 1, 1, 0 ).normalized() ) ), Vec3d( 1000, -2, 3 ) };
	body->place( placement );
	EXPECT_LT( ( body->bestFit().position - placement.position ).norm(), 1e-6 );
	EXPECT_LT( body->bestFit().rotation.angularDistance( placement.rotation ), 1e-6 );
	for ( int k = 0; k < 240; ++k )
	{
		test::substep( *body, kStep, 1.0f );
	}
	EXPECT_LT( ( body->bestFit().position - placement.position ).norm(), 1e-5 );
	EXPECT_LT( test::shapeError( *body ), 1e-6 );
}

TEST( Body, ForgetsItsHistoryWhenPlacedAgain )
{
	const auto fresh = test::makeBlock( 5, 4, 3, 0.1f ), used = test::makeBlock( 5, 4, 3, 0.1f );
	used->nodes().v.x[3] = 5.0f;
	for ( int k = 0; k < 50; ++k )
	{
		test::substep( *used, kStep, 0.5f );
	}
	used->place( {} );
	for ( const auto& body : { fresh.get(), used.get() } )
	{
		body->nodes().v.z[0] = 1.0f;
		for ( int k = 0; k < 20; ++k )
		{
			test::substep( *body, kStep, 0.5f );
		}
	}
	EXPECT_EQ( std::memcmp( fresh->nodes().x.x.data(), used->nodes().x.x.data(), sizeof( float ) * fresh->nodeCount() ), 0 );
}

TEST( Body, RotatesVelocitiesAndResidualsWhenTeleported )
{
	const auto home = test::makeBlock( 5, 4, 3, 0.1f ), away = test::makeBlock( 5, 4, 3, 0.1f );
	const Placement by{ Eigen::Quaterniond( Eigen::AngleAxisd( 2.0, Vec3d( 1, 2, 3 ).normalized() ) ), Vec3d( 7, 8, 9 ) };
	for ( Body* body : { home.get(), away.get() } )
	{
		body->nodes().v.set( 7, Vec3( 1, 2, 3 ) );
		for ( int k = 0; k < 10; ++k )
		{
			test::substep( *body, kStep, 0.5f );
		}
	}
	away->teleport( by );
	for ( int k = 0; k < 10; ++k )
	{
		test::substep( *home, kStep, 0.5f );
		test::substep( *away, kStep, 0.5f );
	}
	for ( int i = 0; i < home->nodeCount(); ++i )
	{
		const Vec3d wanted = by.rotation * home->nodes().worldPosition( i ) + by.position;
		EXPECT_LT( ( away->nodes().worldPosition( i ) - wanted ).norm(), 2e-6 );
	}
}

TEST( Body, PinnedNodesKeepTheVelocityTheyAreGiven )
{
	const auto body = test::makeBlock( 4, 6, 4, 0.1f );
	for ( int i = 0; i < 16; ++i )
	{
		body->setPinned( i, true );
	}
	body->setPinned( 3, true );
	body->nodes().v.set( 3, Vec3( 0.25f, 0, 0 ) );
	const Vec3 still = body->nodes().x.get( 5 ), moving = body->nodes().x.get( 3 );
	for ( int k = 0; k < 240; ++k )
	{
		test::substep( *body, kStep, 0.5f, Vec3( 0, -9.81f, 0 ) );
	}
	EXPECT_EQ( body->nodes().x.get( 5 ), still );
	EXPECT_NEAR( body->nodes().x.get( 3 ).x() - moving.x(), 0.25f, 1e-5f );
}

TEST( Body, ComputesFarOutAsAtTheOrigin )
{
	// 100 km from the origin every node computes bit-identical results, because the state is relative to the body.
	const auto home = test::makeBlock( 5, 5, 5, 0.1f ), away = test::makeBlock( 5, 5, 5, 0.1f );
	away->place( Placement{ Eigen::Quaterniond::Identity(), Vec3d( 1e5, -1e5, 1e5 ) } );
	for ( Body* body : { home.get(), away.get() } )
	{
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			body->nodes().v.set( i, Vec3( 3, 1, 2 ) + Vec3( 0, 4, 0 ).cross( body->nodes().x.get( i ) ) );
		}
		for ( int k = 0; k < 2400; ++k ) // travels 37 m; the origin follows several times
		{
			test::substep( *body, kStep, 0.4f );
		}
	}
	EXPECT_EQ( away->nodes().origin - home->nodes().origin, Vec3d( 1e5, -1e5, 1e5 ) );
	EXPECT_EQ( std::memcmp( home->nodes().x.x.data(), away->nodes().x.x.data(), sizeof( float ) * home->nodeCount() ), 0 );
	EXPECT_EQ( std::memcmp( home->nodes().v.z.data(), away->nodes().v.z.data(), sizeof( float ) * home->nodeCount() ), 0 );
}

TEST( Body, IsResetAndStoppedAtANonFiniteNumber )
{
	const auto body = test::makeBlock( 5, 5, 5, 0.1f );
	for ( float bad : { std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity() } )
	{
		for ( int where = 0; where < 3; ++where )
		{
			test::substep( *body, kStep, 0.5f );
			const Vec3d before = body->bestFit().position;
			if ( where == 0 )
			{
				body->nodes().v.y[17] = bad;
			}
			if ( where == 1 )
			{
				body->nodes().x.x[3] = bad;
			}
			BodyHealth health = BodyHealth::Good;
			if ( where == 2 )
			{
				health = test::substep( *body, kStep, 0.5f, Vec3( 0, bad, 0 ) );
			}
			else
			{
				health = test::substep( *body, kStep, 0.5f );
			}
			EXPECT_EQ( health, BodyHealth::Quarantined );
			const BodySums sums = body->sums();
			EXPECT_EQ( sums.kineticEnergy, 0.0 );
			EXPECT_LT( ( body->bestFit().position - before ).norm(), 1e-6 );
			EXPECT_EQ( test::substep( *body, kStep, 0.5f ), BodyHealth::Good ); // the simulation can continue
		}
	}
}

TEST( Body, SupportsASingleCell )
{
	const auto body = test::makeBlock( 1, 1, 1, 0.1f );
	for ( int k = 0; k < 240; ++k )
	{
		ASSERT_EQ( test::substep( *body, kStep, 1.0f, Vec3( 0, -9.81f, 0 ) ), BodyHealth::Good );
	}
	EXPECT_NEAR( body->bestFit().position.y(), -0.5 * 9.81 * ( 1.0 + kStep ), 1e-3 );
}

} // namespace
} // namespace pliant
