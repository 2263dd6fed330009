// Ground, attachments, grippers and stepping of the world: scenes that fail in some engines with soft bodies, compared with rigid ones
// where possible.

#include "test_meshes.h"
#include "twin_worlds.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::kFrame;
using test::RigidScene;
using test::stepping;
using test::TestWorld;

/// For explicit and implicit bodies.
class Grounds : public testing::TestWithParam<Elasticity>
{};
INSTANTIATE_TEST_SUITE_P( Steps, Grounds, testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& with ) { return std::string( with.param == Elasticity::Explicit ? "Explicit" : "Implicit" ); } );

/// A mesh that outlives the shape made of it.
struct Terrain
{
	std::vector<btVector3> vertices;
	std::vector<int> indices;
	std::unique_ptr<btTriangleIndexVertexArray> array;

	/// n x n quads over a square with edge `edge` m about the origin, at the heights given by `height`.
	template <class Height>
	Terrain( int n, btScalar edge, const Height& height )
	{
		for ( int k = 0; k < ( n + 1 ) * ( n + 1 ); ++k )
		{
			const btScalar x = edge * ( btScalar( k % ( n + 1 ) ) / btScalar( n ) - btScalar( 0.5 ) ),
						   z = edge * ( btScalar( k / ( n + 1 ) ) / btScalar( n ) - btScalar( 0.5 ) );
			vertices.emplace_back( x, height( x, z ), z );
		}
		for ( int k = 0; k < n * n; ++k )
		{
			const int a = k % n + k / n * ( n + 1 ), b = a + 1, c = a + n + 1, d = c + 1;
			indices.insert( indices.end(), { a, c, b, b, c, d } );
		}
		array = std::make_unique<btTriangleIndexVertexArray>( int( indices.size() / 3 ), indices.data(), int( 3 * sizeof( int ) ),
			int( vertices.size() ), vertices.data()->m_floats, int( sizeof( btVector3 ) ) );
	}
};

