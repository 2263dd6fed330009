// Elasticity::Implicit: heavy loads on soft bodies, slopes, stacks and collisions at the game's own step.

#include "world/test_world.h"

#include "world/bodies/soft_body_impl.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::implicit;
using test::kGravity;
using test::TestWorld;

/// Returns the mean height of a layer of a cube of 6 cells; nodes are ordered by z, then y, then x.
double layer( const SoftBody& cube, int y )
{
	double sum = 0.0;
	for ( int k = 0; k < 36; ++k )
	{
		sum += double( cube.nodePosition( k / 6 * 36 + 6 * y + k % 6 ).y() ) / 36.0;
	}
	return sum;
}

struct Loaded
{
	double strain = 0.0, theory = 0.0, tilt = 0.0, penetration = 0.0, speed = 0.0;
	bool sleeps = false;
	int substeps = 0;
};

/// A box `ratio` times as heavy rests on a cube of 216 kg; the modulus allows a compression of a tenth.
Loaded load( double ratio, int halfWidth )
{
	TestWorld t;
	t.addPlane();
	const double weight = kGravity * 216.0, area = 0.36, modulus = ratio * weight / area / 0.1;
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), implicit( float( modulus ), halfWidth ) );
	btRigidBody* box = t.addBox( btScalar( ratio * 216.0 ), btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( 0.901 ), 0 ) );
	Loaded loaded;
	for ( int frame = 0; frame < 400; ++frame )
	{
		t.run( 1 );
		loaded.substeps = std::max( loaded.substeps, t.world.stepReport().substeps );
		loaded.speed = frame == 300 ? double( box->getLinearVelocity().length() ) : loaded.speed;
	}
	// Between the layers' centres: the box and the layers above.
	for ( int k = 0; k < 5; ++k )
	{
		loaded.theory += 0.1 * ( ratio + ( 5.0 - k ) / 6.0 ) * weight / area / modulus;
	}
	loaded.strain = 0.5 - ( layer( *cube, 5 ) - layer( *cube, 0 ) );
	loaded.tilt = double( btAcos( btMin( btScalar( 1 ), box->getWorldTransform().getBasis()[1].y() ) ) ) * 180.0 / SIMD_PI;
	for ( int i = 0; i < cube->nodeCount(); ++i )
	{
		const btVector3 inBox = box->getWorldTransform().invXform( cube->nodePosition( i ) );
		const btScalar intoBox = btFabs( inBox.x() ) < btScalar( 0.3 ) && btFabs( inBox.z() ) < btScalar( 0.3 )
			? inBox.y() + btScalar( 0.3 ) + cube->nodeRadius( i )
			: btScalar( 0 );
		loaded.penetration = std::max(
			{ loaded.penetration, double( intoBox ), double( cube->nodeRadius( i ) - cube->nodePosition( i ).y() ) } );
	}
	loaded.sleeps = cube->getActivationState() == ISLAND_SLEEPING && box->getActivationState() == ISLAND_SLEEPING;
	return loaded;
}

class ImplicitWidth : public testing::TestWithParam<int>
{};

TEST_P( ImplicitWidth, CarriesABoxOfAnyMassByTheoryAndSleeps )
{
	for ( const double ratio : { 1.0, 10.0, 100.0, 1000.0 } )
	{
		const Loaded loaded = load( ratio, GetParam() );
		std::printf(
			"w %d 1:%-4.0f strain %.4f of %.4f (%+.1f %%), tilt %.2f deg, penetration %.5f m, speed after 5 s %.1e m/s, substeps %d\n",
			GetParam(), ratio, loaded.strain / 0.5, loaded.theory / 0.5, 100.0 * ( loaded.strain / loaded.theory - 1.0 ), loaded.tilt,
			loaded.penetration, loaded.speed, loaded.substeps );
		EXPECT_NEAR( loaded.strain / loaded.theory, 1.0, GetParam() == 1 ? 0.02 : 0.11 ) << ratio;
		EXPECT_LT( loaded.tilt, 0.5 ) << ratio;
		EXPECT_LT( loaded.penetration, 0.002 ) << ratio;
		EXPECT_LT( loaded.speed, 1e-3 ) << ratio;
		EXPECT_TRUE( loaded.sleeps ) << ratio;
		EXPECT_EQ( loaded.substeps, 1 );
	}
}

