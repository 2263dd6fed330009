// Changes that a game makes while a body sleeps, compared with a rigid body in Bullet; GImpact meshes; debug drawing by flags.

#include "world/test_world.h"

#include <pliant/game/debug_draw.h>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <LinearMath/btIDebugDraw.h>

#include <algorithm>
#include <cmath>

namespace pliant::test {

namespace {

struct Sleeping : TestWorld
{
	btRigidBody* floor;
	SoftBody* soft;
	btRigidBody* rigid;

	explicit Sleeping( const Material& material = stiff( 2e5f ) )
	{
		floor = addFloor();
		soft = addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.2f, 0 ), material );
		rigid = addBox( 64, btVector3( 0.2f, 0.2f, 0.2f ), at( 3, 0.2f, 0 ) );
		run( 500 );
		EXPECT_FALSE( soft->isActive() );
		EXPECT_FALSE( rigid->isActive() );
	}
};

} // namespace

TEST( ChangedAsleep, TheWorldsGravityWakesNothingAndIsFeltAfterwards )
{
	Sleeping t;
	t.world.setGravity( btVector3( 0, 5, 0 ) );
	t.run( 60 );
	EXPECT_FALSE( t.rigid->isActive() );
	EXPECT_FALSE( t.soft->isActive() );
	t.soft->activate( true );
	t.run( 30 );
	EXPECT_GT( t.soft->linearVelocity().y(), 1 );
}

TEST( ChangedAsleep, TheBodysOwnGravityWakesIt )
{
	Sleeping t;
	ASSERT_TRUE( t.soft->setGravity( btVector3( 0, 5, 0 ) ).ok() );
	t.run( 30 );
	EXPECT_GT( t.soft->linearVelocity().y(), 1 );
}

TEST( ChangedAsleep, AWeakerMaterialSagsAndHeavierLoadsToo )
{
	Sleeping t;
	const btScalar before = t.soft->massCentre().y();
	Material weak = t.soft->material();
	weak.youngsModulus = 1e4f;
	ASSERT_TRUE( t.soft->setMaterial( weak ).ok() );
	t.run( 60 );
	EXPECT_LT( t.soft->massCentre().y(), before - btScalar( 0.01 ) );
}

TEST( ChangedAsleep, BodiesThatLieOnTheChangedOneWakeToo )
{
	TestWorld t;
	t.addFloor();
	SoftBody* low = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.2f, 0 ), stiff( 2e5f ) );
	btRigidBody* load = t.addBox( 20, btVector3( 0.2f, 0.1f, 0.2f ), at( 0, 0.51f, 0 ) );
	t.run( 500 );
	ASSERT_FALSE( low->isActive() || load->isActive() );
	Material weak = low->material();
	weak.youngsModulus = 2e4f;
	const btScalar before = load->getCenterOfMassPosition().y();
	ASSERT_TRUE( low->setMaterial( weak ).ok() );
	t.run( 60 );
	EXPECT_LT( load->getCenterOfMassPosition().y(), before - btScalar( 0.005 ) );
}

TEST( ChangedAsleep, AStretchedBodyBreaksUnderANewRule )
{
	TestWorld t;
	Material material = stiff( 2e5f );
	material.wobbleDamping = 0.5f;
	SoftBody* bar = t.addSoft( block( 2, 8, 2, 0.1f ), at( 0, 0, 0 ), material );
	ASSERT_GT( bar->pinNodesInside( btVector3( -1, 0.3f, -1 ), btVector3( 1, 1, 1 ) ), 0 );
	for ( int frame = 0; frame < 900 && bar->isActive(); ++frame )
	{
		t.run( 1 );
	}
	ASSERT_FALSE( bar->isActive() );
	Fracture fracture;
	fracture.rule = BreakRule::Distance;
	fracture.breakStrain = 0.01f;
	ASSERT_TRUE( bar->setFracture( fracture ).ok() );
	t.run( 30 );
	EXPECT_GT( t.world.softBodyCount(), 1 ) << "its own weight stretches it by more";
}

TEST( ChangedAsleep, APinHoldsAndAReleasedNodeFalls )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ), stiff( 1e6f ) );
	ASSERT_EQ( cube->pinNodesInside( btVector3( -1, -1, -1 ), btVector3( 1, 1, 1 ) ), 27 );
	for ( int frame = 0; frame < 300 && cube->isActive(); ++frame )
	{
		t.run( 1 );
	}
	ASSERT_FALSE( cube->isActive() );
	ASSERT_TRUE( cube->driveNode( 0, cube->nodePosition( 0 ) + btVector3( 0, 0.01f, 0 ) ).ok() );
	EXPECT_TRUE( cube->isActive() );
	for ( int node = 0; node < 27; ++node )
	{
		cube->releaseNode( node );
	}
	t.run( 30 );
	EXPECT_LT( cube->linearVelocity().y(), -2 );
}

