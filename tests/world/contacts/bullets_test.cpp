// Fast rigid bodies shot at soft ones: they transfer their momentum and do not pass through, with and without Bullet's continuous
// detection.

#include "world/test_world.h"

#include <cmath>
#include <cstdio>
#include <random>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

/// Surface parameters of both sides.
struct Surface
{
	double friction = 0.5, restitution = 0.0;
};

struct BulletResult
{
	double momentum = 0.0, spin = 0.0; ///< lost or gained, as a ratio to the initial one
	double energy = 0.0;               ///< maximum kinetic energy, as a ratio to the initial one
	bool meets = false, passes = false;
};

/// A ball shot at a block of 6 x 6 x 6 or 8 x 8 x 3 cells, with at most the energy needed to displace the material in its path: E times the
/// swept volume.
class BulletShot
{
public:
	BulletShot( unsigned seed, Elasticity elasticity, const Surface& surface ) : m_random( seed * 7919u + 3u )
	{
		const bool isPlate = seed % 2 == 1;
		m_half = isPlate ? btVector3( btScalar( 0.2 ), btScalar( 0.2 ), btScalar( 0.075 ) )
						 : btVector3( btScalar( 0.3 ), btScalar( 0.3 ), btScalar( 0.3 ) );
		m_world.world.setGravity( btVector3( 0, 0, 0 ) );
		Material material = test::stiff( float( std::pow( 10.0, 4.0 + 2.0 * fraction() ) ) );
		material.elasticity = elasticity;
		material.damping = material.wobbleDamping = 0.0f;
		btTransform transform = at( 0, 0, 0 );
		transform.setRotation( isPlate
				? btQuaternion::getIdentity()
				: btQuaternion( btScalar( fraction() - 0.5 ), btScalar( fraction() - 0.5 ), btScalar( fraction() - 0.5 ), btScalar( 0.5 ) )
					  .normalized() );
		m_soft = m_world.addSoft( isPlate ? block( 8, 8, 3, 0.05f ) : block( 6, 6, 6, 0.1f ), transform, material );

		m_radius = 0.04 + 0.06 * fraction();
		m_speed = 10.0 * std::pow( 10.0, fraction() );
		const double work = double( material.youngsModulus ) * SIMD_PI * m_radius * m_radius * 2.0 * double( m_half.z() );
		m_mass = std::min( 2.0 * fraction() * work / ( m_speed * m_speed ), double( m_soft->mass() ) );
		m_ball = m_world.add( btScalar( m_mass ), new btSphereShape( btScalar( m_radius ) ),
			at( btScalar( 0.3 * fraction() - 0.15 ), btScalar( 0.3 * fraction() - 0.15 ), btScalar( -1.5 - 2.0 * fraction() ) ) );
		if ( fraction() < 0.5 )
		{
			m_ball->setCcdMotionThreshold( btScalar( m_radius ) );
			m_ball->setCcdSweptSphereRadius( btScalar( 0.8 * m_radius ) );
		}
		m_ball->setLinearVelocity( btVector3( 0, 0, btScalar( m_speed ) ) );
		m_ball->setFriction( btScalar( surface.friction ) );
		m_soft->setFriction( btScalar( surface.friction ) );
		m_ball->setRestitution( btScalar( surface.restitution ) );
		m_soft->setRestitution( btScalar( surface.restitution ) );
	}

	BulletResult run()
	{
		const double momentum = m_mass * m_speed, energy = 0.5 * m_mass * m_speed * m_speed;
		const btVector3 spinBefore = spin();
		BulletResult result;
		bool wasInside = false;
		for ( int frame = 0; frame < 40; ++frame )
		{
			const btVector3 from = m_ball->getWorldTransform().getOrigin();
			m_world.run( 1 );
			result.energy = std::max( result.energy, motion() / energy );
			wasInside = wasInside || goesThroughMiddle( from );
		}
		const btVector3 apart = m_ball->getWorldTransform().getOrigin() - m_soft->massCentre();
		result.passes = wasInside && double( apart.z() ) > double( m_half.z() ) + m_radius &&
			m_ball->getLinearVelocity().z() > m_soft->linearVelocity().z();
		const btVector3 lost = m_ball->getLinearVelocity() * btScalar( m_mass ) + m_soft->linearVelocity() * m_soft->mass() -
			btVector3( 0, 0, btScalar( momentum ) );
		result.momentum = double( lost.length() ) / momentum;
		result.spin = double( ( spin() - spinBefore ).length() ) / ( momentum * double( m_half.x() ) );
		result.meets = m_soft->linearVelocity().length() > 0;
		return result;
	}

private:
	double fraction() { return double( m_random() ) / 4294967296.0; }

