// The smallest body: a shattered one leaves hundreds of them.

#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

/// Its single goal is its own position, so the matcher does nothing and forces alone move it.
TEST( SingleCell, IsMovedByForcesAlone )
{
	const auto body = test::makeBlock( 1, 1, 1, 0.1f );
	NodeState& nodes = body->nodes();
	nodes.v.set( 0, Vec3( 1.0f, 2.0f, 3.0f ) );
	LatticeMatcher matcher( body->lattice(), body->material() );
	NodeState matched = nodes;
	matcher.reset( matched, Eigen::Quaterniond::Identity() );
	for ( int k = 0; k < 100; ++k )
	{
		body->accelerateTowardGoals( 1.0f / 240.0f, 1.0f, nullptr );
		body->applyForces( 1.0f / 240.0f, Vec3( 0.0f, -10.0f, 0.0f ) );
		body->integrate( 1.0f / 240.0f );
	}
	matcher.accelerate( matched, MatchStep{ 1.0f / 240.0f, 1.0f, 10.0f, 10.0f, 0.0f, false, PlasticLaw{}, {} }, nullptr );
	EXPECT_LT( ( matched.v.get( 0 ) - Vec3( 1.0f, 2.0f, 3.0f ) ).norm(), 1e-5f );
	EXPECT_NEAR( double( nodes.v.y[0] ), 2.0 - 1000.0 / 240.0, 1e-4 );
	EXPECT_EQ( nodes.v.x[0], 1.0f );
	EXPECT_EQ( nodes.v.z[0], 3.0f );
}

} // namespace
} // namespace pliant
