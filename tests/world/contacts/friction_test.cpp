// Friction on a slope at the game's own step: the same as for a rigid box, whatever the body's stiffness, and without chatter.

#include "world/test_world.h"

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
	double chatter = 0.0;      ///< root mean square deviation of the touching nodes' velocities from the body's, m/s
};

/// Measures over the third and fourth second. Down is x.
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
			std::printf( "%s, E %.0e: %+.2f %%, chatter %.1e m/s\n", elasticity == Elasticity::Explicit ? "explicit" : "implicit",
				double( youngsModulus ), 100.0 * ( got.acceleration / wanted - 1.0 ), got.chatter );
			EXPECT_NEAR( got.acceleration / wanted, 1.0, 0.03 );
			EXPECT_LT( got.chatter, 0.01 ); // at three metres per second
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

/// Moment of inertia of a soft body about the vertical through its centre of mass, kg m^2.
double inertiaOf( const SoftBody& body )
{
	double sum = 0.0;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const btVector3 p = body.nodePosition( i ) - body.massCentre();
		sum += double( body.nodeMass( i ) * ( p.x() * p.x() + p.z() * p.z() ) );
	}
	return sum;
}

Material implicitOr( Elasticity elasticity )
{
	Material material = test::stiff( 1e5f );
	material.elasticity = elasticity;
	material.density = 100.0f;
	return material;
}

// There is no sliding friction (the product is 0), but spinning friction acts: s f0 = 0.04 * 0.5.
TEST( Friction, SpinningFrictionBrakesASoftBodyByItsLaw )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, btScalar( -9.81 ), 0 ) );
		t.addFloor()->setFriction( btScalar( 0.5 ) );
		SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), at( 0, btScalar( 0.25 ), 0 ), implicitOr( elasticity ) );
		cube->setFriction( 0 );
		cube->setSpinningFriction( btScalar( 0.04 ) );
		cube->setActivationState( DISABLE_DEACTIVATION );
		t.run( 60 );
		EXPECT_TRUE( cube->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, 3, 0 ) ).ok() );
		const double inertia = inertiaOf( *cube );
		double before = 0.0;
		for ( int frame = 0; frame < 25; ++frame )
		{
			t.run( 1 );
			before = frame == 9 ? double( cube->angularMomentum().y() ) / inertia : before;
		}
		const double got = ( before - double( cube->angularMomentum().y() ) / inertia ) / 0.25; // frames 10 to 24
		const double wanted = 0.04 * 0.5 * double( cube->mass() ) * 9.81 / inertia;
		std::printf( "spin lost: %.4f of %.4f rad/s^2\n", got, wanted );
		EXPECT_NEAR( got / wanted, 1.0, 0.03 );
		t.run( 240 );
		EXPECT_NEAR( cube->angularMomentum().y(), 0, 1e-4 * inertia ); // stopped, and not reversed
	}
}

// A ball spins in place on a soft block: both axes follow their law, and the block receives the angular momentum that the ball loses.
TEST( Friction, RollingAndSpinningFrictionTurnBothBodies )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, btScalar( -9.81 ), 0 ) );
		t.addFloor()->setFriction( 0 );
		SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), at( 0, btScalar( 0.25 ), 0 ), implicitOr( elasticity ) );
		cube->setFriction( btScalar( 0.5 ) );
		cube->setActivationState( DISABLE_DEACTIVATION );
		btRigidBody* ball = t.add( 1, new btSphereShape( btScalar( 0.2 ) ), at( 0, btScalar( 0.705 ), 0 ) );
		ball->setFriction( 0 );
		ball->setRollingFriction( btScalar( 0.02 ) );
		ball->setSpinningFriction( btScalar( 0.01 ) );
		ball->setActivationState( DISABLE_DEACTIVATION );
		t.run( 120 );
		ball->setAngularVelocity( btVector3( 4, 8, 0 ) );
		t.run( 10 );
		const double inertia = 0.4 * 0.2 * 0.2;
		const auto spin = [&] { return double( cube->angularMomentum().y() + ball->getAngularVelocity().y() * btScalar( inertia ) ); };
		const btVector3 before = ball->getAngularVelocity();
		const double spinBefore = spin();
		t.run( 15 );
		const btVector3 lost = ( before - ball->getAngularVelocity() ) / btScalar( 0.25 );
		std::printf( "lost: rolling %.3f of %.3f, spinning %.3f of %.3f rad/s^2; of both bodies' spin %.1e\n", double( lost.x() ),
			0.02 * 0.5 * 9.81 / inertia, double( lost.y() ), 0.01 * 0.5 * 9.81 / inertia, std::abs( spin() / spinBefore - 1.0 ) );
		EXPECT_NEAR( double( lost.x() ) / ( 0.02 * 0.5 * 9.81 / inertia ), 1.0, 0.05 );
		EXPECT_NEAR( double( lost.y() ) / ( 0.01 * 0.5 * 9.81 / inertia ), 1.0, 0.05 );
		EXPECT_NEAR( spin() / spinBefore, 1.0, 1e-4 );
	}
}