INSTANTIATE_TEST_SUITE_P( OneAndTwo, ImplicitWidth, testing::Values( 1, 2 ) );

/// Returns the acceleration down a slope of 20 degrees over the third and fourth second, m/s^2.
double slide( double friction, float youngsModulus )
{
	TestWorld t;
	const double slope = 20.0 / 180.0 * SIMD_PI;
	t.world.setGravity( btVector3( btScalar( 9.81 * std::sin( slope ) ), btScalar( -9.81 * std::cos( slope ) ), 0 ) );
	t.addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) )->setFriction( 1 );
	Material material = implicit( youngsModulus );
	material.density = 1000.0f / 216.0f; // 1 kg
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), material );
	cube->setFriction( btScalar( friction ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	t.run( 120 );
	const btScalar before = cube->linearVelocity().x();
	t.run( 120 );
	return double( cube->linearVelocity().x() - before ) / 2.0;
}

TEST( Implicit, SlidesLikeARigidBoxHoweverStiffAndHoldsAtTheFrictionAngle )
{
	const double slope = 20.0 / 180.0 * SIMD_PI;
	const double wanted = 9.81 * ( std::sin( slope ) - 0.25 * std::cos( slope ) );
	for ( const float youngsModulus : { 3e2f, 1e4f, 1e6f } )
	{
		const double got = slide( 0.25, youngsModulus );
		std::printf( "E %.0e: %.4f of %.4f m/s^2\n", double( youngsModulus ), got, wanted );
		EXPECT_NEAR( got / wanted, 1.0, 0.03 );
	}
	// tan 19.5 = 0.354, tan 20.5 = 0.374
	EXPECT_GT( slide( 0.354, 1e5f ), 0.05 );
	EXPECT_NEAR( slide( 0.374, 1e5f ), 0.0, 0.002 );
}

TEST( Implicit, CarriesStacksOfRigidBoxes )
{
	for ( const float youngsModulus : { 6e4f, 1e6f } )
	{
		TestWorld t;
		t.addFloor();
		Material material = implicit( youngsModulus );
		material.density = 1000.0f / 216.0f; // 1 kg under 50
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), material );
		std::vector<btRigidBody*> boxes;
		for ( int k = 0; k < 5; ++k )
		{
			boxes.push_back( t.addBox( 10, btVector3( 0.3f, 0.15f, 0.3f ), at( 0, btScalar( 0.752 + 0.302 * k ), 0 ) ) );
		}
		t.run( 300 );
		EXPECT_EQ( cube->getActivationState(), ISLAND_SLEEPING ) << youngsModulus;
		for ( std::size_t k = 1; k < boxes.size(); ++k )
		{
			const btVector3 step = boxes[k]->getWorldTransform().getOrigin() - boxes[k - 1]->getWorldTransform().getOrigin();
			EXPECT_NEAR( step.y(), 0.3, 1e-3 ) << youngsModulus;
			EXPECT_GT( boxes[k]->getWorldTransform().getBasis()[1].y(), btScalar( 0.9999 ) );
		}
	}
}

struct Sums
{
	Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero();
	double energy = 0.0;

	void add( double mass, const Vec3d& x, const Vec3d& v )
	{
		momentum += mass * v;
		spin += mass * x.cross( v );
		energy += 0.5 * mass * v.squaredNorm();
	}
};

Sums sumsOf( const TestWorld& t )
{
	Sums sums;
	for ( const auto& body : t.soft )
	{
		const NodeState& nodes = body->impl().body->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			sums.add( double( nodes.mass[i] ), nodes.worldPosition( i ), nodes.v.get( i ).cast<double>() );
		}
	}
	for ( const auto& body : t.rigid )
	{
		sums.add( 1.0 / double( body->getInvMass() ), toVec3d( body->getCenterOfMassPosition() ), toVec3d( body->getLinearVelocity() ) );
		const Vec3d spin = toVec3d( body->getInvInertiaTensorWorld().inverse() * body->getAngularVelocity() );
		sums.spin += spin;
		sums.energy += 0.5 * spin.dot( toVec3d( body->getAngularVelocity() ) );
	}
	return sums;
}