// Bullet woke the body while its islands were solved. Its nodes then had no equations, and the impulses that they received were lost: a
// ball of 100 kg lost 3 to 6 % of its momentum, one of 1 kg 23 to 76 %.
TEST( HitAsleep, BodiesTakeTheMomentumOfWhatHitsThem )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const double mass : { 1.0, 100.0 } )
		{
			for ( const double speed : { 0.05, 1.0, 10.0 } )
			{
				TestWorld t;
				t.world.setGravity( btVector3( 0, 0, 0 ) );
				Material material = stiff( 1e5f );
				material.elasticity = elasticity;
				const SoftBody* const cube = t.addSoft( block( 10, 10, 10, 0.1f ), at( 0, 0, 0 ), material );
				t.run( 300 );
				ASSERT_FALSE( cube->isActive() );
				btRigidBody* const ball = t.add( btScalar( mass ), new btSphereShape( btScalar( 0.2 ) ), at( 0, btScalar( 0.75 ), 0 ) );
				ball->setLinearVelocity( btVector3( 0, btScalar( -speed ), 0 ) );
				ball->setActivationState( DISABLE_DEACTIVATION );
				const double before = -mass * speed;
				double lost = 0.0;
				for ( int frame = 0; frame < 10 + int( 6.0 / speed ); ++frame )
				{
					t.run( 1 );
					const double now = mass * double( ball->getLinearVelocity().y() ) + double( cube->mass() * cube->linearVelocity().y() );
					lost = std::max( lost, std::abs( now / before - 1.0 ) );
				}
				EXPECT_GT( double( ball->getLinearVelocity().y() ), -0.99 * speed ) << "it has not hit";
				EXPECT_LT( lost, 1e-3 ) << mass << " kg at " << speed << " m/s, elasticity " << int( elasticity );
			}
		}
	}
}

// A sleeping body that wakes in the middle of a step lost its contacts with the floor, whose pair had not been detected, and what slept on
// it did not feel the hit.
TEST( HitAsleep, BodiesKeepTheirContactsWithTheFloorAndWakeWhatLiesOnThem )
{
	TestWorld t;
	const btRigidBody* const floor = t.addFloor();
	const auto contactsWithFloor = [&]( const SoftBody* body ) {
		int count = 0;
		for ( int m = 0; m < t.parts.dispatcher.getNumManifolds(); ++m )
		{
			const btPersistentManifold& manifold = *t.parts.dispatcher.getManifoldByIndexInternal( m );
			const btCollisionObject *const a = manifold.getBody0(), *const b = manifold.getBody1();
			const bool isOfBoth = ( a == floor && SoftBody::upcast( b ) == body ) || ( b == floor && SoftBody::upcast( a ) == body );
			count += isOfBoth ? manifold.getNumContacts() : 0;
		}
		return count;
	};
	const SoftBody* const lower = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.2 ), 0 ), stiff( 2e5f ) );
	const SoftBody* const upper = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.6 ), 0 ), stiff( 2e5f ) );
	t.run( 500 );
	ASSERT_FALSE( lower->isActive() );
	ASSERT_FALSE( upper->isActive() );
	SoftBody* const awake = t.addSoft( block( 4, 4, 4, 0.1f ), at( 3, btScalar( 0.2 ), 0 ), stiff( 2e5f ) );
	awake->setActivationState( DISABLE_DEACTIVATION );
	btRigidBody* const ball = t.add( 1, new btSphereShape( btScalar( 0.1 ) ), at( btScalar( -0.5 ), btScalar( 0.2 ), 0 ) );
	ball->setLinearVelocity( btVector3( 2, 0, 0 ) );
	const btScalar before = lower->massCentre().y(), above = upper->massCentre().y();
	const int contacts = contactsWithFloor( lower );
	EXPECT_GT( contacts, 4 );
	int frames = 0;
	for ( ; frames < 60 && !lower->isActive(); ++frames )
	{
		t.run( 1 );
	}
	EXPECT_LT( frames, 30 );
	EXPECT_TRUE( upper->isActive() ) << "in the same step";
	EXPECT_EQ( contactsWithFloor( lower ), contacts );
	t.run( 1 );
	EXPECT_NEAR( lower->massCentre().y(), before, 1e-3 );
	EXPECT_NEAR( upper->massCentre().y(), above, 1e-3 );
	EXPECT_LT( std::abs( lower->linearVelocity().y() ), btScalar( 0.05 ) );
	EXPECT_LT( std::abs( upper->linearVelocity().y() ), btScalar( 0.05 ) );
}

