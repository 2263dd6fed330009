// Bars that are stretched to half of the strain at which they break, and held there for a minute: nothing ever breaks.

#include "world/test_world.h"

#include <cmath>
#include <tuple>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

constexpr float kCell = 0.05f, kBreakStrain = 0.1f;
constexpr int kLength = 24, kRamp = 120, kMinute = 3600; // cells, frames

/// Rule, elasticity, coarse levels, whether wobbles are damped.
using Kind = std::tuple<BreakRule, Elasticity, int, bool>;

class HalfLoaded : public ::testing::TestWithParam<Kind>
{};

TEST_P( HalfLoaded, BarsHoldForAMinute )
{
	const auto [rule, elasticity, levels, isDamped] = GetParam();
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	Material material = test::stiff( 1e5f );
	material.elasticity = elasticity;
	material.wobbleDamping = isDamped ? material.wobbleDamping : 0.0f;
	Adaptivity adaptivity;
	adaptivity.coarseLevels = levels;
	SoftBody* const bar = test.addSoft( block( kLength, 4, 4, kCell ), at( 0, 0, 0 ), material, adaptivity );
	Fracture fracture;
	fracture.rule = rule;
	fracture.breakStrain = kBreakStrain;
	fracture.shardSize = 4 * kCell;
	ASSERT_TRUE( bar->setFracture( fracture ).ok() );
	const btScalar grip = ( kLength / 2 - 2 ) * kCell;
	bar->pinNodesInside( btVector3( -9, -9, -9 ), btVector3( -grip, 9, 9 ) );
	bar->pinNodesInside( btVector3( grip, -9, -9 ), btVector3( 9, 9, 9 ) );
	btScalar pulledBefore = 0; // m, each end
	for ( int frame = 0; frame < kMinute; ++frame )
	{
		const double part = std::min( 1.0, double( frame + 1 ) / kRamp );
		const btScalar pull = btScalar( ( 0.5 - 0.5 * std::cos( SIMD_PI * part ) ) * 0.5 * double( kBreakStrain ) ) * grip;
		for ( int node = 0; node < bar->nodeCount() && frame < kRamp; ++node )
		{
			const btVector3 now = bar->nodePosition( node );
			const btScalar more = now.x() > 0 ? pull - pulledBefore : pulledBefore - pull;
			ASSERT_TRUE( !bar->isPinned( node ) || bar->driveNode( node, now + btVector3( more, 0, 0 ) ).ok() );
		}
		pulledBefore = pull;
		test.run( 1 );
		ASSERT_EQ( test.world.stepReport().brokenLinks, 0 ) << "after " << frame << " frames";
	}
	EXPECT_EQ( test.world.softBodyCount(), 1 );
	EXPECT_NEAR( pulledBefore, 0.5 * kBreakStrain * grip, 1e-6 );
}

INSTANTIATE_TEST_SUITE_P( All, HalfLoaded,
	::testing::Combine( ::testing::Values( BreakRule::Plane, BreakRule::Distance, BreakRule::Shards ),
		::testing::Values( Elasticity::Explicit, Elasticity::Implicit ), ::testing::Values( 0, 2 ), ::testing::Bool() ) );

} // namespace
} // namespace pliant
