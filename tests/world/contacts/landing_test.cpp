// Landings of implicit bodies (world/step/landings.cpp): they rebound by their elasticity whatever the game step, on every kind of ground,
// and a body that does not land takes no substeps.

#include "test_meshes.h"
#include "world/test_world.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

constexpr btScalar kEdge = btScalar( 0.4 );

SoftBody* addCube( TestWorld& t, btScalar height, float youngsModulus = 0.0f )
{
	Material material; // the default
	material.youngsModulus = youngsModulus > 0.0f ? youngsModulus : material.youngsModulus;
	SoftBody* const cube = t.addSoft( block( 6, 6, 6, float( kEdge ) / 6 ), at( 0, height, 0 ), material );
	cube->setActivationState( DISABLE_DEACTIVATION );
	return cube;
}

/// Returns how high an object rises after a fall, m above `rest`. `position` and `velocity`: of its centre of mass, vertical.
template <class Position, class Velocity>
double rebound( TestWorld& t, double rate, double rest, const Position& position, const Velocity& velocity )
{
	double highest = -1.0;
	bool rises = false;
	for ( int step = 0; step < int( 1.5 * rate ); ++step )
	{
		t.world.stepSimulation( btScalar( 1.0 / rate ), 0 );
		rises = rises || velocity() > 0;
		highest = rises ? std::max( highest, double( position() ) - rest ) : highest;
	}
	return highest;
}

double reboundOf( TestWorld& t, SoftBody& cube, double rate )
{
	return rebound(
		t, rate, double( kEdge ) / 2, [&] { return cube.massCentre().y(); }, [&] { return cube.linearVelocity().y(); } );
}

// It rebounded to .00 m at 1/60 s and to .39 at 1/120. Bullet's own box with a restitution of .6 reaches .30 to .59. While gravity acted
// for one step where the length of steps changed, it lost v h / 2 when it landed and again when it took off: .30 at 1/30 s. At 1/7 s 16
// substeps did not resolve the impact: .20.
TEST( Landings, ACubeReboundsAlikeAtAnyStep )
{
	for ( const float youngsModulus : { 0.0f, 2e5f, 5e4f } )
	{
		double finest = 0.0;
		for ( const double rate : { 1000.0, 240.0, 120.0, 60.0, 30.0, 15.0, 7.0 } )
		{
			TestWorld t;
			t.addFloor();
			SoftBody* const cube = addCube( t, btScalar( 1.2 ), youngsModulus );
			const double height = reboundOf( t, *cube, rate );
			finest = rate == 1000.0 ? height : finest;

			TestWorld twin;
			twin.addFloor()->setRestitution( 1 );
			btRigidBody* const box = twin.addBox( 64, btVector3( kEdge, kEdge, kEdge ) / 2, at( 0, btScalar( 1.2 ), 0 ) );
			box->setRestitution( btScalar( 0.6 ) );
			const double rigid = rebound(
				twin, rate, double( kEdge ) / 2, [&] { return box->getCenterOfMassPosition().y(); },
				[&] { return box->getLinearVelocity().y(); } );
			std::printf( "%.0e Pa, 1/%.0f s: %.3f m, %.2f of that at 1/1000 s; rigid box %.3f m\n",
				double( cube->material().youngsModulus ), rate, height, height / finest, rigid );
			EXPECT_NEAR( height / finest, 1.0, 0.15 );
		}
	}
}

