// Plastic bodies: the permanent set of a pulled bar follows the yield law, on one level and on several, and survives changes of levels.

#include "body/breaking.h"
#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

constexpr float kPullStep = 0.001f;
constexpr float kCell = 0.1f;
constexpr int kLength = 16;

struct Pull
{
	float stretch, yieldStrain, creep, seconds;
	int coarseLevels;
};

Material materialOf( const Pull& pull )
{
	Material material = test::explicitMaterial();
	material.stiffness = Stiffness::RawAlpha;
	material.alpha = 0.9f; // waves cross the bar within 0.02 s, much faster than the flow
	material.damping = 20.0f;
	material.wobbleDamping = 0.5f;
	material.yieldStrain = pull.yieldStrain;
	material.plasticCreep = pull.creep;
	material.plasticLimit = 1.0f;
	return material;
}

std::unique_ptr<Body> makePulledBar( const Pull& pull )
{
	Adaptivity adaptivity;
	adaptivity.coarseLevels = pull.coarseLevels;
	adaptivity.refineStrain = 0.0f;
	adaptivity.isSurfaceFine = false;
	auto lattice = std::make_shared<Lattice>( makeBlockLattice( kLength, 4, 4, kCell ) );
	return std::move( Body::create( std::move( lattice ), materialOf( pull ), {}, nullptr, adaptivity ).value );
}

void run( Body& body, float seconds, float heldBeyond )
{
	for ( int k = 0; k < int( std::lround( seconds / kPullStep ) ); ++k )
	{
		body.accelerateTowardGoals( kPullStep, body.material().alpha, nullptr );
		NodeState& nodes = body.nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			if ( std::abs( nodes.x0.x[i] ) > heldBeyond )
			{
				nodes.v.x[i] = 0.0f; // held along the bar, free across it
			}
		}
		body.integrate( kPullStep );
	}
}

/// Returns the stretch along an axis, fitted over all nodes.
double stretchOf( const Body& body, int axis )
{
	double moment = 0.0, rest = 0.0;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const double x0 = body.nodes().x0.get( i )[axis];
		moment += double( body.nodes().mass[i] ) * body.nodes().worldPosition( i )[axis] * x0;
		rest += double( body.nodes().mass[i] ) * x0 * x0;
	}
	return moment / rest;
}

float endOf( const Body& body )
{
	float end = 0.0f;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		end = std::max( end, body.nodes().x0.x[i] );
	}
	return end - 0.1f * kCell;
}

std::unique_ptr<Body> pullBar( const Pull& pull )
{
	std::unique_ptr<Body> body = makePulledBar( pull );
	NodeState& nodes = body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.x[i] += ( pull.stretch - 1.0f ) * nodes.x0.x[i];
	}
	run( *body, pull.seconds, endOf( *body ) );
	return body;
}

class PulledBar : public testing::TestWithParam<Pull>
{};

// The law for a bar held at the stretch s: it is free across, and so without elastic strain there (nu = 0); along it e = s / p - 1, where p
// is the plastic stretch. The flow diag( 1 + h c e, 1, 1 ) scaled to det = 1 stretches by ( 1 + h c e )^( 2 / 3 ), so
//   p' = ( 2 / 3 ) c e p = ( 2 / 3 ) c ( s - p ),   p( t ) = s - ( s - 1 ) exp( - 2 c t / 3 ),   until e = yield, p = s / ( 1 + yield )
// and across the bar 1 / sqrt( p ).
TEST_P( PulledBar, KeepsWhatTheYieldLawSays )
{
	const Pull& pull = GetParam();
	const std::unique_ptr<Body> body = pullBar( pull );
	run( *body, 1.5f, 1e9f );
	const double s = pull.stretch, flowed = s - ( s - 1.0 ) * std::exp( -2.0 * double( pull.creep ) * double( pull.seconds ) / 3.0 );
	const double wanted = std::min( flowed, s / ( 1.0 + double( pull.yieldStrain ) ) );
	const double along = stretchOf( *body, 0 ), across = stretchOf( *body, 1 );
	std::printf( "%d levels, held at %.2f for %.1f s, yield %.2f, creep %.0f/s: set %.4f (%.4f), across %.4f (%.4f)\n", pull.coarseLevels,
		s, double( pull.seconds ), double( pull.yieldStrain ), double( pull.creep ), along - 1.0, wanted - 1.0, across - 1.0,
		1.0 / std::sqrt( wanted ) - 1.0 );
	EXPECT_NEAR( along - 1.0, wanted - 1.0, 0.1 * ( wanted - 1.0 ) );
	EXPECT_NEAR( across - 1.0, 1.0 / std::sqrt( wanted ) - 1.0, 0.1 * ( wanted - 1.0 ) );
}

INSTANTIATE_TEST_SUITE_P( Pulls, PulledBar,
	testing::Values( Pull{ 1.3f, 0.05f, 2.0f, 0.5f, 0 }, Pull{ 1.3f, 0.05f, 40.0f, 0.5f, 0 }, Pull{ 1.15f, 0.02f, 10.0f, 1.0f, 0 },
		Pull{ 1.3f, 0.05f, 2.0f, 0.5f, 1 }, Pull{ 1.3f, 0.05f, 40.0f, 0.5f, 1 } ) );

TEST( PlasticBody, BelowYieldNoSetRemains )
{
	for ( const int levels : { 0, 1 } )
	{
		const std::unique_ptr<Body> body = pullBar( Pull{ 1.03f, 0.05f, 40.0f, 0.3f, levels } );
		run( *body, 1.5f, 1e9f );
		EXPECT_FALSE( static_cast<const LatticeMatcher&>( body->matcher() ).plasticFlow() );
		EXPECT_NEAR( stretchOf( *body, 0 ), 1.0, 1e-4 );
	}
}

