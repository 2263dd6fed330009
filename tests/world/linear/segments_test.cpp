// Large stiff bodies that bend took hundreds of products a step: what a product changes spreads by a region, and affine motions of
// the whole body know nothing of its bending.

#include "world/test_world.h"

#include <algorithm>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

struct Products
{
	double mean = 0.0; ///< a step
	int most = 0;
	btScalar height = 0; ///< of the body's centre at last, m
};

enum class Support
{
	Posts,
	PinsAtOneEnd
};

/// A body that is supported at its ends, or held at one of them, and on which a box of 100 kg falls.
Products loaded( int nx, int ny, int nz, float youngsModulus, Support support )
{
	constexpr int kFrames = 180;
	TestWorld test;
	test.addFloor();
	Material material = test::stiff( youngsModulus );
	material.elasticity = Elasticity::Implicit;
	material.density = 600.0f;
	SoftBody* const body = test.addSoft( block( nx, ny, nz, 0.05f ), at( 0, 0.8f, 0 ), material );
	for ( const btScalar x : { btScalar( -0.9 ), btScalar( 0.9 ) } )
	{
		support == Support::Posts ? void( test.addBox( 0, btVector3( 0.1f, 0.2f, 1.0f ), at( x, 0.2f, 0 ) ) ) : void();
	}
	if ( support == Support::PinsAtOneEnd )
	{
		const btScalar end = -0.025f * btScalar( nx );
		EXPECT_EQ( body->pinNodesInside( btVector3( end, 0, -2 ), btVector3( end + 0.05f, 2, 2 ) ), ny * nz );
	}
	test.addBox( 100, btVector3( 0.15f, 0.15f, 0.15f ), at( 0.1f, 2, 0 ) );
	Products found;
	for ( int frame = 0; frame < kFrames; ++frame )
	{
		test.run( 1 );
		const int products = test.world.stepReport().implicitProducts;
		found.mean += double( products ) / kFrames;
		found.most = std::max( found.most, products );
	}
	found.height = body->massCentre().y();
	std::printf( "%d x %d x %d cells, %.0e Pa: %.1f products in the mean, at most %d, centre at %.4f m\n", nx, ny, nz,
		double( youngsModulus ), found.mean, found.most, double( found.height ) );
	return found;
}

TEST( Segments, StiffPlatesAndBeamsTakeFewProducts )
{
	for ( const float youngsModulus : { 1e7f, 1e8f } )
	{
		const Products plate = loaded( 40, 2, 40, youngsModulus, Support::Posts );
		EXPECT_LT( plate.mean, 10.0 ) << "29.8 and 73.8 before";
		EXPECT_LT( plate.most, 90 ) << "353 and 788 before";
		const Products beam = loaded( 60, 6, 6, youngsModulus, Support::Posts );
		EXPECT_LT( beam.mean, 8.0 ) << "25.8 and 31.1 before";
		EXPECT_LT( beam.most, 80 ) << "276 and 435 before";
	}
}

TEST( Segments, PinnedPlatesAndBeamsTakeFewProducts )
{
	for ( const float youngsModulus : { 1e7f, 1e8f } )
	{
		EXPECT_LT( loaded( 40, 2, 40, youngsModulus, Support::PinsAtOneEnd ).mean, 20.0 );
		EXPECT_LT( loaded( 60, 6, 6, youngsModulus, Support::PinsAtOneEnd ).mean, 24.0 );
	}
}

} // namespace
} // namespace pliant
