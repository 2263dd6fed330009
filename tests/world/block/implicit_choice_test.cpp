// Elasticity::Automatic: which bodies take the implicit step, and that the change is invisible.

#include "world/test_world.h"

#include "world/bodies/soft_body_impl.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

Material automatic( float youngsModulus, Elasticity elasticity = Elasticity::Automatic )
{
	Material material = test::stiff( youngsModulus );
	material.elasticity = elasticity;
	return material;
}

std::vector<Vec3> positions( const SoftBody& body )
{
	const NodeState& nodes = body.impl().body->nodes();
	std::vector<Vec3> all;
	for ( int i = 0; i < nodes.count; ++i )
	{
		all.push_back( nodes.worldPosition( i ).cast<float>() );
	}
	return all;
}

TEST( Automatic, KeepsSoftBodiesWithLightLoadsBitIdentical )
{
	std::vector<Vec3> found[2];
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Automatic } )
	{
		TestWorld t;
		t.addFloor();
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.5 ), 0 ), automatic( 1e5f, elasticity ) );
		t.addBox( 20, btVector3( 0.1f, 0.1f, 0.1f ), at( btScalar( 0.1 ), btScalar( 1.2 ), 0 ) );
		for ( int frame = 0; frame < 60; ++frame )
		{
			t.run( 1 );
			EXPECT_EQ( t.world.stepReport().implicitBodies, 0 );
			EXPECT_FALSE( cube->stepsImplicitly() );
		}
		found[elasticity == Elasticity::Automatic ? 1 : 0] = positions( *cube );
	}
	EXPECT_EQ( found[0], found[1] );
}

// The load of a soft body is that of the whole body, not of the nodes that touch.
TEST( Automatic, CountsTheWholeMassOfASoftLoad )
{
	TestWorld t;
	t.addFloor();
	const auto shape = block( 6, 6, 6, 0.1f );
	SoftBody* const cube = t.addSoft( shape, at( 0, btScalar( 0.3 ), 0 ), automatic( 1e5f ) );
	SoftBody* const load = t.addSoft( shape, at( 0, btScalar( 0.9 ), 0 ), automatic( 1e5f ) );
	double heaviest = 0.0;
	for ( int frame = 0; frame < 20; ++frame )
	{
		t.run( 1 );
		heaviest = std::max( heaviest, cube->impl().elasticity.heaviestLoad );
	}
	EXPECT_NEAR( heaviest / double( load->mass() ), 1.0, 1e-6 );
}

TEST( Automatic, TakesTheImplicitStepWhereStiffnessIsOutOfReach )
{
	// alpha at a 240th of a second is 1 at 3.84e5 Pa
	for ( const bool isStiff : { false, true } )
	{
		TestWorld t;
		t.addFloor();
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.31 ), 0 ), automatic( isStiff ? 3.9e5f : 3.8e5f ) );
		t.run( 1 );
		EXPECT_EQ( cube->stepsImplicitly(), isStiff );
		EXPECT_EQ( t.world.stepReport().substeps, isStiff ? 1 : 4 );
		EXPECT_TRUE( cube->stiffnessPlan().reachable );
	}
	// Two cells thick with regions five wide, a body is four times as stiff as its alpha: the explicit step is stable up to 3.5.
	for ( const int cells : { 2, 8 } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		Material material = automatic( 1.1e6f ); // alpha 0.95
		material.regionHalfWidth = 2;
		SoftBody* body = t.addSoft( block( cells, 8, 8, 0.1f ), at( 0, 0, 0 ), material );
		t.run( 1 );
		EXPECT_EQ( body->stepsImplicitly(), cells == 2 );
	}
}

// A fragment of one cell cannot step implicitly, and must not raise the substeps of the bodies it broke off from to sixteen.
TEST( Automatic, ASingleNodeNeedsNoSubsteps )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit, Elasticity::Automatic } )
	{
		TestWorld t;
		t.addFloor();
		SoftBody* crumb = t.addSoft( block( 1, 1, 1, 0.1f ), at( 2, btScalar( 0.2 ), 0 ), automatic( 3.9e6f, elasticity ) );
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.31 ), 0 ), automatic( 3.9e6f ) );
		ASSERT_EQ( crumb->nodeCount(), 1 );
		t.run( 1 );
		const bool isExplicit = elasticity == Elasticity::Explicit;
		EXPECT_TRUE( cube->stepsImplicitly() );
		EXPECT_EQ( t.world.stepReport().substeps, isExplicit ? 13 : 1 ); // sqrt( 3.9 / 3.84 ) * 4 * sqrt( 10 ), rounded up
		EXPECT_EQ( t.world.stepReport().unreachableStiffness, 0 );
		t.run( 59 );
		EXPECT_NEAR( crumb->nodePosition( 0 ).y(), crumb->nodeRadius( 0 ), 2e-3 );
	}
}