TEST( Implicit, CollisionsKeepMomentumAndAddNoEnergy )
{
	for ( const double ratio : { 0.1, 5.0, 0.0 } )
	{
		for ( const float youngsModulus : { 3e3f, 3e7f } )
		{
			TestWorld t;
			t.world.setGravity( btVector3( 0, 0, 0 ) );
			Material material = implicit( youngsModulus );
			material.damping = material.wobbleDamping = material.numericalDamping = 0.0f;
			t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, 0, 0 ), material );
			const btVector3 speed( 4, 0, 0 ), turn( 0, 1, 2 );
			if ( ratio > 0.0 )
			{
				btRigidBody* box = t.addBox(
					btScalar( ratio * 216.0 ), btVector3( 0.2f, 0.2f, 0.2f ), at( -1, btScalar( 0.15 ), btScalar( 0.1 ) ) );
				box->setLinearVelocity( speed );
				box->setAngularVelocity( turn );
			}
			else
			{
				EXPECT_TRUE( t.addSoft( block( 4, 4, 4, 0.1f ), at( -1, btScalar( 0.15 ), btScalar( 0.1 ) ), material )
								 ->setVelocities( speed, turn )
								 .ok() );
			}
			const Sums before = sumsOf( t );
			double most = 0.0;
			for ( int frame = 0; frame < 120; ++frame )
			{
				t.run( 1 );
				most = std::max( most, sumsOf( t ).energy );
			}
			const Sums after = sumsOf( t );
			EXPECT_LT( ( after.momentum - before.momentum ).norm() / before.momentum.norm(), 1e-5 ) << ratio;
			EXPECT_LT( ( after.spin - before.spin ).norm() / before.spin.norm(), 1e-4 ) << ratio;
			EXPECT_LE( most, before.energy * 1.0001 ) << ratio;
			EXPECT_LT( after.energy, 0.999 * before.energy ) << ratio; // they did touch
		}
	}
}

TEST( Implicit, ContactPointsHoldTheSolvedImpulses )
{
	TestWorld t;
	t.addPlane();
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), implicit( 1e6f ) );
	cube->setActivationState( DISABLE_DEACTIVATION );
	t.run( 200 );
	double sum = 0.0;
	for ( int m = 0; m < t.parts.dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *t.parts.dispatcher.getManifoldByIndexInternal( m );
		EXPECT_GT( manifold.getContactProcessingThreshold(), 0 ); // visible to Bullet again
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			sum += double( manifold.getContactPoint( k ).m_appliedImpulse );
		}
	}
	EXPECT_NEAR( sum / ( 216.0 * kGravity / 60.0 ), 1.0, 5e-3 );
}

// A fast body is met before it touches; the contact must close the gap and not keep it open.
TEST( Implicit, FallingBodiesCloseTheGap )
{
	TestWorld t;
	t.addFloor();
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 1.3 ), 0 ), implicit( 1e7f ) );
	btRigidBody* box = t.addBox( 500, btVector3( 0.3f, 0.1f, 0.3f ), at( 0, 3, 0 ) );
	t.run( 300 );
	EXPECT_NEAR( test::lowestNode( *cube ) - cube->nodeRadius( 0 ), 0, 2e-4 );
	EXPECT_NEAR( box->getWorldTransform().getOrigin().y() - 0.1 - layer( *cube, 5 ) - cube->nodeRadius( 0 ), 0, 2e-4 );
}

TEST( Implicit, BouncesByRestitution )
{
	const auto highest = []( btScalar restitution ) {
		TestWorld t;
		t.addFloor()->setRestitution( 1 );
		Material material = implicit( 1e7f );
		material.damping = 50.0f;
		SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( 1.2 ), 0 ), material );
		cube->setRestitution( restitution );
		btScalar high = 0;
		for ( int frame = 0; frame < 90; ++frame )
		{
			t.run( 1 );
			high = frame > 35 ? btMax( high, cube->massCentre().y() ) : btScalar( 0 );
		}
		return double( high ) - 0.2;
	};
	const double dead = highest( 0 ), lively = highest( btScalar( 0.8 ) );
	std::printf( "dropped by 1 m, back to %.2f m with restitution 0, %.2f m with 0.8\n", dead, lively );
	EXPECT_GT( lively, dead + 0.2 );
	EXPECT_LT( lively, 1.0 );
}