/// A cube rotated about the vertical, whose friction along its own x is a fifth of that along its own z, on a slope down the world's x.
/// Returns its velocity after a while, m/s.
btVector3 slideDirected( Elasticity elasticity, double turn, double slope, const btVector3& scales, bool isOfFloor = false )
{
	TestWorld t;
	t.world.setGravity( btVector3( btScalar( 9.81 * std::sin( slope ) ), btScalar( -9.81 * std::cos( slope ) ), 0 ) );
	btRigidBody* floor = t.addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) );
	floor->setFriction( 1 );
	const btTransform turned( btQuaternion( btVector3( 0, 1, 0 ), btScalar( turn ) ), btVector3( 0, btScalar( 0.25 ), 0 ) );
	Material material = implicitOr( elasticity );
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), turned, material );
	cube->setFriction( btScalar( 0.5 ) );
	isOfFloor ? floor->setAnisotropicFriction( scales ) : cube->setAnisotropicFriction( scales );
	cube->setActivationState( DISABLE_DEACTIVATION );
	t.run( 60 );
	const btVector3 before = cube->linearVelocity();
	t.run( 30 );
	return ( cube->linearVelocity() - before ) / btScalar( 0.5 );
}

TEST( Friction, ByDirectionUsesTheBodysOwnAxes )
{
	const btVector3 scales( btScalar( 0.2 ), 1, 1 );
	const double down = 9.81 * std::sin( kSlope ), press = 9.81 * std::cos( kSlope );
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		// mu 0.5: it sticks across its slippery axis, and along it has a fifth of the friction.
		const double along = double( slideDirected( elasticity, 0.0, kSlope, scales ).x() ), wanted = down - 0.5 * 0.2 * press;
		const double across = double( slideDirected( elasticity, SIMD_HALF_PI, kSlope, scales ).x() );
		std::printf( "%s: along %.3f of %.3f m/s^2, across %.4f\n", elasticity == Elasticity::Explicit ? "explicit" : "implicit", along,
			wanted, across );
		EXPECT_NEAR( along / wanted, 1.0, 0.03 );
		EXPECT_NEAR( across, 0.0, 0.01 );
		// In oblique orientation it drifts along its slippery axis: both steps agree, and the drift is towards its own x, which is ( cos
		// 45, 0, - sin 45 ) in the world.
		const btVector3 oblique = slideDirected( elasticity, 0.25 * SIMD_PI, kSlope, scales );
		std::printf( "oblique %.3f %.3f m/s^2\n", double( oblique.x() ), double( oblique.z() ) );
		EXPECT_LT( oblique.z(), btScalar( -0.3 ) );
		EXPECT_GT( oblique.x(), btScalar( 0.3 ) );
		// Anisotropic friction of the floor acts in the floor's axes, however the cube is rotated.
		EXPECT_NEAR( double( slideDirected( elasticity, 0.5, kSlope, scales, true ).x() ) / wanted, 1.0, 0.03 );
	}
	const btVector3 explicitOne = slideDirected( Elasticity::Explicit, 0.25 * SIMD_PI, kSlope, scales );
	const btVector3 implicitOne = slideDirected( Elasticity::Implicit, 0.25 * SIMD_PI, kSlope, scales );
	EXPECT_LT( ( explicitOne - implicitOne ).length(), btScalar( 0.05 ) * explicitOne.length() );
}

/// The number of added or refreshed points, and the largest distance between a point's local position, transformed by either body, and its
/// world position, m.
struct LocalPoints
{
	int count = 0, turned = 0;
	btScalar worst = 0;

	void look( const btManifoldPoint& point, const btCollisionObject& body0, const btCollisionObject& body1 )
	{
		++count;
		turned += body0.getWorldTransform().getRotation().getAngle() > btScalar( 0.5 ) ||
				body1.getWorldTransform().getRotation().getAngle() > btScalar( 0.5 )
			? 1
			: 0;
		worst = btMax( worst, ( body0.getWorldTransform() * point.m_localPointA - point.m_positionWorldOnA ).length() );
		worst = btMax( worst, ( body1.getWorldTransform() * point.m_localPointB - point.m_positionWorldOnB ).length() );
	}
};
LocalPoints* localPoints = nullptr; // Bullet's callback is a function without a context