// x = ( v + g h / 2 ) t + g t^2 / 2, h the first step, whatever the steps that follow. With v' = v + h g the body was 9 mm off.
TEST( Landings, AFlightInUnequalStepsIsOneParabola )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		TestWorld t;
		Material material;
		material.elasticity = elasticity;
		material.youngsModulus = 1e4f; // within the reach of one explicit step
		material.rigidStrain = 0.0f;   // Bullet's own integration moves a body in its rigid state
		SoftBody* const cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 10, 0 ), material );
		cube->setActivationState( DISABLE_DEACTIVATION );
		t.world.setSoftSubsteps( 1 ); // one for each sixtieth of a step
		const btScalar first = btScalar( 1.0 / 60 ), g = btScalar( -10 );
		btScalar time = 0;
		for ( int step = 0; step < 40; ++step )
		{
			const btScalar length = step % 3 == 0 ? first : first / btScalar( 1 + step % 3 );
			t.world.stepSimulation( length, 0 );
			ASSERT_EQ( t.world.stepReport().substeps, 1 );
			time += length;
			EXPECT_NEAR( cube->massCentre().y(), 10 + g * first / 2 * time + g * time * time / 2, 1e-4 ) << step;
		}
	}
}

/// A grid of 12 x 12 quads of half a metre at height 0.
struct GridGround
{
	GridGround()
	{
		constexpr int n = 13;
		for ( int k = 0; k < n * n; ++k )
		{
			vertices.emplace_back( btScalar( 0.5 ) * btScalar( k % n - 6 ), btScalar( 0 ), btScalar( 0.5 ) * btScalar( k / n - 6 ) );
		}
		for ( int k = 0; k < n * ( n - 1 ); ++k )
		{
			if ( k % n < n - 1 )
			{
				for ( const int corner : { k, k + n, k + 1, k + 1, k + n, k + n + 1 } )
				{
					indices.push_back( corner );
				}
			}
		}
		mesh = std::make_unique<btTriangleIndexVertexArray>( int( indices.size() ) / 3, indices.data(), int( 3 * sizeof( int ) ),
			int( vertices.size() ), &vertices[0][0], int( sizeof( btVector3 ) ) );
		heights.assign( n * n, 0.0f );
	}
	std::vector<btVector3> vertices;
	std::vector<int> indices;
	std::vector<float> heights;
	std::unique_ptr<btTriangleIndexVertexArray> mesh;
};

TEST( Landings, AreFoundOnEveryKindOfGround )
{
	GridGround ground;
	const btVector3 half( 3, btScalar( 0.5 ), 3 );
	for ( int kind = 0; kind < 6; ++kind )
	{
		TestWorld t;
		SoftBody* trampoline = nullptr;
		switch ( kind )
		{
			case 0: t.addPlane(); break;
			case 1: t.addFloor(); break;
			case 2: {
				auto* const shape = new btCompoundShape;
				t.shapes.emplace_back( new btBoxShape( half ) );
				shape->addChildShape( at( 0, btScalar( -0.5 ), 0 ), t.shapes.back().get() );
				t.add( 0, shape, btTransform::getIdentity() );
				break;
			}
			case 3: t.add( 0, new btBvhTriangleMeshShape( ground.mesh.get(), true ), btTransform::getIdentity() ); break;
			case 4:
				t.add( 0, new btHeightfieldTerrainShape( 13, 13, ground.heights.data(), 1, -1, 1, 1, PHY_FLOAT, false ),
					btTransform::getIdentity() );
				break;
			default:
				trampoline = t.addSoft( block( 16, 2, 16, 0.1f ), at( 0, btScalar( -0.1 ), 0 ), test::implicit( 1e7f ) );
				for ( int i = 0; i < trampoline->nodeCount(); ++i )
				{
					ASSERT_TRUE( trampoline->pinNode( i ).ok() );
				}
		}
		SoftBody* const cube = addCube( t, btScalar( 1.2 ) );
		const double height = reboundOf( t, *cube, 60.0 );
		std::printf( "ground %d: %.3f m\n", kind, height );
		EXPECT_NEAR( height, 0.32, 0.05 ) << "ground " << kind;
	}
}

