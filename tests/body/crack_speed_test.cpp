// The interval between break tests of a cracked body: cracks propagate at half the wave speed at most.

#include "body/body.h"
#include "body/breaking.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr float kCrackStep = 1.0f / 240.0f;

/// A slab that is weak in the middle of one side, stretched by displacing its nodes.
std::unique_ptr<Body> pulledSlab( Stiffness stiffness )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = 2.5e4f; // wave speed 5 m/s, so that a crack crosses a cell in 40 ms
	material.stiffness = stiffness;
	auto made = Body::create( std::make_shared<const Lattice>( makeBlockLattice( 8, 12, 3, 0.1f ) ), material, {}, nullptr, {} );
	EXPECT_TRUE( made.ok() );
	Fracture brittle;
	brittle.rule = BreakRule::Plane;
	brittle.breakStrain = 0.1f;
	brittle.coolDown = 10.0f;
	const ToughnessField notch{
		[]( const float* point, const float*, void* ) { return point[0] * point[0] < 0.01f && point[1] < -0.35f ? 0.4f : 1.0f; }, nullptr };
	EXPECT_TRUE( made.value->setFracture( brittle, notch ).ok() );
	for ( int i = 0; i < made.value->nodeCount(); ++i )
	{
		made.value->nodes().x.x[i] *= 1.08f;
	}
	return std::move( made.value );
}

/// Returns the number of substeps until the next break test.
int untilLook( Body& body )
{
	int steps = 0;
	do
	{
		body.testLinks( kCrackStep );
		++steps;
	} while ( body.breaking()->sinceTest > 0.0f && steps < 100 );
	return steps;
}

std::unique_ptr<Body> cracked( std::unique_ptr<Body> body )
{
	EXPECT_EQ( untilLook( *body ), 1 );
	EXPECT_TRUE( body->hasBrokenLinks() );
	BreakReport report;
	std::vector<BodyPiece> pieces = body->breakApart( report, 10 );
	EXPECT_EQ( pieces.size(), 1u );
	return std::move( pieces[0].body );
}

TEST( CrackSpeed, IsHalfTheWaveSpeed )
{
	std::unique_ptr<Body> body = cracked( pulledSlab( Stiffness::YoungsModulus ) );
	EXPECT_EQ( untilLook( *body ), 10 ); // 41.7 ms; nine substeps are more than half a substep short of 40 ms
	EXPECT_EQ( untilLook( *body ), 10 );
}

TEST( CrackSpeed, IntactBodiesAreTestedInEverySubstep )
{
	std::unique_ptr<Body> body = pulledSlab( Stiffness::YoungsModulus );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->nodes().x.x[i] /= 1.08f;
	}
	for ( int look = 0; look < 20; ++look )
	{
		EXPECT_EQ( untilLook( *body ), 1 );
	}
}

/// The wave speed is unknown where the stiffness is a bare alpha.
TEST( CrackSpeed, IsUnknownForRawAlpha )
{
	std::unique_ptr<Body> body = cracked( pulledSlab( Stiffness::RawAlpha ) );
	EXPECT_EQ( untilLook( *body ), 1 );
}

} // namespace
} // namespace pliant
