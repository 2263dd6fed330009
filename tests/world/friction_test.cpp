// Friction on a slope at the game's own step, as a rigid box has it, whatever the body's stiffness; and without chatter.

#include "test_world.h"

#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

constexpr double kSlope = 20.0 / 180.0 * SIMD_PI;

struct Slide
{
	double acceleration = 0.0; ///< down the slope, m/s^2
	double chatter = 0.0;      ///< how much the speeds of the nodes that touch differ from the body's, root mean square, m/s
};

/// Over the third and fourth second. Down is x.
Slide slide( double friction, float youngsModulus, Elasticity elasticity )
{
	TestWorld t;
	t.world.setGravity( btVector3( btScalar( 9.81 * std::sin( kSlope ) ), btScalar( -9.81 * std::cos( kSlope ) ), 0 ) );
	t.addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) )->setFriction( 1 );
	Material material = test::stiff( youngsModulus );
	material.elasticity = elasticity;
	material.density = 1000.0f / 216.0f; // 1 kg
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), material );
	cube->setFriction( btScalar( friction ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	t.run( 120 );
	const btVector3 before = cube->linearVelocity();
	Slide slide;
	int count = 0;
	for ( int frame = 0; frame < 120; ++frame )
	{
		t.run( 1 );
		const btVector3 mean = cube->linearVelocity();
		for ( int i = 0; i < cube->nodeCount(); ++i )
		{
			if ( cube->nodePosition( i ).y() < btScalar( 1.4 ) * cube->nodeRadius( i ) )
			{
				slide.chatter += double( ( cube->nodeVelocity( i ) - mean ).length2() );
				++count;
			}
		}
	}
	slide.acceleration = double( cube->linearVelocity().x() - before.x() ) / 2.0;
	slide.chatter = std::sqrt( slide.chatter / std::max( count, 1 ) );
	EXPECT_GT( count, 0 );
	return slide;
}

TEST( Friction, OnASlopeIsThatOfARigidBoxAndDoesNotChatter )
{
	const double wanted = 9.81 * ( std::sin( kSlope ) - 0.25 * std::cos( kSlope ) );
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const float youngsModulus : { 3e2f, 3e3f, 1e6f } )
		{
			const Slide got = slide( 0.25, youngsModulus, elasticity );
			std::printf( "%s, E %.0e: %+.2f %%, chatter %.1e m/s\n", elasticity == Elasticity::Explicit ? "explicit" : "implicit", double( youngsModulus ),
				100.0 * ( got.acceleration / wanted - 1.0 ), got.chatter );
			EXPECT_NEAR( got.acceleration / wanted, 1.0, 0.03 );
			EXPECT_LT( got.chatter, 0.01 ); // of three metres a second
		}
	}
}

TEST( Friction, HoldsBelowTheSetAngleAndSlidesAboveIt )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		EXPECT_NEAR( slide( std::tan( 20.5 / 180.0 * SIMD_PI ), 1e4f, elasticity ).acceleration, 0.0, 0.002 );
		EXPECT_GT( slide( std::tan( 19.5 / 180.0 * SIMD_PI ), 1e4f, elasticity ).acceleration, 0.05 );
	}
}

} // namespace
} // namespace pliant
