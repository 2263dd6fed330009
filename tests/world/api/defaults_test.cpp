// A game that sets nothing but a mesh: cubes of very different sizes stand, carry loads, are thrown, and sleep, like rubber.

#include "test_meshes.h"

#include "support/test_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <utility>

namespace pliant {
namespace {

using test::SoftWorld;

constexpr int kCells = 6; // along an edge

class Defaults : public testing::TestWithParam<float>
{
protected:
	float edge() const { return GetParam(); }
	SoftBody* addCube( SoftWorld& t, float height ) const
	{
		return t.add( test::cubeTemplate( edge(), kCells ), btVector3( 0, btScalar( height * edge() ), 0 ) );
	}
	/// Longer for large bodies, whose vibrations last longer in proportion to the root of their size.
	int mostFrames( float seconds = 15.0f ) const { return int( 60.0f * seconds * std::max( 1.0f, std::sqrt( edge() ) ) ); }
	/// Steps until all bodies sleep. Returns the number of frames.
	int frames( SoftWorld& t, float seconds = 15.0f ) const
	{
		int frame = 0;
		const auto isActive = []( const auto& body ) { return body->isActive(); };
		while ( frame < mostFrames( seconds ) && std::any_of( t.soft.begin(), t.soft.end(), isActive ) )
		{
			t.step( 1 );
			++frame;
		}
		return frame;
	}
};

TEST_P( Defaults, AreThoseOfTheBodysSize )
{
	SoftWorld t;
	SoftBody* const cube = addCube( t, 1.0f );
	const float modulus = defaultYoungsModulus( 1000.0f, edge() );
	EXPECT_NEAR( modulus, 9.80665e5f * edge(), 1e-3f * modulus );
	EXPECT_FLOAT_EQ( cube->material().youngsModulus, modulus );
	Material material;
	material.density = 500.0f;
	ASSERT_TRUE( cube->setMaterial( material ).ok() );
	EXPECT_FLOAT_EQ( cube->material().youngsModulus, 0.5f * modulus );
}

TEST_P( Defaults, ADroppedCubeRests )
{
	SoftWorld t;
	t.addFloor();
	SoftBody* const cube = addCube( t, 1.5f );
	const int slept = frames( t );
	std::printf( "edge %.2f m: asleep after %d frames at %.3f of the edge\n", double( edge() ), slept,
		double( cube->massCentre().y() ) / double( edge() ) );
	EXPECT_LT( slept, mostFrames() );
	EXPECT_NEAR( double( cube->massCentre().y() ), 0.5 * double( edge() ), 0.01 * double( edge() ) );
}

TEST_P( Defaults, AStackOfFourStands )
{
	SoftWorld t;
	t.addFloor();
	for ( int k = 0; k < 4; ++k )
	{
		addCube( t, 0.5f + 1.05f * float( k ) );
	}
	const int slept = frames( t );
	const btVector3 top = t.soft.back()->massCentre() / edge();
	std::printf( "edge %.2f m: asleep after %d frames, the highest at %.3f\n", double( edge() ), slept, double( top.y() ) );
	EXPECT_LT( slept, mostFrames() );
	EXPECT_GT( top.y(), btScalar( 3.4 ) );
	EXPECT_LT( std::hypot( top.x(), top.z() ), btScalar( 0.1 ) );
}

// sigma / E = 10 m g / ( L^2 E ) is a tenth; the cube's own weight adds half a per cent.
TEST_P( Defaults, ACubeCarriesTenTimesItsMass )
{
	SoftWorld t;
	t.addFloor();
	SoftBody* const cube = addCube( t, 0.5f );
	const btScalar half = btScalar( 0.5 * edge() );
	auto* const shape = new btBoxShape( btVector3( half, half / 2, half ) );
	shape->setMargin( btScalar( 0.01 ) * half );
	btRigidBody* const box = t.add( 10 * cube->mass(), shape, btVector3( 0, btScalar( 1.26 * edge() ), 0 ) );
	const int slept = frames( t );
	const btScalar height = ( box->getWorldTransform().getOrigin().y() - half / 2 ) / edge();
	std::printf( "edge %.2f m: asleep after %d frames, compressed to %.3f\n", double( edge() ), slept, double( height ) );
	EXPECT_LT( slept, mostFrames() );
	EXPECT_NEAR( height, btScalar( 0.905 ), btScalar( 0.025 ) );
	EXPECT_GT( box->getWorldTransform().getBasis()[1][1], btScalar( 0.999 ) );
}

TEST_P( Defaults, AThrownCubeComesToRest )
{
	SoftWorld t;
	t.addFloor();
	SoftBody* const cube = addCube( t, 1.0f );
	const btScalar speed = btScalar( 3.0 * std::sqrt( 9.81 * double( edge() ) ) ); // m/s
	ASSERT_TRUE( cube->setVelocities( btVector3( speed, speed / 3, 0 ), btVector3( 0, 0, -2 * speed / edge() ) ).ok() );
	const int slept = frames( t, 30.0f ); // it keeps bouncing, like rubber
	std::printf(
		"edge %.2f m: asleep after %d frames, %.1f edges away\n", double( edge() ), slept, double( cube->massCentre().x() / edge() ) );
	EXPECT_LT( slept, mostFrames( 30.0f ) );
	EXPECT_NEAR( double( cube->massCentre().y() ), 0.5 * double( edge() ), 0.02 * double( edge() ) );
}

/// A slab on the floor that balls of the given radius, m, roll along, from 1.5 radii to the right of its end. It has settled.
void addSlab( SoftWorld& t, float radius )
{
	LatticeSettings settings;
	settings.cellSize = 0.4f * radius;
	const double length = 16.0 * double( radius ), width = 2.4 * double( radius );
	SoftBody* const slab = t.add(
		BodyTemplate::build( test::makeBox( { 0, 0, 0 }, { length, 0.8 * double( radius ), width }, 8 ).view(), settings ).value,
		btVector3( btScalar( -1.5 ) * btScalar( radius ), 0, btScalar( -0.5 * width ) ) );
	slab->setFriction( btScalar( 0.8 ) );
	t.step( 60 );
}

/// Returns the velocity after four seconds of a ball of radius .4 m that starts sliding at 2 m/s, friction .8; of smaller balls that of the
/// same motion at the scale of their size, in units of its velocities. A rigid one keeps 10 / 7. The slab is of the default material too.
double rolled( float radius, bool isOnSlab )
{
	SoftWorld t;
	t.addFloor()->setFriction( btScalar( 0.8 ) );
	const double thickness = isOnSlab ? 0.8 * double( radius ) : 0.0;
	if ( isOnSlab )
	{
		addSlab( t, radius );
	}
	LatticeSettings settings;
	settings.cellSize = 0.16f * radius;
	SoftBody* const ball = t.add( BodyTemplate::build( test::makeSphere( double( radius ), 40, 80 ).view(), settings ).value,
		btVector3( 0, btScalar( double( radius ) + thickness ), 0 ) );
	ball->setFriction( btScalar( 0.8 ) );
	ball->setActivationState( DISABLE_DEACTIVATION );
	const double scale = std::sqrt( double( radius ) / 0.4 );
	EXPECT_TRUE( ball->setVelocities( btVector3( btScalar( 2.0 * scale ), 0, 0 ), btVector3( 0, 0, 0 ) ).ok() );
	t.step( int( 240.0 * scale ) );
	return double( ball->linearVelocity().x() ) / scale;
}

/// `least`: radii, m, and the fractions of a rigid ball's velocity that balls of these radii keep at least.
void expectRolling( bool isOnSlab, std::initializer_list<std::pair<float, double>> least )
{
	for ( const auto& [radius, fraction] : least )
	{
		const double speed = rolled( radius, isOnSlab );
		std::printf( "radius %.2f m: rolls on at %.3f of 1.43 m/s%s\n", double( radius ), speed, isOnSlab ? " on a slab" : "" );
		EXPECT_GT( speed, fraction * 10.0 / 7.0 );
		EXPECT_LT( speed, 10.0 / 7.0 );
	}
}

// They kept .39, .18 and 0: damping took the strain that turns with the ball for a vibration, and each landing node took the energy of its
// impact.
TEST( DefaultBall, RollsOn )
{
	expectRolling( false, { { 0.4f, 0.95 }, { 0.1f, 0.96 }, { 0.05f, 0.95 }, { 0.025f, 0.92 } } );
}

// It kept .97 of the 1.43 m/s: the slab's numerical damping took the strain that moves through it under the ball for a vibration.
TEST( DefaultBall, ARigidOneRollsOnSoftGround )
{
	constexpr float kRadius = 0.4f;
	SoftWorld t;
	t.addFloor()->setFriction( btScalar( 0.8 ) );
	addSlab( t, kRadius );
	btSphereShape shape( kRadius );
	const btScalar mass = btScalar( 1000 * 4.19 * 0.064 );
	btVector3 inertia;
	shape.calculateLocalInertia( mass, inertia );
	btRigidBody ball( mass, nullptr, &shape, inertia );
	ball.setWorldTransform( btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( 1.8 ) * kRadius, 0 ) ) );
	ball.setFriction( btScalar( 0.8 ) );
	ball.setActivationState( DISABLE_DEACTIVATION );
	t.world.addRigidBody( &ball );
	ball.setLinearVelocity( btVector3( 2, 0, 0 ) );
	t.step( 240 );
	std::printf( "rigid ball: rolls on at %.3f of 1.43 m/s on a slab\n", double( ball.getLinearVelocity().x() ) );
	EXPECT_GT( ball.getLinearVelocity().x(), 0.88 * 10.0 / 7.0 );
	t.world.removeRigidBody( &ball );
}

// Within half a second it stood. Nodes of the ball, which are smaller than those of the slab, touched it with all of the sphere that fits
// their surface, four cells aside of them, where the deformed sphere is in front of the surface or behind it. And the point of contact lay
// so far within the slab's larger node that its impulse could not be shared between the ball's nodes.
TEST( DefaultBall, RollsOnSoftGround )
{
	expectRolling( true, { { 0.4f, 0.85 }, { 0.1f, 0.87 }, { 0.05f, 0.75 } } );
}

INSTANTIATE_TEST_SUITE_P( Edges, Defaults, testing::Values( 0.05f, 0.1f, 0.5f, 1.0f, 10.0f ),
	[]( const testing::TestParamInfo<float>& edges ) { return "Edge" + std::to_string( int( 100.0f * edges.param + 0.5f ) ) + "cm"; } );

} // namespace
} // namespace pliant
