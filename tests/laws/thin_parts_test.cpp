// Parts one cell thick. Steinemann et al. 2008, section 8, and Rivers and James need regions with a volume; here a row and a layer of cells
// bend as a rod and a plate do, because at w = 1 the three cells of a row resist bending with m d^2 / 18, which is E I.

#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/explicit_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

constexpr double kRoot = 4.730040745; // cos( root ) cosh( root ) = 1: the free-free bending mode
constexpr int kLength = 24;           // cells

double height( double s )
{
	const double k = kRoot / kLength;
	return std::cos( k * s ) + std::cosh( k * s ) * std::cos( kRoot / 2 ) / std::cosh( kRoot / 2 );
}

/// Bending stiffness over theory's, from the period of the slowest bending.
double bendingStiffness( int width, const Adaptivity& adaptivity )
{
	Material material = test::explicitMaterial();
	material.density = 1.0f;
	material.stiffness = Stiffness::RawAlpha;
	material.damping = 0.0f;
	material.wobbleDamping = 0.0f;
	auto lattice = std::make_shared<Lattice>( makeBlockLattice( kLength, width, 1, 1.0f ) );
	const std::unique_ptr<Body> body = std::move( Body::create( std::move( lattice ), material, {}, nullptr, adaptivity ).value );
	NodeState& nodes = body->nodes();
	const double size = 0.02;
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, nodes.x.get( i ) + Vec3( 0.0f, 0.0f, float( size * height( double( nodes.x0.get( i ).x() ) ) ) ) );
	}
	const float h = 0.01f;
	std::vector<double> crossings;
	double before = 1.0;
	for ( int step = 1; step < 6000 && crossings.size() < 5; ++step )
	{
		test::substep( *body, h, 1.0f );
		double amplitude = 0.0;
		for ( int i = 0; i < nodes.count; ++i )
		{
			amplitude += height( double( nodes.x0.get( i ).x() ) ) * ( nodes.worldPosition( i ).z() - double( nodes.x0.get( i ).z() ) );
		}
		if ( before * amplitude < 0.0 )
		{
			crossings.push_back( step - amplitude / ( amplitude - before ) );
		}
		before = amplitude;
	}
	if ( crossings.size() < 2 )
	{
		return 0.0;
	}
	// f = root^2 / ( 2 pi L^2 ) sqrt( E I / m ), a cell's E = 2 / 3 and I = 1 / 12
	const double frequency = double( crossings.size() - 1 ) / ( 2.0 * ( crossings.back() - crossings.front() ) );
	const double theory = kRoot * kRoot / ( 2.0 * kPi * kLength * kLength ) * std::sqrt( 2.0 / 3.0 / 12.0 );
	return ( frequency / theory ) * ( frequency / theory );
}

TEST( ThinParts, ARodAndAPlateBendAsTheoryHasIt )
{
	Adaptivity levels;
	levels.coarseLevels = 2;
	const double rod = bendingStiffness( 1, {} ), plate = bendingStiffness( 8, {} ), rodWithLevels = bendingStiffness( 1, levels );
	std::printf( "bending stiffness over theory: rod %.3f, plate %.3f, rod of a body with levels %.3f\n", rod, plate, rodWithLevels );
	EXPECT_NEAR( rod, 1.0, 0.2 );
	EXPECT_NEAR( plate, 1.0, 0.2 );
	EXPECT_NEAR( rodWithLevels, 1.0, 0.2 );
}

TEST( ThinParts, ShakenBentAndTwistedTheyStayFiniteForAHundredThousandSteps )
{
	for ( const int width : { 1, 4 } )
	{
		Material material = test::explicitMaterial();
		material.damping = 1.0f;
		const std::unique_ptr<Body> body = test::makeBlock( 12, width, 1, 0.1f, material );
		NodeState& nodes = body->nodes();
		test::Seeded random( 9 );
		for ( int i = 0; i < nodes.count; ++i )
		{
			const float twist = 6.0f * nodes.x0.get( i ).x();
			nodes.x.set( i, Eigen::AngleAxisf( twist, Vec3::UnitX() ) * nodes.x.get( i ) + random.inBox( 0.03f ) );
			nodes.v.set( i, random.inBox( 3.0f ) );
		}
		for ( int step = 0; step < 100000; ++step )
		{
			ASSERT_EQ( test::substep( *body, 1.0f / 240.0f, 1.0f ), BodyHealth::Good ) << "step " << step;
		}
		EXPECT_LT( test::shapeError( *body ), 5e-3 ); // it still spins, which stretches it
	}
}

} // namespace
} // namespace pliant