TEST( PlasticBody, FlowIsInheritedWhenLevelsChange )
{
	const std::unique_ptr<Body> body = pullBar( Pull{ 1.3f, 0.05f, 40.0f, 0.3f, 1 } );
	run( *body, 1.0f, 1e9f );
	const LatticeMatcher& matcher = static_cast<const LatticeMatcher&>( body->matcher() );
	const auto stretchAt = [&]( int node ) { return matcher.plasticFlow()->stretch( node ); };
	const double set = stretchOf( *body, 0 );
	const std::uint32_t coarse = body->levels()->cut().node[body->nodeCount() / 2];
	ASSERT_EQ( body->levels()->octree().levelOf( coarse ), 1 );
	const int slot = body->nodeCount() / 2;
	const Eigen::Matrix3d parent = stretchAt( slot );
	EXPECT_GT( ( parent - Eigen::Matrix3d::Identity() ).norm(), 0.1 );

	body->changeLevels( { coarse }, {} );
	for ( int child = slot; child < slot + 8; ++child )
	{
		EXPECT_EQ( body->levels()->lastChange().source[child], std::uint32_t( slot ) );
		EXPECT_LT( ( stretchAt( child ) - parent ).norm(), 1e-6 );
	}
	run( *body, 0.5f, 1e9f );
	EXPECT_NEAR( stretchOf( *body, 0 ), set, 0.02 * ( set - 1.0 ) );

	body->changeLevels( {}, { coarse } );
	EXPECT_LT( ( stretchAt( slot ) - parent ).norm(), 0.01 );
	EXPECT_NEAR( stretchAt( slot ).determinant(), 1.0, 1e-6 );
	run( *body, 0.5f, 1e9f );
	EXPECT_NEAR( stretchOf( *body, 0 ), set, 0.02 * ( set - 1.0 ) );
}

TEST( PlasticBody, PlacingItRestoresTheInitialShape )
{
	const std::unique_ptr<Body> body = pullBar( Pull{ 1.3f, 0.05f, 40.0f, 0.3f, 0 } );
	body->place( {} );
	run( *body, 0.2f, 1e9f );
	EXPECT_NEAR( stretchOf( *body, 0 ), 1.0, 1e-5 );
}

TEST( PlasticBody, CanBeSwitchedOnLater )
{
	for ( const int levels : { 0, 1 } )
	{
		Pull pull{ 1.3f, 0.0f, 40.0f, 0.1f, levels };
		const std::unique_ptr<Body> body = pullBar( pull );
		pull.yieldStrain = 0.05f;
		ASSERT_TRUE( body->setMaterial( materialOf( pull ) ).ok() );
		run( *body, 0.5f, endOf( *body ) );
		run( *body, 1.0f, 1e9f );
		const double set = stretchOf( *body, 0 );
		EXPECT_GT( set, 1.2 );
		pull.yieldStrain = 0.0f; // no further flow, but the set remains
		ASSERT_TRUE( body->setMaterial( materialOf( pull ) ).ok() );
		run( *body, 0.2f, 1e9f );
		EXPECT_NEAR( stretchOf( *body, 0 ), set, 1e-3 );
	}
}

// The rest shape survives.
TEST( PlasticBody, CanBeSwitchedOffAndOnAgain )
{
	Pull pull{ 1.3f, 0.05f, 40.0f, 0.5f, 0 };
	const std::unique_ptr<Body> body = pullBar( pull );
	run( *body, 1.0f, 1e9f );
	const double set = stretchOf( *body, 0 );
	for ( const float yieldStrain : { 0.0f, 0.05f } )
	{
		pull.yieldStrain = yieldStrain;
		ASSERT_TRUE( body->setMaterial( materialOf( pull ) ).ok() );
		run( *body, 0.2f, 1e9f );
		EXPECT_NEAR( stretchOf( *body, 0 ), set, 1e-3 );
	}
}

// Fragments of a body whose flow was switched off need tables of their own.
TEST( PlasticBody, KeepsItsShapeInPiecesAfterItWasSwitchedOff )
{
	Pull pull{ 1.3f, 0.05f, 40.0f, 0.5f, 0 };
	const std::unique_ptr<Body> body = pullBar( pull );
	run( *body, 1.0f, 1e9f );
	pull.yieldStrain = 0.0f;
	ASSERT_TRUE( body->setMaterial( materialOf( pull ) ).ok() );
	const LatticeMatcher& matcher = static_cast<const LatticeMatcher&>( body->matcher() );
	std::vector<Eigen::Matrix3d> before;
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		before.push_back( matcher.plasticFlow()->stretch( i ) );
	}
	body->breakLinks( test::linksAtFour( body->lattice(), kLength ) );
	BreakReport report;
	const std::vector<BodyPiece> pieces = body->breakApart( report, 10 );
	ASSERT_EQ( pieces.size(), 2u );
	for ( const BodyPiece& piece : pieces )
	{
		const PlasticFlow* flow = static_cast<const LatticeMatcher&>( piece.body->matcher() ).plasticFlow();
		ASSERT_TRUE( flow );
		for ( std::size_t i = 0; i < piece.nodeBefore.size(); ++i )
		{
			EXPECT_LT( ( flow->stretch( int( i ) ) - before[piece.nodeBefore[i]] ).norm(), 1e-6 );
		}
		run( *piece.body, 0.2f, 1e9f );
		EXPECT_TRUE( piece.body->nodes().x.get( 0 ).allFinite() );
	}
}

} // namespace
} // namespace pliant