// Static bodies, as pieces that have become scenery, cannot wake: the search for all that lies on what is hit never ended.
TEST( HitAsleep, ABodyBesideAStaticOneWakes )
{
	TestWorld t;
	t.addFloor();
	SoftBody* const lower = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.2 ), 0 ), stiff( 2e5f ) );
	SoftBody* const upper = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 0.6 ), 0 ), stiff( 2e5f ) );
	t.run( 500 );
	ASSERT_FALSE( upper->isActive() );
	lower->setCollisionFlags( lower->getCollisionFlags() | btCollisionObject::CF_STATIC_OBJECT );
	btRigidBody* const ball = t.add( 20, new btSphereShape( btScalar( 0.1 ) ), at( btScalar( -0.5 ), btScalar( 0.6 ), 0 ) );
	ball->setLinearVelocity( btVector3( 4, 0, 0 ) );
	t.run( 20 );
	EXPECT_TRUE( upper->isActive() );
	EXPECT_GT( upper->massCentre().x(), btScalar( 0.02 ) );
	EXPECT_FALSE( lower->isActive() );
}

TEST( ChangedAsleep, AFilterThatLeavesOutTheFloorLetsItFall )
{
	Sleeping t;
	t.world.removeCollisionObject( t.soft );
	t.world.addSoftBody( t.soft, 64, 64 );
	t.run( 60 );
	EXPECT_LT( t.soft->massCentre().y(), -1 );
}

// --- GImpact meshes -----------------------------------------------------------------------------------------------------------

namespace {

enum class Registered
{
	Never,
	Before,
	After
};

/// A box of twelve triangles.
struct Mesh
{
	std::unique_ptr<btTriangleMesh> triangles = std::make_unique<btTriangleMesh>();
	std::unique_ptr<btGImpactMeshShape> shape;

	explicit Mesh( const btVector3& half )
	{
		static const int indices[36] = {
			0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
		const auto corner = [&half]( int i ) {
			return btVector3(
				( i & 1 ) != 0 ? half.x() : -half.x(), ( i & 2 ) != 0 ? half.y() : -half.y(), ( i & 4 ) != 0 ? half.z() : -half.z() );
		};
		for ( int k = 0; k < 36; k += 3 )
		{
			triangles->addTriangle( corner( indices[k] ), corner( indices[k + 1] ), corner( indices[k + 2] ) );
		}
		shape = std::make_unique<btGImpactMeshShape>( triangles.get() );
		shape->updateBound();
	}
};

} // namespace

static std::string nameOf( const ::testing::TestParamInfo<Registered>& given )
{
	return given.param == Registered::Never ? "Never" : given.param == Registered::Before ? "Before" : "After";
}

class GImpact : public ::testing::TestWithParam<Registered>
{};

INSTANTIATE_TEST_SUITE_P( Algorithm, GImpact, ::testing::Values( Registered::Never, Registered::Before, Registered::After ), nameOf );

TEST_P( GImpact, MeshesCarrySoftBodiesAndLieOnThem )
{
	Mesh ground( btVector3( 3, 0.5f, 3 ) ), crate( btVector3( 0.3f, 0.3f, 0.3f ) ); // outlive the world
	TestWorld t;
	if ( GetParam() == Registered::Before )
	{
		btGImpactCollisionAlgorithm::registerAlgorithm( &t.parts.dispatcher );
	}
	t.add( 0, ground.shape.release(), at( 0, -0.5f, 0 ) );
	SoftBody* cube = t.addSoft( block( 5, 5, 5, 0.2f ), at( 0, 0.6f, 0 ), stiff( 3e5f ) );
	t.run( 1 );
	if ( GetParam() == Registered::After )
	{
		btGImpactCollisionAlgorithm::registerAlgorithm( &t.parts.dispatcher );
	}
	t.run( 60 );
	btRigidBody* box = t.add( 30, crate.shape.release(), at( 0, 1.5f, 0 ) );
	t.run( 240 );
	EXPECT_NEAR( cube->massCentre().y(), 0.5, 0.03 );
	EXPECT_NEAR( box->getCenterOfMassPosition().y(), 1.3, 0.06 );
	EXPECT_TRUE( cube->isHealthy() );
}

// --- drawing ------------------------------------------------------------------------------------------------------------------

namespace {

struct LineCounter : btIDebugDraw
{
	int mode = DBG_DrawWireframe | DBG_DrawConstraints | DBG_DrawContactPoints, lines = 0, spheres = 0, red = 0;