// A body at rest that is hit: the ball rose to .01 m.
TEST( Landings, ARigidBallReboundsFromASoftCube )
{
	double heights[2];
	for ( const bool isFine : { false, true } )
	{
		TestWorld t;
		t.addFloor();
		SoftBody* const cube = addCube( t, kEdge / 2 );
		btRigidBody* const ball = t.add( cube->mass() / 4, new btSphereShape( btScalar( 0.1 ) ), at( 0, btScalar( 1.5 ), 0 ) );
		heights[isFine] = rebound(
			t, isFine ? 1000.0 : 60.0, 0.5, [&] { return ball->getCenterOfMassPosition().y(); },
			[&] { return ball->getLinearVelocity().y(); } );
		std::printf( "ball, 1/%d s: %.3f m\n", isFine ? 1000 : 60, heights[isFine] );
	}
	EXPECT_NEAR( heights[0] / heights[1], 1.0, 0.25 );
}

// What sleeps is woken before it is hit: it would take the first step of the impact whole.
TEST( Landings, ARigidBallReboundsFromASleepingCube )
{
	TestWorld t;
	t.addFloor();
	SoftBody* const cube = addCube( t, kEdge / 2 );
	cube->forceActivationState( ACTIVE_TAG );
	t.run( 300 );
	ASSERT_FALSE( cube->isActive() );
	btRigidBody* const ball = t.add( cube->mass() / 4, new btSphereShape( btScalar( 0.1 ) ), at( 0, btScalar( 1.5 ), 0 ) );
	const double height = rebound(
		t, 60.0, 0.5, [&] { return ball->getCenterOfMassPosition().y(); }, [&] { return ball->getLinearVelocity().y(); } );
	std::printf( "ball, sleeping cube: %.3f m\n", height );
	EXPECT_NEAR( height, 0.21, 0.05 );
}

// Velocities that a game had set were unknown until the step after.
TEST( Landings, AThrowInTheStepOfItsImpactIsFound )
{
	TestWorld t;
	t.addPlane();
	SoftBody* const cube = addCube( t, btScalar( 0.25 ) );
	ASSERT_TRUE( cube->setVelocities( btVector3( 0, -5, 0 ), btVector3( 0, 0, 0 ) ).ok() );
	t.run( 1 );
	EXPECT_GT( t.world.stepReport().substeps, 1 );
}

TEST( Landings, BodiesThatRestSlideOrFlyTakeNoSubsteps )
{
	const btVector3 velocities[] = { btVector3( 0, 0, 0 ), btVector3( 3, 0, 0 ), btVector3( 5, 0, 0 ) };
	for ( const btVector3& velocity : velocities )
	{
		const bool flies = velocity.x() > 4;
		TestWorld t;
		t.addFloor();
		t.world.setGravity( flies ? btVector3( 0, 0, 0 ) : t.world.getGravity() );
		SoftBody* const cube = addCube( t, flies ? btScalar( 0.3 ) : kEdge / 2 );
		t.run( 20 );
		ASSERT_TRUE( cube->setVelocities( velocity, btVector3( 0, 0, 0 ) ).ok() );
		for ( int frame = 0; frame < 40; ++frame )
		{
			t.run( 1 );
			EXPECT_EQ( t.world.stepReport().implicitBodies, 1 );
			EXPECT_EQ( t.world.stepReport().substeps, 1 ) << velocity.x() << " m/s, frame " << frame;
		}
	}
}

std::shared_ptr<const BodyTemplate> ball()
{
	LatticeSettings settings;
	settings.cellSize = 0.064f;
	return BodyTemplate::build( test::makeSphere( 0.4, 40, 80 ).view(), settings ).value;
}