TEST( Automatic, TakesTheImplicitStepUnderAHeavyLoadAndGoesBackAfterwards )
{
	TestWorld t;
	t.addPlane();
	const float modulus = 3.5e5f;
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.301 ), 0 ), automatic( modulus ) );
	SoftBody* other = t.addSoft( block( 6, 6, 6, 0.1f ), at( 5, btScalar( 0.301 ), 0 ), automatic( modulus ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	other->setActivationState( DISABLE_DEACTIVATION );
	t.run( 60 );
	EXPECT_FALSE( cube->stepsImplicitly() );
	btRigidBody* box = t.addBox( 1000, btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( 0.903 ), 0 ) );
	box->setActivationState( DISABLE_DEACTIVATION );
	t.run( 6 );
	EXPECT_TRUE( cube->stepsImplicitly() ); // from the mass on it, long before the impulses of the nodes show it
	double most = 0.0;
	for ( int frame = 0; frame < 600; ++frame )
	{
		t.run( 1 );
		most = frame > 500 ? std::max( most, double( box->getLinearVelocity().length() ) ) : 0.0;
	}
	EXPECT_TRUE( cube->stepsImplicitly() );
	EXPECT_FALSE( other->stepsImplicitly() ); // in another island
	EXPECT_LT( most, 1e-3 );
	double theory = 0.0; // of the five layers of material between the outermost nodes
	for ( int k = 1; k <= 5; ++k )
	{
		theory += 0.1 * 10.0 * ( 1000.0 + 36.0 * k ) / 0.36 / double( modulus );
	}
	std::printf( "sinks by %.4f of %.4f m\n", 0.5 - test::heightOf( *cube ), theory );
	EXPECT_NEAR( ( 0.5 - test::heightOf( *cube ) ) / theory, 1.0, 0.03 );

	t.world.removeRigidBody( box );
	t.rigid.erase( std::find_if( t.rigid.begin(), t.rigid.end(), [&]( const auto& own ) { return own.get() == box; } ) );
	t.run( 90 );
	EXPECT_TRUE( cube->stepsImplicitly() ); // not immediately
	t.run( 120 );
	EXPECT_FALSE( cube->stepsImplicitly() );
}

// A cube of 5e4 Pa among many boxes at a material set by the game: its substeps moved the whole heap, at 2.3 times Bullet's time.
TEST( Automatic, TakesTheImplicitStepInLargeHeaps )
{
	struct Case
	{
		int boxes;
		bool isBrittle, isImplicit;
	};
	for ( const Case& one : { Case{ 5, false, false }, Case{ 64, false, true }, Case{ 64, true, false } } )
	{
		TestWorld t;
		t.addFloor();
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.301 ), 0 ), automatic( 5e4f ) );
		SoftBody* other = t.addSoft( block( 6, 6, 6, 0.1f ), at( -4, btScalar( 0.301 ), 0 ), automatic( 5e4f ) );
		if ( one.isBrittle )
		{
			Fracture fracture;
			fracture.rule = BreakRule::Plane;
			fracture.breakStrain = 5.0f;
			ASSERT_TRUE( cube->setFracture( fracture ).ok() );
		}
		const btScalar half = btScalar( 0.1 );
		for ( int k = 0; k < one.boxes; ++k )
		{
			const double along = 0.405 + 0.202 * ( k % 8 ), up = 0.101 + 0.202 * ( k / 8 );
			t.addBox( 1, btVector3( half, half, half ), at( btScalar( along ), btScalar( up ), 0 ) );
		}
		EXPECT_TRUE( cube->setVelocities( btVector3( 1, 0, 0 ), btVector3( 0, 0, 0 ) ).ok() );
		t.run( 30 );
		EXPECT_EQ( cube->stepsImplicitly(), one.isImplicit ) << one.boxes << " boxes";
		EXPECT_FALSE( other->stepsImplicitly() );
	}
}

// A face of 36 nodes of a kilogram and ten iterations bear 360 kg; half of that is enough to keep the implicit step.
TEST( Automatic, KeepsTheImplicitStepUnderAReducedLoad )
{
	for ( const bool wasHeavier : { false, true } )
	{
		TestWorld t;
		t.addPlane();
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.301 ), 0 ), automatic( 3.5e5f ) );
		cube->setActivationState( DISABLE_DEACTIVATION );
		btRigidBody* box = t.addBox(
			wasHeavier ? btScalar( 400 ) : btScalar( 270 ), btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( 0.903 ), 0 ) );
		box->setActivationState( DISABLE_DEACTIVATION );
		t.run( 120 );
		EXPECT_EQ( cube->stepsImplicitly(), wasHeavier );
		btVector3 inertia;
		box->getCollisionShape()->calculateLocalInertia( 270, inertia );
		box->setMassProps( 270, inertia );
		t.run( 240 );
		EXPECT_EQ( cube->stepsImplicitly(), wasHeavier );
	}
}

TEST( Automatic, IgnoresTheMassOfTheGround )
{
	TestWorld t;
	t.addPlane();
	t.addBox( 1000, btVector3( 0.4f, 0.2f, 0.4f ), at( 0, btScalar( 0.2 ), 0 ) );
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.702 ), 0 ), automatic( 3.5e5f ) );
	for ( int frame = 0; frame < 120; ++frame )
	{
		t.run( 1 );
		EXPECT_FALSE( cube->stepsImplicitly() ) << frame;
	}
	EXPECT_NEAR( cube->massCentre().y(), 0.7, 0.02 );
}

