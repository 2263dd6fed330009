// Stiffness that varies in space: Steinemann et al. 2008, section 4.2 and Fig. 4.

#include "body/levels/levels.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

float quarterBelow( const float* point, void* )
{
	return point[0] < 0.0f ? 0.25f : 1.0f; // the block is centred on the origin
}

float one( const float*, void* )
{
	return 1.0f;
}

float nothing( const float*, void* )
{
	return 0.0f;
}

std::unique_ptr<Body> makeBar( const Adaptivity& adaptivity, const StiffnessField& field )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = 2e4f;
	material.damping = 60.0f;
	material.wobbleDamping = 1.0f;
	auto lattice = std::make_shared<Lattice>( makeBlockLattice( 24, 4, 4, 0.1f ) );
	Result<std::unique_ptr<Body>> made = Body::create( std::move( lattice ), material, {}, nullptr, adaptivity, field );
	EXPECT_TRUE( made.ok() ) << made.status.sentence;
	return std::move( made.value );
}

/// Returns the stretch between two rest positions, from the nodes within half a cell of the slabs there.
double strainBetween( const Body& body, float from, float to )
{
	double sum[2] = {}, rest[2] = {}, mass[2] = {};
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const float x0 = body.nodes().x0.get( i ).x();
		for ( int end = 0; end < 2; ++end )
		{
			if ( std::abs( x0 - ( end == 0 ? from : to ) ) < 0.11f )
			{
				sum[end] += double( body.nodes().mass[i] ) * body.nodes().worldPosition( i ).x();
				rest[end] += double( body.nodes().mass[i] ) * double( x0 );
				mass[end] += double( body.nodes().mass[i] );
			}
		}
	}
	return ( sum[1] / mass[1] - sum[0] / mass[0] ) / ( rest[1] / mass[1] - rest[0] / mass[0] ) - 1.0;
}

TEST( StiffnessField, FactorsOutOfRangeAreRefused )
{
	auto lattice = std::make_shared<const Lattice>( makeBlockLattice( 4, 4, 4, 0.1f ) );
	EXPECT_EQ( Body::create( lattice, {}, {}, nullptr, {}, StiffnessField{ &nothing, nullptr } ).status.code, ResultCode::BadArgument );
	Material cluster = test::explicitMaterial();
	cluster.method = Method::SingleCluster;
	EXPECT_EQ( Body::create( lattice, cluster, {}, nullptr, {}, StiffnessField{ &one, nullptr } ).status.code, ResultCode::BadArgument );
}

TEST( StiffnessField, AQuarterAsStiffStretchesFourTimesAsFar )
{
	for ( int levels = 0; levels <= 1; ++levels )
	{
		Adaptivity adaptivity;
		adaptivity.coarseLevels = levels;
		const std::unique_ptr<Body> body = makeBar( adaptivity, StiffnessField{ &quarterBelow, nullptr } );
		NodeState& nodes = body->nodes();
		nodes.force.resize( nodes.padded );
		const float h = 1.0f / 240.0f;
		const StiffnessPlan plan = planStiffness( body->material(), 0.1f, h, 1 );
		const float end = levels == 0 ? 1.1f : 1.0f;
		int loaded = 0;
		for ( int i = 0; i < nodes.count; ++i )
		{
			loaded += nodes.x0.get( i ).x() > end ? 1 : 0;
		}
		for ( int i = 0; i < nodes.count; ++i )
		{
			// 0.5 % of E over the end's 0.16 m^2
			const float force = 0.005f * 2e4f * 0.16f / float( loaded ), x = nodes.x0.get( i ).x();
			nodes.force.x[i] = x > end ? force : x < -end ? -force : 0.0f;
		}
		for ( int step = 0; step < 6000; ++step )
		{
			test::substep( *body, h, plan.alpha );
		}
		const double soft = strainBetween( *body, -0.9f, -0.3f ), hard = strainBetween( *body, 0.3f, 0.9f );
		std::printf( "levels %d: strain %.4f where soft, %.4f where hard, ratio %.3f\n", levels, soft, hard, soft / hard );
		EXPECT_NEAR( soft / hard, 4.0, 0.4 );
		EXPECT_NEAR( hard, 0.005, 0.0003 );
		const BodySums sums = body->sums();
		EXPECT_LT( sums.momentum.norm() / sums.mass, 1e-6 );
	}
}

TEST( StiffnessField, OfOneEverywhereChangesNothing )
{
	for ( int levels = 0; levels <= 2; levels += 2 )
	{
		Adaptivity adaptivity;
		adaptivity.coarseLevels = levels;
		const std::unique_ptr<Body> with = makeBar( adaptivity, StiffnessField{ &one, nullptr } ), without = makeBar( adaptivity, {} );
		test::Seeded random( 3 );
		for ( int i = 0; i < with->nodeCount(); ++i )
		{
			const Vec3 shake = random.inBox( 0.02f );
			with->nodes().x.set( i, with->nodes().x.get( i ) + shake );
			without->nodes().x.set( i, without->nodes().x.get( i ) + shake );
		}
		for ( int step = 0; step < 20; ++step )
		{
			test::substep( *with, 1.0f / 240.0f, 0.5f );
			test::substep( *without, 1.0f / 240.0f, 0.5f );
		}
		for ( int i = 0; i < with->nodeCount(); ++i )
		{
			EXPECT_LT(
				( with->nodes().x.get( i ) - without->nodes().x.get( i ) ).norm(), 1e-6f ); // the pull differs from 1 by rounding only
		}
	}
}

} // namespace
} // namespace pliant