// In whole steps numerical damping brakes it (DefaultBall.RollsOn). A third deformable body in its island would have to take the substeps
// too.
TEST( Rolling, TakesSubstepsInSmallIslands )
{
	for ( const bool isLoaded : { false, true } )
	{
		TestWorld t;
		t.addFloor();
		SoftBody* const slab = t.addSoft( block( 40, 2, 10, 0.1f ), at( 0, btScalar( 0.1 ), 0 ), test::implicit( 1e6f ) );
		for ( int i = 0; i < slab->nodeCount(); ++i )
		{
			ASSERT_TRUE( slab->pinNode( i ).ok() );
		}
		if ( isLoaded )
		{
			t.addSoft( block( 2, 2, 2, 0.1f ), at( btScalar( 1.8 ), btScalar( 0.3 ), 0 ), Material{} )
				->setActivationState( DISABLE_DEACTIVATION );
		}
		SoftBody* const rolling = t.addSoft( ball(), at( btScalar( -1.5 ), btScalar( 0.6 ), 0 ), Material{} );
		rolling->setActivationState( DISABLE_DEACTIVATION );
		t.run( 30 );
		EXPECT_EQ( t.world.stepReport().substeps, 1 );
		ASSERT_TRUE( rolling->setVelocities( btVector3( 2, 0, 0 ), btVector3( 0, 0, -5 ) ).ok() );
		t.run( 2 );
		int divided = 0;
		for ( int frame = 0; frame < 40; ++frame )
		{
			t.run( 1 );
			divided += t.world.stepReport().substeps > 1 ? 1 : 0;
		}
		EXPECT_TRUE( isLoaded ? divided == 0 : divided > 30 ) << divided;
	}
}

// What does not turn, and what flies, takes none.
TEST( Rolling, EndsInFlightAndAtRest )
{
	TestWorld t;
	t.addFloor();
	SoftBody* const rolling = t.addSoft( ball(), at( 0, btScalar( 0.4 ), 0 ), Material{} );
	rolling->setActivationState( DISABLE_DEACTIVATION );
	ASSERT_TRUE( rolling->setVelocities( btVector3( 2, 0, 0 ), btVector3( 0, 0, -5 ) ).ok() );
	t.run( 10 );
	EXPECT_GT( t.world.stepReport().substeps, 1 );
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	ASSERT_TRUE( rolling->teleport( at( 0, 5, 0 ) ).ok() );
	t.run( 10 );
	EXPECT_EQ( t.world.stepReport().substeps, 1 );
}

TEST( Landings, OnLargeIslandsAreNotResolved )
{
	for ( const int count : { 1, 2 } )
	{
		TestWorld t;
		t.addFloor();
		for ( int k = 0; k < count; ++k )
		{
			addCube( t, kEdge * ( btScalar( 0.5 ) + btScalar( k ) ) );
		}
		t.run( 60 );
		addCube( t, kEdge * btScalar( count + 3 ) );
		int divided = 0;
		for ( int frame = 0; frame < 60; ++frame )
		{
			t.run( 1 );
			divided += t.world.stepReport().substeps > 1 ? 1 : 0;
		}
		EXPECT_EQ( divided > 0, count == 1 ) << count;
	}
}

// The middle cube took the explicit one's substeps because of their distance, and its first contact with the third, which did not, acted on
// it alone.
TEST( Landings, BodiesWithAndWithoutSubstepsKeepMomentum )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	const auto cube = block( 4, 4, 4, 0.1f );
	SoftBody* const first = t.addSoft( cube, at( btScalar( -0.41 ), 0, 0 ), test::stiff( 1e5f ) );
	t.addSoft( cube, at( 0, 0, 0 ), test::implicit( 1e8f ) );
	SoftBody* const third = t.addSoft( cube, at( btScalar( 0.45 ), 0, 0 ), test::implicit( 1e8f ) );
	ASSERT_TRUE( third->setVelocities( btVector3( -6, 0, 0 ), btVector3( 0, 0, 0 ) ).ok() );
	ASSERT_TRUE( first->setVelocities( btVector3( btScalar( 0.1 ), 0, 0 ), btVector3( 0, 0, 0 ) ).ok() );
	const btScalar before = ( first->linearVelocity().x() + third->linearVelocity().x() ) * third->mass();
	for ( int frame = 0; frame < 10; ++frame )
	{
		t.run( 1 );
		btScalar now = 0;
		for ( const auto& body : t.soft )
		{
			now += body->linearVelocity().x() * body->mass();
		}
		EXPECT_NEAR( now / before, btScalar( 1 ), btScalar( 1e-5 ) ) << "frame " << frame;
	}
	EXPECT_LT( third->linearVelocity().x(), btScalar( -0.01 ) + 6 );
}