// A contact proxy has the material's axes with anisotropic friction, and the world's otherwise; local positions of points are in those
// axes.
TEST( Friction, ByDirectionRotatesTheLocalPositionsOfContacts )
{
	for ( const bool isDirected : { false, true } )
	{
		TestWorld t;
		t.addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) );
		const btTransform turned( btQuaternion( btVector3( 0, 0, 1 ), SIMD_HALF_PI ),
			btVector3( 0, btScalar( 0.25 ), 0 ) ); // gravity is not vertical in the body's own axes
		SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.1f ), turned, implicitOr( Elasticity::Explicit ) );
		cube->setAnisotropicFriction( isDirected ? btVector3( btScalar( 0.2 ), 1, 1 ) : btVector3( 1, 1, 1 ) );
		LocalPoints points;
		localPoints = &points;
		gContactProcessedCallback = []( btManifoldPoint& point, void* body0, void* body1 ) {
			localPoints->look( point, *static_cast<btCollisionObject*>( body0 ), *static_cast<btCollisionObject*>( body1 ) );
			return true;
		};
		t.run( 20 );
		gContactProcessedCallback = nullptr;
		EXPECT_GT( points.count, 100 );
		EXPECT_EQ( points.turned, isDirected ? points.count : 0 );
		EXPECT_LT( points.worst, btScalar( 1e-5 ) );
	}
}

// Contact proxies copy a body's surface parameters when they change, and only then.
TEST( Friction, SetDuringAContactActsAtOnce )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( btScalar( 9.81 * std::sin( kSlope ) ), btScalar( -9.81 * std::cos( kSlope ) ), 0 ) );
		t.addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) )->setFriction( 1 );
		Material material = test::stiff( 1e5f );
		material.elasticity = elasticity;
		SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.2 ), 0 ), material );
		cube->setActivationState( DISABLE_DEACTIVATION );
		const auto gainsIn = [&]( btScalar friction ) {
			cube->setFriction( friction );
			cube->setUserIndex( int( 100 * friction ) );
			const btScalar before = cube->linearVelocity().x();
			t.run( 30 );
			int touching = 0;
			for ( int m = 0; m < t.parts.dispatcher.getNumManifolds(); ++m )
			{
				const btPersistentManifold& manifold = *t.parts.dispatcher.getManifoldByIndexInternal( m );
				for ( const btCollisionObject* const object : { manifold.getBody0(), manifold.getBody1() } )
				{
					const bool isContactProxy = SoftBody::upcast( object ) && object != cube;
					touching += isContactProxy ? 1 : 0;
					EXPECT_TRUE(
						!isContactProxy || ( object->getFriction() == friction && object->getUserIndex() == cube->getUserIndex() ) );
				}
			}
			EXPECT_GT( touching, 4 );
			return double( cube->linearVelocity().x() - before ) / 0.5;
		};
		t.run( 60 );
		const btScalar half = btScalar( 0.5 );
		EXPECT_NEAR( gainsIn( half ), 0.0, 0.01 );
		EXPECT_NEAR( gainsIn( btScalar( 0 ) ), 9.81 * std::sin( kSlope ), 0.1 );
		EXPECT_NEAR( gainsIn( half ), 9.81 * ( std::sin( kSlope ) - 0.5 * std::cos( kSlope ) ), 0.1 ); // friction brakes it
	}
}

// Contact proxies are reused by other bodies, and must not keep the first body's anisotropic friction.
TEST( Friction, ByDirectionIsNotHandedOnToOtherBodies )
{
	for ( const bool hadDirections : { false, true } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( btScalar( 9.81 * std::sin( kSlope ) ), btScalar( -9.81 * std::cos( kSlope ) ), 0 ) );
		t.addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) )->setFriction( 1 );
		SoftBody* first = t.addSoft( block( 5, 5, 5, 0.1f ), at( 0, btScalar( 0.25 ), 0 ), implicitOr( Elasticity::Explicit ) );
		first->setAnisotropicFriction( hadDirections ? btVector3( 0, 1, 0 ) : btVector3( 1, 1, 1 ) );
		t.run( 10 );
		t.world.removeSoftBody( first );
		SoftBody* second = t.addSoft( block( 5, 5, 5, 0.1f ), at( 3, btScalar( 0.25 ), 0 ), implicitOr( Elasticity::Explicit ) );
		t.run( 60 );
		EXPECT_NEAR( second->linearVelocity().x(), 0, 0.02 ) << hadDirections;
	}
}

} // namespace
} // namespace pliant