	void drawLine( const btVector3&, const btVector3&, const btVector3& colour ) override
	{
		++lines;
		red += colour.x() > btScalar( 0.9 ) && colour.y() < btScalar( 0.1 ) && colour.z() < btScalar( 0.1 ) ? 1 : 0;
	}
	void drawSphere( btScalar, const btTransform&, const btVector3& ) override { ++spheres; }
	void drawSphere( const btVector3&, btScalar, const btVector3& ) override { ++spheres; }
	void drawContactPoint( const btVector3&, const btVector3&, btScalar, int, const btVector3& ) override {}
	void reportErrorWarning( const char* ) override {}
	void draw3dText( const btVector3&, const char* ) override {}
	void setDebugMode( int to ) override { mode = to; }
	int getDebugMode() const override { return mode; }
};

DebugDrawing nothing()
{
	DebugDrawing what;
	what.surfaceLinks = what.pins = false;
	return what;
}

int linesOf( TestWorld& t, LineCounter& drawer, const DebugDrawing& what )
{
	t.world.setDebugDrawing( what );
	drawer.lines = drawer.spheres = drawer.red = 0;
	t.world.debugDrawWorld();
	return drawer.lines;
}

} // namespace

TEST( DebugDrawing, DrawsWhatIsAskedFor )
{
	TestWorld t;
	btRigidBody* floor = t.addFloor();
	floor->setCollisionFlags( floor->getCollisionFlags() | btCollisionObject::CF_DISABLE_VISUALIZE_OBJECT );
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.15f, 0 ) );
	btRigidBody* anchor = t.addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 1, 0 ) );
	anchor->setCollisionFlags( anchor->getCollisionFlags() | btCollisionObject::CF_DISABLE_VISUALIZE_OBJECT );
	ASSERT_TRUE( t.world.attach( *cube, 26, *anchor ).ok() );
	t.run( 10 );
	LineCounter drawer;
	t.world.setDebugDrawer( &drawer );
	EXPECT_EQ( linesOf( t, drawer, DebugDrawing{} ), 48 ) << "by default the links of the surface";
	DebugDrawing what = nothing();
	EXPECT_EQ( linesOf( t, drawer, what ), 0 );
	what.links = true;
	EXPECT_EQ( linesOf( t, drawer, what ), cube->linkCount() );
	what = nothing();
	what.cells = true;
	EXPECT_EQ( linesOf( t, drawer, what ), 6 * 9 * 4 );
	what = nothing();
	what.levels = true;
	linesOf( t, drawer, what );
	EXPECT_EQ( drawer.spheres, 27 );
	what = nothing();
	what.regions = true;
	EXPECT_EQ( linesOf( t, drawer, what ), 3 * 27 );
	what = nothing();
	what.attachments = true;
	EXPECT_EQ( linesOf( t, drawer, what ), 2 );
	what = nothing();
	what.contacts = true;
	EXPECT_GE( linesOf( t, drawer, what ), 4 );
	what = nothing();
	what.strain = true;
	EXPECT_EQ( linesOf( t, drawer, what ), 48 );
	EXPECT_EQ( drawer.red, 0 );
	ASSERT_TRUE( cube->pinNode( 26 ).ok() );
	ASSERT_TRUE( cube->driveNode( 26, cube->nodePosition( 26 ) + btVector3( 0, 0.1f, 0 ) ).ok() );
	t.run( 1 );
	linesOf( t, drawer, what );
	EXPECT_GT( drawer.red, 0 ) << "what is pulled by a cell's length";
	what = nothing();
	what.pins = true;
	EXPECT_EQ( linesOf( t, drawer, what ), 3 );
	drawer.mode = btIDebugDraw::DBG_NoDebug;
	EXPECT_EQ( linesOf( t, drawer, DebugDrawing{} ), 0 );
	EXPECT_TRUE( t.world.debugDrawing().pins );
	t.world.setDebugDrawer( nullptr );
}

} // namespace pliant::test