	bool goesThroughMiddle( const btVector3& from ) const
	{
		const btTransform fit = m_soft->bestFitTransform();
		bool isInside = false;
		for ( int k = 0; k <= 20; ++k )
		{
			const btVector3 x = fit.invXform( from.lerp( m_ball->getWorldTransform().getOrigin(), btScalar( k ) / 20 ) ).absolute() -
				btScalar( 0.6 ) * m_half;
			isInside = isInside || ( x.x() < 0 && x.y() < 0 && x.z() < 0 );
		}
		return isInside;
	}
	btVector3 spin() const ///< about the world's origin
	{
		return m_ball->getWorldTransform().getOrigin().cross( m_ball->getLinearVelocity() * btScalar( m_mass ) ) +
			m_ball->getAngularVelocity() / m_ball->getInvInertiaDiagLocal().x() +
			m_soft->massCentre().cross( m_soft->linearVelocity() * m_soft->mass() ) + m_soft->angularMomentum();
	}
	double motion() const
	{
		double sum = 0.5 * m_mass * double( m_ball->getLinearVelocity().length2() ) +
			0.5 * double( m_ball->getAngularVelocity().length2() / m_ball->getInvInertiaDiagLocal().x() );
		for ( int i = 0; i < m_soft->nodeCount(); ++i )
		{
			sum += 0.5 * double( m_soft->nodeMass( i ) * m_soft->nodeVelocity( i ).length2() );
		}
		return sum;
	}

	std::mt19937 m_random;
	TestWorld m_world;
	SoftBody* m_soft = nullptr;
	btRigidBody* m_ball = nullptr;
	btVector3 m_half;
	double m_mass = 1.0, m_speed = 1.0, m_radius = 0.1;
};

constexpr unsigned kShots = 100;

void shoot( Elasticity elasticity )
{
	double momentum = 0.0, spin = 0.0, energy = 0.0;
	int meets = 0;
	for ( unsigned seed = 0; seed < kShots; ++seed )
	{
		const BulletResult r = BulletShot( seed, elasticity, Surface{} ).run();
		EXPECT_FALSE( r.passes ) << seed;
		EXPECT_LT( r.momentum, 1e-5 ) << seed;
		EXPECT_LT( r.spin, 1e-4 ) << seed;
		EXPECT_LT( r.energy, 1.0001 ) << seed;
		momentum = std::max( momentum, r.momentum );
		spin = std::max( spin, r.spin );
		energy = std::max( energy, r.energy );
		meets += r.meets ? 1 : 0;
	}
	std::printf( "%d of %u meet; momentum %.1e, spin %.1e, energy of motion at most %.5f of what there was\n", meets, kShots, momentum,
		spin, energy );
	EXPECT_GE( meets, int( kShots ) - 1 );
}

TEST( Bullets, TransferMomentumToExplicitBodiesAndDoNotPass )
{
	shoot( Elasticity::Explicit );
}

TEST( Bullets, TransferMomentumToImplicitBodiesAndDoNotPass )
{
	shoot( Elasticity::Implicit );
}

// Shots in which contacts could add energy: repeated bounces of nodes in each substep under pressure (explicit, mostly without friction),
// solutions that end with pulling contacts (implicit), and bounces off velocities that matching has just changed, several of one ball at
// once.
TEST( Bullets, AddNoEnergyForAnyRestitutionAndFriction )
{
	const unsigned hard[] = { 4, 22, 24, 30, 36, 68, 82, 89, 90, 133, 164, 218, 240, 260, 274 };
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const double friction : { 0.0, 0.5 } )
		{
			for ( const double restitution : { 0.0, 0.5, 0.7, 0.9, 1.0 } )
			{
				double energy = 0.0;
				for ( const unsigned seed : hard )
				{
					const BulletResult r = BulletShot( seed, elasticity, Surface{ friction, restitution } ).run();
					EXPECT_LT( r.energy, 1.0001 ) << seed << " friction " << friction << " restitution " << restitution;
					EXPECT_LT( r.momentum, 1e-5 ) << seed;
					energy = std::max( energy, r.energy );
				}
				EXPECT_GT( energy, 0.9 );
			}
		}
	}
}

// A nearly rigid block returns the approach velocity scaled by the restitution.
TEST( Bullets, ReboundFromStiffImplicitBodiesByRestitution )
{
	for ( const double restitution : { 0.5, 0.8 } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		Material material = test::stiff( 1e10f );
		material.elasticity = Elasticity::Implicit;
		SoftBody* soft = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, 0, 0 ), material );
		btRigidBody* ball = t.add( 20, new btSphereShape( btScalar( 0.2 ) ), at( 0, 0, -1 ) );
		ball->setRestitution( 1 );
		soft->setRestitution( btScalar( restitution ) );
		ball->setLinearVelocity( btVector3( 0, 0, 5 ) );
		t.run( 30 );
		const double apart = double( soft->linearVelocity().z() - ball->getLinearVelocity().z() ) / 5.0;
		std::printf( "restitution %.1f: parts at %.3f of the speed it came at\n", restitution, apart );
		EXPECT_NEAR( apart, restitution, 0.02 );
	}
}

} // namespace
} // namespace pliant