// Cantilevers that swing freely, and cubes whose vibrations no step resolves, without damping.
double energyOfSwing( Elasticity elasticity, float youngsModulus, bool isHeld )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	Material material;
	material.youngsModulus = youngsModulus;
	material.elasticity = elasticity;
	material.damping = material.wobbleDamping = material.numericalDamping = 0.0f;
	SoftBody* const body = t.addSoft( isHeld ? block( 20, 4, 4, 0.05f ) : block( 6, 6, 6, 0.05f ), at( 0, 0, 0 ), material );
	body->setActivationState( DISABLE_DEACTIVATION );
	const double sound = std::sqrt( double( youngsModulus ) / 1000.0 ), length = isHeld ? 1.0 : 0.3;
	// Angular frequencies: 3.516 c t / ( sqrt( 12 ) L^2 ) of the first bending mode, t the thickness, and pi c / L.
	const double omega = isHeld ? 3.516 * sound * 0.2 / std::sqrt( 12.0 ) : SIMD_PI * sound / length;
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		const double x = double( body->nodePosition( i ).x() ), s = x + 0.5;
		if ( isHeld && s < 0.06 )
		{
			EXPECT_TRUE( body->pinNode( i ).ok() );
			continue;
		}
		// Amplitudes of a tenth of the length at the tip, by the deflection of a uniform load, and of a strain of .05.
		const btVector3 velocity = isHeld ? btVector3( 0, btScalar( 0.1 * omega * s * s * ( 6.0 - 4.0 * s + s * s ) / 3.0 ), 0 )
										  : btVector3( btScalar( 0.05 * length * omega * std::sin( SIMD_PI * x / length ) ), 0, 0 );
		EXPECT_TRUE( body->applyImpulse( velocity * body->nodeMass( i ), i ).ok() );
	}
	const auto motion = [body] {
		double sum = 0.0;
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			sum += 0.5 * double( body->nodeMass( i ) * body->nodeVelocity( i ).length2() );
		}
		return sum;
	};
	const double start = motion();
	const int frames = isHeld ? int( 100.0 * 2.0 * SIMD_PI / omega * 60.0 ) : 600, window = std::max( 30, frames / 50 ); // two periods
	double first = 0.0, last = 0.0;
	for ( int frame = 0; frame < frames; ++frame )
	{
		t.run( 1 );
		first = frame < window ? std::max( first, motion() ) : first;
		last = frame >= frames - window ? std::max( last, motion() ) : last;
	}
	EXPECT_TRUE( body->isHealthy() );
	return last / ( isHeld ? first : start );
}

TEST( FreeSwing, KeepsItsEnergyOverAHundredPeriods )
{
	for ( const float youngsModulus : { 2e6f, 2e7f } )
	{
		const double explicitly = energyOfSwing( Elasticity::Explicit, youngsModulus, true ),
					 implicitly = energyOfSwing( Elasticity::Implicit, youngsModulus, true );
		std::printf( "%.0e Pa: explicit %.4f, implicit %.4f of the energy\n", double( youngsModulus ), explicitly, implicitly );
		EXPECT_NEAR( explicitly, 1.0, 0.05 );
		EXPECT_NEAR( implicitly, 1.0, 0.05 );
	}
}

// They gained 27 and 3.5 times their energy in ten seconds: their links were stretched by a quarter and more in one step.
TEST( FreeSwing, UnresolvedVibrationsGainNoEnergy )
{
	for ( const float youngsModulus : { 2e5f, 2e6f, 2e7f, 2e8f } )
	{
		const double left = energyOfSwing( Elasticity::Implicit, youngsModulus, false );
		std::printf( "%.0e Pa: %.4f of the energy\n", double( youngsModulus ), left );
		EXPECT_LT( left, 1.15 ); // the kinetic energy of a resolved vibration is up to ( omega h )^2 / 4 above that of the exact one
	}
}

} // namespace
} // namespace pliant
