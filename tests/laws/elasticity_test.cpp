// A lattice of regions is an elastic solid: hanging and swinging bars and standing blocks agree with rod theory at any step and resolution.
// Young's modulus is the one set, Poisson's ratio 0.

#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/inverted_fraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pliant {
namespace {

constexpr float kPiF = 3.14159265f;

struct Bar
{
	int cells; ///< along its length
	int halfWidth;
	float h; ///< s
};

struct BarResult
{
	double sagError;    ///< relative
	double periodError; ///< relative
};

float topRow( const Body& body )
{
	return body.nodes().x0.y[body.nodeCount() - 1];
}

double meanTipDrop( const Body& body )
{
	const NodeState& nodes = body.nodes();
	double sum = 0.0;
	int count = 0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( nodes.x0.y[i] < -topRow( body ) + 0.5f * body.lattice().cellSize )
		{
			sum += double( nodes.x0.y[i] ) - ( nodes.origin.y() + nodes.x.y[i] );
			++count;
		}
	}
	return sum / count;
}

/// Hangs a bar by its upper cells, releases it, and follows eight swings without damping.
BarResult swing( const Bar& bar )
{
	const float length = 1.6f, gravity = 0.3f;
	const float d = length / float( bar.cells );
	Material material = test::explicitMaterial();
	material.regionHalfWidth = bar.halfWidth;
	material.damping = 0.0f;
	material.wobbleDamping = 0.0f;
	// The modulus that alpha = 0.9 reaches at the longest step, the same for all steps.
	material.youngsModulus = 0.9f * planStiffness( material, d, 1.0f / 60.0f, 1 ).reachedModulus /
		planStiffness( material, d, 1.0f / 60.0f, 1 ).alpha;
	const StiffnessPlan plan = planStiffness( material, d, bar.h, 1 );
	EXPECT_TRUE( plan.reachable );
	const auto body = test::makeBlock( 4, bar.cells, 4, d, material );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->setPinned( i, body->nodes().x0.y[i] > topRow( *body ) - 0.5f * d );
	}

	// Rod of free length L = ( n - 1/2 ) d below the pinned cells' centres: T = 4 L sqrt( rho / E ),
	// sag at s = rho g ( L s - s^2 / 2 ) / E, the lowest centres at s = ( n - 1 ) d.
	const double free = ( bar.cells - 0.5 ) * d, s = ( bar.cells - 1 ) * d;
	const double period = 4.0 * free * std::sqrt( material.density / material.youngsModulus );
	const double sag = material.density * gravity * ( free * s - 0.5 * s * s ) / material.youngsModulus;

	std::vector<double> drop( std::size_t( 10.0 * period / bar.h ) );
	for ( double& value : drop )
	{
		test::substep( *body, bar.h, plan.alpha, Vec3( 0, -gravity, 0 ) );
		value = meanTipDrop( *body );
	}
	std::vector<double> crossings;
	for ( std::size_t k = 1; k < drop.size(); ++k )
	{
		if ( drop[k - 1] < sag && drop[k] >= sag )
		{
			crossings.push_back( ( double( k ) - ( drop[k] - sag ) / ( drop[k] - drop[k - 1] ) ) * bar.h );
		}
	}
	BarResult result{};
	if ( crossings.size() < 5 )
	{
		ADD_FAILURE() << "the bar does not swing";
		return result;
	}
	const double measured = ( crossings.back() - crossings.front() ) / double( crossings.size() - 1 );
	const std::size_t whole = std::min( drop.size(), std::size_t( 8.0 * measured / bar.h + 0.5 ) );
	double mean = 0.0;
	for ( std::size_t k = 0; k < whole; ++k )
	{
		mean += drop[k] / double( whole );
	}
	result.sagError = mean / sag - 1.0;
	result.periodError = measured / period - 1.0;
	std::printf( "bar of %d cells, w = %d, h = 1/%.0f s: sag %+.2f %%, period %+.2f %%\n", bar.cells, bar.halfWidth, 1.0 / bar.h,
		100.0 * result.sagError, 100.0 * result.periodError );
	return result;
}

class HangingBar : public testing::TestWithParam<float>
{};

TEST_P( HangingBar, SwingsAndSagsAsRodTheorySays )
{
	const BarResult narrow = swing( { 16, 1, GetParam() } );
	EXPECT_LT( std::abs( narrow.periodError ), 0.02 );
	EXPECT_LT( std::abs( narrow.sagError ), 0.05 );
}