TEST( Implicit, HoldsPinnedNodesAndBodiesThatStepExplicitly )
{
	TestWorld t;
	t.addFloor();
	// A shelf held at one end, with a soft explicit cube on it.
	SoftBody* shelf = t.addSoft( block( 12, 2, 4, 0.1f ), at( 0, 1, 0 ), implicit( 2e8f ) );
	EXPECT_EQ( shelf->pinNodesInside( btVector3( -1, 0, -1 ), btVector3( btScalar( -0.5 ), 2, 1 ) ), 8 );
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( btScalar( 0.2 ), btScalar( 1.26 ), 0 ), test::stiff( 5e4f ) );
	t.run( 300 );
	EXPECT_GT( cube->massCentre().y(), btScalar( 1.15 ) );
	EXPECT_NEAR( shelf->nodePosition( 0 ).y(), 0.95, 1e-4 );
	EXPECT_GT( t.world.stepReport().substeps, 0 );
	EXPECT_LT( cube->linearVelocity().length(), btScalar( 0.02 ) );
}

// A body that has fallen asleep must not keep its index in a system that belongs to another island.
TEST( Implicit, ASleepingBodyTakesNoPartInAnotherIsland )
{
	std::vector<Vec3> positions[2];
	for ( const bool isThere : { false, true } )
	{
		TestWorld t;
		t.addFloor();
		SoftBody* sleeper = t.addSoft( block( 6, 6, 6, 0.1f ), at( -5, btScalar( 0.3 ), 0 ), implicit( 1e5f ) );
		btRigidBody* onSleeper = t.addBox( 100, btVector3( 0.3f, 0.1f, 0.3f ), at( -5, btScalar( 0.701 ), 0 ) );
		SoftBody* waking = t.addSoft( block( 6, 6, 6, 0.1f ), at( 5, btScalar( 0.4 ), 0 ), implicit( 1e5f ) );
		t.addBox( 50, btVector3( 0.2f, 0.1f, 0.2f ), at( btScalar( 5.05 ), btScalar( 0.9 ), 0 ) );
		t.run( 30 );
		sleeper->forceActivationState( ISLAND_SLEEPING );
		onSleeper->forceActivationState( ISLAND_SLEEPING );
		if ( !isThere )
		{
			t.world.removeSoftBody( sleeper );
			t.world.removeRigidBody( onSleeper );
		}
		t.run( 30 );
		EXPECT_TRUE( waking->isActive() );
		EXPECT_EQ( isThere && sleeper->isActive(), false );
		for ( int i = 0; i < waking->nodeCount(); ++i )
		{
			positions[isThere ? 1 : 0].push_back( waking->impl().body->nodes().x.get( i ) );
		}
	}
	// Removal changes the order of Bullet's manifolds, and so the iteration, which ends where impulses are right to a hundredth.
	float apart = 0.0f;
	for ( std::size_t i = 0; i < positions[0].size(); ++i )
	{
		apart = std::max( apart, ( positions[0][i] - positions[1][i] ).norm() );
	}
	std::printf( "largest difference %.1e m\n", double( apart ) );
	EXPECT_LT( apart, 1e-3f );
}

TEST( Implicit, GivesTheSameBitsEachTimeAndForAnyThreadCount )
{
	const auto run = []( int threads ) {
		TestWorld t;
		t.addFloor();
		t.world.setThreadCount( threads );
		const auto shape = block( 4, 4, 4, 0.1f );
		for ( int k = 0; k < 4; ++k )
		{
			t.addSoft(
				shape, at( btScalar( 0.9 * ( k % 2 ) ), btScalar( 0.25 + 0.5 * ( k / 2 ) ), btScalar( 0.05 * k ) ), implicit( 1e6f ) );
			t.addBox( 500, btVector3( 0.1f, 0.1f, 0.1f ), at( btScalar( 0.9 * ( k % 2 ) ), btScalar( 1.5 + 0.3 * ( k / 2 ) ), 0 ) );
		}
		t.run( 100 );
		std::vector<btScalar> bits;
		for ( const auto& body : t.soft )
		{
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				bits.insert( bits.end(), { body->nodePosition( i ).x(), body->nodePosition( i ).y(), body->nodePosition( i ).z() } );
			}
		}
		return bits;
	};
	const auto once = run( 1 );
	EXPECT_EQ( run( 1 ), once );
	EXPECT_EQ( run( 3 ), once );
}

} // namespace
} // namespace pliant