// Frames of 1.7, 17 or 50 ms in turn: bodies at rest must neither hop nor sink at a change.
TEST_P( Grounds, StepsOfVaryingLengthKeepTheRestHeight )
{
	TestWorld t;
	t.addFloor();
	SoftBody* const cube = t.addSoft( test::cubeTemplate( 1.0f, 8 ), at( 0, btScalar( 0.51 ), 0 ), stepping( GetParam(), 3e5f ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	t.run( 180 );
	const btScalar height = cube->massCentre().y();
	for ( int k = 0; k < 360; ++k )
	{
		const btScalar steps[3] = { btScalar( 1 ) / 600, btScalar( 1 ) / 60, btScalar( 1 ) / 20 };
		t.world.stepSimulation( steps[k % 3], 0 );
		ASSERT_NEAR( cube->massCentre().y(), height, 0.002 ) << "after " << k << " steps";
	}
}

// A trigger: it lets everything pass, and reports contacts.
TEST_P( Grounds, WithoutContactResponseContactsAreReportedAndTheBodyFallsThrough )
{
	TestWorld t;
	t.addFloor();
	SoftBody* const cube = t.addSoft( test::cubeTemplate( 1.0f, 8 ), at( 0, btScalar( 0.6 ), 0 ), stepping( GetParam(), 3e5f ) );
	cube->setCollisionFlags( cube->getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE );
	int told = 0;
	for ( int k = 0; k < 60; ++k )
	{
		t.run( 1 );
		for ( int m = 0; m < t.parts.dispatcher.getNumManifolds(); ++m )
		{
			told += t.parts.dispatcher.getManifoldByIndexInternal( m )->getNumContacts();
		}
	}
	EXPECT_GT( told, 100 );
	EXPECT_NEAR( cube->massCentre().y(), 0.6 - 5, 0.2 ) << "it falls freely";
}

// A trigger of 50 m around a level at rest must not keep its bodies awake.
TEST_P( Grounds, AGhostAroundEverythingLetsAllSleep )
{
	TestWorld t;
	t.add( 0, new btBoxShape( btVector3( 50, 1, 50 ) ), at( 0, -1, 0 ) );
	btGhostPairCallback pairs;
	btGhostObject ghost;
	btBoxShape ghostShape( btVector3( 25, 25, 25 ) );
	ghost.setCollisionShape( &ghostShape );
	ghost.setCollisionFlags( ghost.getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE );
	t.world.getPairCache()->setInternalGhostPairCallback( &pairs );
	t.world.addCollisionObject( &ghost, btBroadphaseProxy::SensorTrigger, btBroadphaseProxy::AllFilter );
	const std::shared_ptr<const BodyTemplate> made = test::cubeTemplate( 0.5f, 4 );
	for ( int k = 0; k < 50; ++k )
	{
		t.addSoft( made, at( btScalar( k % 10 ) - 5, btScalar( 0.26 ), btScalar( k / 10 ) - 2 ), stepping( GetParam(), 3e5f ) );
	}
	t.run( 420 );
	int awake = 0;
	for ( const auto& body : t.soft )
	{
		awake += body->isActive();
	}
	EXPECT_EQ( awake, 0 );
	EXPECT_EQ( ghost.getNumOverlappingObjects(), 51 );
	t.world.removeCollisionObject( &ghost );
	t.world.getPairCache()->setInternalGhostPairCallback( nullptr );
}

/// Sum of the impulses in the tick callback, N s.
btScalar g_borne = 0;

// Scales and pressure plates: the impulses in the tick callback are those of the whole step and add up to the weight.
TEST_P( Grounds, ImpulsesInTheTickCallbackSumToTheWeight )
{
	TestWorld t;
	t.addFloor();
	SoftBody* const cube = t.addSoft( test::cubeTemplate( 1.0f, 8 ), at( 0, btScalar( 0.505 ), 0 ), stepping( GetParam(), 3e5f ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	t.run( 240 );
	t.world.setInternalTickCallback( []( btDynamicsWorld* world, btScalar ) {
		btDispatcher& dispatcher = *world->getDispatcher();
		for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
		{
			const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
			for ( int p = 0; p < manifold.getNumContacts(); ++p )
			{
				g_borne += manifold.getContactPoint( p ).getAppliedImpulse();
			}
		}
	} );
	g_borne = 0;
	t.run( 60 );
	EXPECT_NEAR( g_borne, cube->mass() * 10, btScalar( 0.02 ) * cube->mass() * 10 ) << "N s in a second";
	EXPECT_NEAR( cube->mass(), 1000, 1 );
}

// One mesh with several instances, scaled by a different factor along each axis.
TEST_P( Grounds, AScaledMeshCarriesSoftBodiesLikeRigidOnes )
{
	const auto height = []( btScalar x, btScalar ) { return btScalar( 0.4 ) * x; }; // scaled: .1 for 1
	Terrain terrain( 10, 4, height );
	btBvhTriangleMeshShape mesh( terrain.array.get(), true );
	TestWorld t;
	btRigidBody* const ground = t.add( 0, new btScaledBvhTriangleMeshShape( &mesh, btVector3( 2, btScalar( 0.5 ), 3 ) ), at( 0, 0, 0 ) );
	ground->setFriction( 1 );
	btRigidBody* const box = t.addBox( 1000, btVector3( btScalar( 0.5 ), btScalar( 0.5 ), btScalar( 0.5 ) ), at( 1, btScalar( 0.8 ), 3 ) );
	box->setFriction( 1 );
	SoftBody* const cube = t.addSoft( test::cubeTemplate( 1.0f, 8 ), at( 1, btScalar( 0.8 ), -3 ), stepping( GetParam(), 3e5f ) );
	cube->setFriction( 1 );
	t.run( 300 );
	const btVector3 twin = box->getWorldTransform().getOrigin(), found = cube->massCentre();
	EXPECT_NEAR( found.y(), twin.y(), 0.05 );
	EXPECT_NEAR( found.x(), twin.x(), 0.05 );
	EXPECT_NEAR( test::lowestNode( *cube ), 0.0625 + 0.05, 0.04 ) << "on the slope";
}

// At the last row of a heightfield bodies must not fall through or be thrown away. A soft body leans over an edge where a rigid one stands,
// but equally over the edge of a box.
TEST_P( Grounds, TheBorderOfAHeightfieldActsLikeThatOfABox )
{
	constexpr int kPosts = 11; // 10 m by 10 m about the origin
	std::vector<float> heights( kPosts * kPosts, 0.0f );
	for ( const btScalar x : { btScalar( 4.4 ), btScalar( 4.8 ), btScalar( 5.2 ) } )
	{
		btVector3 position[3]; // on the field, on the box, and a rigid one on the field
		for ( int k = 0; k < 3; ++k )
		{
			TestWorld t;
			k == 1 ? t.addBox( 0, btVector3( 5, 1, 5 ), at( 0, -1, 0 ) )
				   : t.add( 0, new btHeightfieldTerrainShape( kPosts, kPosts, heights.data(), btScalar( -1 ), btScalar( 1 ), 1, false ),
						 at( 0, 0, 0 ) );
			btRigidBody* const box = k == 2
				? t.addBox( 1000, btVector3( btScalar( 0.5 ), btScalar( 0.5 ), btScalar( 0.5 ) ), at( x, btScalar( 0.55 ), 0 ) )
				: nullptr;
			SoftBody* const cube = k == 2
				? nullptr
				: t.addSoft( test::cubeTemplate( 1.0f, 8 ), at( x, btScalar( 0.55 ), 0 ), stepping( GetParam(), 3e5f ) );
			t.run( 120 );
			position[k] = cube ? cube->massCentre() : box->getWorldTransform().getOrigin();
		}
		EXPECT_EQ( position[0].y() > 0, position[2].y() > 0 ) << x;
		if ( position[2].y() > 0 )
		{
			EXPECT_LT( ( position[0] - position[1] ).length(), 0.01 ) << x;
			EXPECT_LT( ( position[0] - position[2] ).length(), 0.12 ) << x;
		}
		EXPECT_LT( btFabs( position[0].x() - position[2].x() ), 2 ) << "it is not thrown away";
	}
}

// A heightfield that rises under a body by half a cell per frame: nodes below the field must be pushed up, not down. There is no rigid
// twin: Bullet's box of this size is lifted in single precision, and sinks in in double precision.
TEST_P( Grounds, ARisingHeightfieldLiftsBodies )
{
	static constexpr int kPosts = 21, kRise = 10; // frames
	const auto risen = []( const std::function<btScalar( TestWorld& )>& centre ) {
		std::vector<float> heights( kPosts * kPosts, 0.0f );
		TestWorld t;
		t.add( 0, new btHeightfieldTerrainShape( kPosts, kPosts, heights.data(), btScalar( -2 ), btScalar( 2 ), 1, false ), at( 0, 0, 0 ) );
		centre( t );
		for ( int k = 0; k < 60 + kRise + 180; ++k )
		{
			for ( float& height : heights )
			{
				height = 0.04f * float( std::clamp( k - 60, 0, kRise ) );
			}
			t.run( 1 );
		}
		return centre( t ) - btScalar( heights[0] );
	};
	btRigidBody* box = nullptr;
	const btScalar twin = risen( [&box]( TestWorld& t ) {
		box = box ? box
				  : t.addBox( 1000, btVector3( btScalar( 0.5 ), btScalar( 0.5 ), btScalar( 0.5 ) ),
						at( btScalar( 0.1 ), btScalar( 0.5 ), btScalar( 0.2 ) ) );
		box->setActivationState( DISABLE_DEACTIVATION );
		return box->getWorldTransform().getOrigin().y();
	} );
	EXPECT_NEAR( twin, 0.5, 0.01 );
	for ( const float youngsModulus : { 5e4f, 3e5f } )
	{
		SoftBody* cube = nullptr;
		const btScalar found = risen( [&cube, youngsModulus]( TestWorld& t ) {
			cube = cube ? cube
						: t.addSoft( test::cubeTemplate( 1.0f, 10 ), at( btScalar( 0.1 ), btScalar( 0.5 ), btScalar( 0.2 ) ),
							  stepping( GetParam(), youngsModulus ) );
			cube->setActivationState( DISABLE_DEACTIVATION );
			return cube->massCentre().y();
		} );
		EXPECT_NEAR( found, twin, youngsModulus < 1e5f ? 0.1 : 0.05 ) << youngsModulus; // compressed by its own weight
	}
}

// A sheet of triangles, which has no inside, or a heightfield over a cave: a cube rests on it, and an object from below stays below.
TEST_P( Grounds, SurfacesWithoutThicknessHoldFromBothSides )
{
	Terrain terrain( 4, 8, []( btScalar, btScalar ) { return btScalar( 0 ); } );
	std::vector<float> heights( 81, 0.0f );
	for ( const bool isField : { false, true } )
	{
		TestWorld t;
		btCollisionShape* const sheet = isField ? static_cast<btCollisionShape*>( new btHeightfieldTerrainShape(
													  9, 9, heights.data(), btScalar( -1 ), btScalar( 1 ), 1, false ) )
												: new btBvhTriangleMeshShape( terrain.array.get(), true );
		t.add( 0, sheet, at( 0, 0, 0 ) );
		SoftBody* const above = t.addSoft( test::cubeTemplate( 1.0f, 8 ), at( -2, btScalar( 1.5 ), 0 ), stepping( GetParam(), 3e5f ) );
		SoftBody* const below = t.addSoft( test::cubeTemplate( 1.0f, 8 ), at( 2, btScalar( -1.5 ), 0 ), stepping( GetParam(), 3e5f ) );
		ASSERT_TRUE( below->setLinearVelocity( btVector3( 0, 8, 0 ) ).ok() );
		btScalar highest = -10;
		for ( int k = 0; k < 240; ++k )
		{
			t.run( 1 );
			highest = btMax( highest, below->massCentre().y() );
		}
		EXPECT_NEAR( above->massCentre().y(), 0.5, 0.03 ) << isField;
		EXPECT_LT( highest, btScalar( -0.3 ) ) << isField;
		EXPECT_GT( highest, btScalar( -0.6 ) ) << "it reached the sheet";
		EXPECT_LT( below->massCentre().y(), -5 ) << isField;
	}
}

// A bar stretched to twice its length has wide gaps between its nodes, but must still catch a ball.
TEST_P( Grounds, ABarStretchedTwofoldCatchesABall )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const bar = t.addSoft( block( 20, 2, 4, 0.1f ), at( 0, 0, 0 ), stepping( GetParam(), 3e5f ) );
	std::vector<int> held;
	std::vector<btVector3> from;
	for ( int i = 0; i < bar->nodeCount(); ++i )
	{
		if ( btFabs( bar->nodePosition( i ).x() ) > btScalar( 0.9 ) )
		{
			held.push_back( i );
			from.push_back( bar->nodePosition( i ) );
		}
	}
	for ( int k = 1; k <= 120; ++k )
	{
		for ( std::size_t h = 0; h < held.size(); ++h )
		{
			const btScalar out = btScalar( k ) / 120 * ( from[h].x() > 0 ? 1 : -1 );
			ASSERT_TRUE( bar->driveNode( held[h], from[h] + btVector3( out, 0, 0 ) ).ok() );
		}
		t.run( 1 );
	}
	t.world.setGravity( btVector3( 0, -10, 0 ) );
	btRigidBody* const ball = t.add( 5, new btSphereShape( btScalar( 0.1 ) ), at( btScalar( 0.03 ), btScalar( 0.7 ), 0 ) );
	btScalar lowest = 1;
	for ( int k = 0; k < 180; ++k )
	{
		t.run( 1 );
		lowest = btMin( lowest, ball->getWorldTransform().getOrigin().y() );
	}
	EXPECT_GT( ball->getWorldTransform().getOrigin().y(), btScalar( -0.3 ) );
	EXPECT_GT( lowest, btScalar( -0.6 ) );
}

/// Returns the largest transverse node speed of a bar of 20 x 2 x 2 cells of 5 cm, after three seconds of being held stretched by a
/// fraction of its length, m/s.
btScalar vibrationOfATautBar( const Material& material, btScalar stretch )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const bar = t.addSoft( block( 20, 2, 2, 0.05f ), at( 0, 0, 0 ), material );
	bar->setActivationState( DISABLE_DEACTIVATION );
	const int middle = bar->nearestNode( btVector3( 0, 0, 0 ) );
	std::vector<btVector3> from;
	for ( int i = 0; i < bar->nodeCount(); ++i )
	{
		from.push_back( bar->nodePosition( i ) );
	}
	for ( int k = 1; k <= 240; ++k )
	{
		for ( int i = 0; i < bar->nodeCount(); ++i )
		{
			const btScalar x = from[std::size_t( i )].x();
			if ( btFabs( x ) > btScalar( 0.45 ) )
			{
				const btScalar out = btScalar( 0.5 ) * stretch * btMin( btScalar( 1 ), btScalar( k ) / 60 );
				EXPECT_TRUE( bar->driveNode( i, from[std::size_t( i )] + btVector3( x > 0 ? out : -out, 0, 0 ) ).ok() );
			}
		}
		if ( k == 60 )
		{
			EXPECT_TRUE( bar->applyImpulse( btVector3( 0, btScalar( 0.1 ) * bar->nodeMass( middle ), 0 ), middle ).ok() ); // plucked
		}
		t.run( 1 );
	}
	btScalar fastest = 0;
	for ( int i = 0; i < bar->nodeCount(); ++i )
	{
		const btVector3 v = bar->nodeVelocity( i );
		fastest = btMax( fastest, btVector3( 0, v.y(), v.z() ).length() );
	}
	return fastest;
}

// Ropes and springs under tension swing and come to rest when plucked.
TEST( TautBar, ComesToRest )
{
	for ( const float youngsModulus : { 1e5f, 1e6f } )
	{
		EXPECT_LT( vibrationOfATautBar( stepping( Elasticity::Explicit, youngsModulus ), btScalar( 0.25 ) ), btScalar( 0.02 ) )
			<< youngsModulus;
	}
	EXPECT_LT( vibrationOfATautBar( stepping( Elasticity::Implicit, 1e5f ), btScalar( 0.25 ) ), btScalar( 0.02 ) );
	EXPECT_LT( vibrationOfATautBar( stepping( Elasticity::Implicit, 1e6f ), btScalar( 0.1 ) ), btScalar( 0.02 ) );
}

// Modes that tension makes faster than a step can resolve vibrated forever, at 2 and 11 m/s: the implicit operator lacked the geometric
// stiffness of tension.
TEST( TautBar, ComesToRestImplicitly )
{
	for ( const float youngsModulus : { 1e6f, 1e7f } )
	{
		EXPECT_LT( vibrationOfATautBar( stepping( Elasticity::Implicit, youngsModulus ), btScalar( 0.25 ) ), btScalar( 0.02 ) )
			<< youngsModulus;
	}
}

// A gripper: two fingers close on a soft ball of 50 mm and lift it.
TEST_P( Grounds, TwoFingersLiftASoftBall )
{
	constexpr btScalar kRadius = btScalar( 0.025 );
	TestWorld t;
	t.addFloor();
	LatticeSettings settings;
	settings.cellSize = 0.0075f;
	const std::shared_ptr<const BodyTemplate> made = BodyTemplate::build( test::makeSphere( double( kRadius ), 8, 16 ).view(), settings )
														 .value;
	ASSERT_NE( made, nullptr );
	SoftBody* const ball = t.addSoft( made, at( 0, kRadius, 0 ), stepping( GetParam(), GetParam() == Elasticity::Explicit ? 1e4f : 1e5f ) );
	ball->setFriction( btScalar( 0.8 ) );
	btRigidBody* fingers[2];
	for ( int f = 0; f < 2; ++f )
	{
		auto* const shape = new btBoxShape( btVector3( btScalar( 0.005 ), btScalar( 0.02 ), btScalar( 0.02 ) ) );
		shape->setMargin( btScalar( 0.001 ) );
		fingers[f] = t.add( 0, shape, at( btScalar( f ? 0.04 : -0.04 ), kRadius, 0 ) );
		fingers[f]->setCollisionFlags( fingers[f]->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
		fingers[f]->setActivationState( DISABLE_DEACTIVATION );
		fingers[f]->setFriction( 1 ); // Bullet multiplies: .8
	}
	for ( int k = 1; k <= 3600; ++k )
	{
		// Closed by 5 mm each within a second, lifted by .2 m within two, then held for a minute.
		const btScalar gap = btScalar( 0.04 ) - btScalar( 0.015 ) * btMin( btScalar( 1 ), btScalar( k ) / 60 );
		const btScalar lift = btScalar( 0.2 ) * btMin( btScalar( 1 ), btMax( btScalar( 0 ), btScalar( k - 90 ) / 120 ) );
		for ( int f = 0; f < 2; ++f )
		{
			fingers[f]->setWorldTransform( at( f ? gap : -gap, kRadius + lift, 0 ) );
		}
		t.run( 1 );
	}
	EXPECT_NEAR( ball->massCentre().y(), kRadius + btScalar( 0.2 ), 0.005 );
}

} // namespace
} // namespace pliant
