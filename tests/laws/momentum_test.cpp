// Conservation for a body without external forces.

#include "support/block_body.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

struct Drift
{
	double linear, angular; ///< relative
};

/// Sets a block in motion, spinning and vibrating, and returns the drift of its momenta after some substeps.
Drift fly( const Material& material, int substeps )
{
	const auto body = test::makeBlock( 8, 6, 7, 0.1f, material );
	NodeState& nodes = body->nodes();
	test::Seeded random( 3 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 x = nodes.x.get( i );
		nodes.v.set( i, Vec3( 1, 2, -1 ) + Vec3( 1, 2, 3 ).cross( x ) + Vec3( 0.5f * x.x(), -0.7f * x.y(), x.x() * x.y() ) );
		nodes.x.set( i, x + random.inBox( 0.02f ) );
	}
	const float h = 1.0f / 240.0f;
	const float alpha = planStiffness( material, 0.1f, 1.0f / 60.0f, 4 ).alpha;
	const BodySums before = body->sums();
	for ( int k = 0; k < substeps; ++k )
	{
		EXPECT_EQ( test::substep( *body, h, alpha ), BodyHealth::Good );
	}
	const BodySums after = body->sums();
	const Drift drift{
		( after.momentum - before.momentum ).norm() / before.momentum.norm(), ( after.spin - before.spin ).norm() / before.spin.norm() };
	std::printf( "w = %d, %s weights, %d substeps: linear %.1e, angular %.1e\n", material.regionHalfWidth,
		material.weights == Weights::Conserving ? "conserving" : "literal", substeps, drift.linear, drift.angular );
	return drift;
}

TEST( FreeFlight, KeepsBothMomentaWithDefaultSettings )
{
	for ( int halfWidth : { 1, 2 } )
	{
		Material material = test::explicitMaterial();
		material.regionHalfWidth = halfWidth;
		const Drift near = fly( material, 600 ), far = fly( material, 10000 );
		EXPECT_LT( near.linear, 1e-5 );
		EXPECT_LT( near.angular, 1e-4 );
		EXPECT_LT( far.linear, 5e-4 );
		EXPECT_LT( far.angular, 5e-4 );
	}
}

TEST( FreeFlight, LeaksWithThePapersLiteralWeights )
{
	Material material = test::explicitMaterial();
	material.weights = Weights::Literal;
	const Drift drift = fly( material, 600 );
	EXPECT_GT( std::max( drift.linear, drift.angular ), 1e-4 ); // otherwise the literal mode would not be literal
}

TEST( FreeFlight, NeverGainsEnergy )
{
	Material material = test::explicitMaterial();
	const auto body = test::makeBlock( 6, 6, 6, 0.1f, material );
	NodeState& nodes = body->nodes();
	test::Seeded random( 5 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.v.set( i, random.inBox( 2.0f ) );
	}
	const double start = body->sums().kineticEnergy;
	const float alpha = planStiffness( material, 0.1f, 1.0f / 60.0f, 4 ).alpha;
	double largest = 0.0;
	for ( int k = 0; k < 2400; ++k )
	{
		test::substep( *body, 1.0f / 240.0f, alpha );
		largest = std::max( largest, body->sums().kineticEnergy );
	}
	EXPECT_LT( largest, start );
}

} // namespace
} // namespace pliant