TEST_P( HangingBar, WithWiderRegionsErrsAtItsEndsAndHalvesThatWithTheCells )
{
	const BarResult coarse = swing( { 16, 2, GetParam() } ), fine = swing( { 32, 2, GetParam() } );
	EXPECT_LT( std::abs( coarse.periodError ), 0.06 );
	EXPECT_LT( std::abs( coarse.sagError ), 0.12 );
	EXPECT_LT( std::abs( fine.periodError ), 0.5 * std::abs( coarse.periodError ) + 0.002 );
	EXPECT_LT( std::abs( fine.sagError ), 0.5 * std::abs( coarse.sagError ) + 0.002 );
}

INSTANTIATE_TEST_SUITE_P( Steps, HangingBar, testing::Values( 1.0f / 60.0f, 1.0f / 120.0f, 1.0f / 240.0f, 1.0f / 480.0f ) );

/// A cube of 1 m and E = 10 rho g L stands on frictionless ground; returns its sag over theory's, at the top row of centres.
double standingSag( int cells )
{
	const float d = 1.0f / float( cells ), gravity = 9.81f;
	Material material = test::explicitMaterial();
	material.youngsModulus = 10.0f * material.density * gravity;
	const int substeps = std::max( 4, planStiffness( material, d, 1.0f / 60.0f, 4 ).substepsNeeded );
	const StiffnessPlan plan = planStiffness( material, d, 1.0f / 60.0f, substeps );
	const float h = 1.0f / 60.0f / float( substeps );
	const auto body = test::makeBlock( cells, cells, cells, d, material );
	NodeState& nodes = body->nodes();
	const float ground = nodes.x0.y[0];
	for ( int k = 0; k < 5 * 60 * substeps; ++k )
	{
		body->accelerateTowardGoals( h, plan.alpha, nullptr );
		body->applyForces( h, Vec3( 0, -gravity, 0 ) );
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.v.y[i] = std::max( nodes.v.y[i], ( ground - nodes.x.y[i] - float( nodes.origin.y() ) ) / h );
		}
		body->integrate( h );
	}
	double sag = 0.0;
	int count = 0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( nodes.x0.y[i] > -ground - 0.5f * d )
		{
			sag += nodes.x0.y[i] - nodes.x.y[i] - nodes.origin.y();
			++count;
		}
	}
	sag /= count;
	// Between the lowest and the highest row of centres: rho g ( L s - s^2 / 2 ) / E with L = 1 - d / 2, s = 1 - d.
	const double length = 1.0 - 0.5 * d, s = 1.0 - d;
	const double theory = material.density * gravity * ( length * s - 0.5 * s * s ) / material.youngsModulus;
	std::printf( "block of %d nodes, %d substeps: sag %.4f m, theory %.4f m (%+.1f %%), inverted %.4f\n", nodes.count, substeps, sag,
		theory, 100.0 * ( sag / theory - 1.0 ), double( test::invertedFraction( *body ) ) );
	EXPECT_EQ( test::invertedFraction( *body ), 0.0f );
	return sag / theory;
}

TEST( StandingBlock, SagsTheSameAtEveryResolution )
{
	EXPECT_NEAR( standingSag( 6 ), 1.0, 0.15 );
	EXPECT_NEAR( standingSag( 13 ), 1.0, 0.15 );
}

TEST( StandingBlockFull, SagsTheSameAt19683Nodes )
{
	EXPECT_NEAR( standingSag( 27 ), 1.0, 0.15 );
}

TEST( WobbleDamping, TakesTheFractionOfCriticalItPromises )
{
	// A free bar stretched along its axis: amplitude falls by exp( - zeta omega t ); after one period by exp( - 2 pi zeta ).
	Material material = test::explicitMaterial();
	material.youngsModulus = 2e4f;
	material.damping = 0.0f;
	material.wobbleDamping = 0.1f;
	const float d = 0.05f, h = 1.0f / 960.0f;
	const auto body = test::makeBlock( 20, 4, 4, d, material );
	NodeState& nodes = body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.x[i] += 0.02f * std::sin( kPiF * nodes.x0.x[i] / 1.0f );
	}
	const float omega = kPiF * std::sqrt( material.youngsModulus / material.density );
	const float alpha = planStiffness( material, d, h, 1 ).alpha;
	const auto stretch = [&] { return nodes.x.x[nodes.count - 1] - nodes.x.x[0] - ( nodes.x0.x[nodes.count - 1] - nodes.x0.x[0] ); };
	const float before = stretch();
	for ( int k = 0; k < int( 2.0f * kPiF / omega / h + 0.5f ); ++k )
	{
		test::substep( *body, h, alpha );
	}
	EXPECT_NEAR( stretch() / before, std::exp( -2.0f * kPiF * 0.1f ), 0.05f );
}

} // namespace
} // namespace pliant