TEST( Automatic, TakesTheImplicitStepInStacksByTheLoadOfTheirNodes )
{
	TestWorld t;
	t.addFloor();
	const auto shape = block( 6, 6, 6, 0.1f );
	std::vector<SoftBody*> cubes;
	for ( int k = 0; k < 3; ++k ) // four of 3e5 Pa buckle under their own weight
	{
		cubes.push_back( t.addSoft( shape, at( 0, btScalar( 0.301 + 0.6 * k ), 0 ), automatic( 3e5f ) ) );
	}
	t.run( 1 );
	EXPECT_FALSE( cubes[0]->stepsImplicitly() );
	t.run( 60 );
	for ( const SoftBody* cube : cubes )
	{
		EXPECT_TRUE( cube->stepsImplicitly() ); // one island
	}
	t.run( 300 );
	for ( const SoftBody* cube : cubes )
	{
		EXPECT_EQ( cube->getActivationState(), ISLAND_SLEEPING );
	}
}

// Momentum and shape are state of the nodes and are kept; contact impulses are scaled with the length of the substep.
TEST( Automatic, AChangeOfTheStepIsInvisible )
{
	TestWorld t;
	t.addFloor();
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.301 ), 0 ), automatic( 3.5e5f, Elasticity::Explicit ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	btRigidBody* box = t.addBox( 200, btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( 0.901 ), 0 ) );
	box->setActivationState( DISABLE_DEACTIVATION );
	t.run( 400 );
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		const btScalar before = box->getWorldTransform().getOrigin().y();
		ASSERT_TRUE( cube->setMaterial( automatic( 3.5e5f, elasticity ) ).ok() );
		double fastest = 0.0, moved = 0.0;
		for ( int frame = 0; frame < 120; ++frame )
		{
			t.run( 1 );
			fastest = std::max( fastest, double( box->getLinearVelocity().length() ) );
			moved = std::max( moved, std::abs( double( box->getWorldTransform().getOrigin().y() - before ) ) );
		}
		std::printf( "to %s: box moves by %.2e m at up to %.2e m/s\n", elasticity == Elasticity::Implicit ? "implicit" : "explicit", moved,
			fastest );
		EXPECT_LT( moved, 1e-3 );
		EXPECT_LT( fastest, 1e-2 );
	}
}

TEST( Automatic, SaysWhyABodyStepsExplicitly )
{
	TestWorld t;
	t.addFloor();
	Adaptivity levels;
	levels.coarseLevels = 1;
	SoftBody* adaptive = t.addSoft( block( 8, 8, 8, 0.1f ), at( 0, btScalar( 0.41 ), 0 ), automatic( 1e7f ), levels );
	EXPECT_TRUE( adaptive->implicitStatus().ok() );
	Material far = automatic( 1e7f );
	far.farLevels = 1;
	SoftBody* distant = t.addSoft( block( 8, 8, 8, 0.1f ), at( 3, btScalar( 0.41 ), 0 ), far );
	EXPECT_NE( distant->implicitStatus().sentence.find( "farLevels" ), std::string::npos );
	SoftBody* plain = t.addSoft( block( 8, 8, 8, 0.1f ), at( 6, btScalar( 0.41 ), 0 ), automatic( 1e7f ) );
	EXPECT_TRUE( plain->implicitStatus().ok() );
	t.run( 1 );
	EXPECT_TRUE( adaptive->stepsImplicitly() );
	EXPECT_FALSE( distant->stepsImplicitly() );
	EXPECT_TRUE( plain->stepsImplicitly() );
	EXPECT_EQ( t.world.stepReport().implicitBodies, 2 );
}

TEST( Automatic, GivesTheSameBitsForAnyThreadCount )
{
	const auto run = []( int threads ) {
		TestWorld t;
		t.addFloor();
		t.world.setThreadCount( threads );
		const auto shape = block( 4, 4, 4, 0.1f );
		for ( int k = 0; k < 4; ++k )
		{
			t.addSoft( shape, at( btScalar( 0.9 * k ), btScalar( 0.25 ), 0 ), automatic( 3e5f ) );
			t.addBox( btScalar( 50 + 200 * k ), btVector3( 0.2f, 0.2f, 0.2f ), at( btScalar( 0.9 * k + 0.05 ), btScalar( 0.8 ), 0 ) );
		}
		std::vector<Vec3> all;
		int most = 0, least = 4;
		for ( int frame = 0; frame < 120; ++frame )
		{
			t.run( 1 );
			most = std::max( most, t.world.stepReport().implicitBodies );
			least = std::min( least, t.world.stepReport().implicitBodies );
		}
		EXPECT_GT( most, least ); // the number of implicit bodies changes
		for ( const auto& body : t.soft )
		{
			const std::vector<Vec3> own = positions( *body );
			all.insert( all.end(), own.begin(), own.end() );
		}
		return all;
	};
	const auto once = run( 1 );
	EXPECT_EQ( run( 1 ), once );
	EXPECT_EQ( run( 3 ), once );
}

} // namespace
} // namespace pliant
