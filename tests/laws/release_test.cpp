// A body recovers from any state: flat, mirrored, scrambled, one point, enlarged, and from steps that are far too long.

#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/inverted_fraction.h"

#include <gtest/gtest.h>

#include <functional>

namespace pliant {
namespace {

using Mangle = std::function<Vec3( const Vec3&, test::Seeded& )>;

/// Distorts a 1 m block of n cells an edge, waits ten seconds with default settings, and checks that it has recovered.
void expectReturn( int cells, const Mangle& mangle )
{
	const auto body = test::makeBlock( cells, cells, cells, 1.0f / float( cells ) );
	NodeState& nodes = body->nodes();
	test::Seeded random( 11 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, mangle( nodes.x.get( i ), random ) );
	}
	const float alpha = planStiffness( body->material(), 1.0f / float( cells ), 1.0f / 60.0f, 4 ).alpha;
	for ( int k = 0; k < 2400; ++k )
	{
		ASSERT_EQ( test::substep( *body, 1.0f / 240.0f, alpha ), BodyHealth::Good );
	}
	EXPECT_EQ( test::invertedFraction( *body ), 0.0f );
	EXPECT_LT( test::shapeError( *body ), 1e-3 ); // of an edge
	std::printf( "%d cells an edge: shape error %.1e m after 10 s\n", cells, test::shapeError( *body ) );
}

class Release : public testing::TestWithParam<int>
{};

TEST_P( Release, FromFlat )
{
	expectReturn( GetParam(), []( const Vec3& x, test::Seeded& ) { return Vec3( x.x(), 0.0f, x.z() ); } );
}

TEST_P( Release, FromItsMirrorImage )
{
	expectReturn( GetParam(), []( const Vec3& x, test::Seeded& ) { return Vec3( x.x(), -x.y(), x.z() ); } );
	expectReturn( GetParam(), []( const Vec3& x, test::Seeded& ) { return Vec3( x.x(), -0.25f * x.y(), x.z() ); } );
}

TEST_P( Release, FromScrambled )
{
	expectReturn( GetParam(), []( const Vec3&, test::Seeded& random ) { return random.inBox( 0.5f ); } );
}

TEST_P( Release, FromOnePoint )
{
	expectReturn( GetParam(), []( const Vec3&, test::Seeded& ) { return Vec3( 0, 0, 0 ); } );
}

TEST_P( Release, FromALine )
{
	expectReturn( GetParam(), []( const Vec3& x, test::Seeded& ) { return Vec3( x.x(), 0.0f, 0.0f ); } );
}

INSTANTIATE_TEST_SUITE_P( Sizes, Release, testing::Values( 6, 8 ) );

TEST( LongStep, OfATenthOfASecondReturnsToRestToo )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = 1e5f; // far out of reach at this step: alpha is limited to 1
	const auto body = test::makeBlock( 8, 8, 8, 0.125f, material );
	NodeState& nodes = body->nodes();
	const float alpha = planStiffness( material, 0.125f, 0.1f, 1 ).alpha;
	EXPECT_EQ( alpha, 1.0f );
	test::Seeded random( 13 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, random.inBox( 0.5f ) );
	}
	for ( int k = 0; k < 100; ++k )
	{
		ASSERT_EQ( test::substep( *body, 0.1f, alpha ), BodyHealth::Good );
	}
	EXPECT_EQ( test::invertedFraction( *body ), 0.0f );
	EXPECT_LT( test::shapeError( *body ), 1e-3 );
}

TEST( BodyFraction, CarriesTheWeightTheRegionsCannot )
{
	// Hung by its upper cells, E far out of the regions' reach at this step: without the whole-body match it would sag
	// by many times its own length ( E_f = 1.2 kPa against rho g L = 9.8 kPa ).
	Material material = test::explicitMaterial();
	material.youngsModulus = 1e6f;
	const float d = 0.05f, h = 1.0f / 60.0f;
	const auto body = test::makeBlock( 4, 20, 4, d, material );
	NodeState& nodes = body->nodes();
	const float top = nodes.x0.y[nodes.count - 1];
	for ( int i = 0; i < nodes.count; ++i )
	{
		body->setPinned( i, nodes.x0.y[i] > top - 0.5f * d );
	}
	for ( int k = 0; k < 600; ++k )
	{
		test::substep( *body, h, 1.0f, Vec3( 0, -9.81f, 0 ) );
	}
	const double withFraction = -top - nodes.x.y[0] - nodes.origin.y();
	std::printf( "lowest cell hangs %.3f m below its rest place, regions alone would let it %.3f m\n", withFraction,
		0.5 * 1000.0 * 9.81 / planStiffness( material, d, h, 1 ).reachedModulus );
	EXPECT_LT( withFraction, 0.1 * 0.5 * 1000.0 * 9.81 / planStiffness( material, d, h, 1 ).reachedModulus );
	EXPECT_EQ( test::invertedFraction( *body ), 0.0f );
}

} // namespace
} // namespace pliant
