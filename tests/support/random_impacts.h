#pragma once

// Random impacts of soft bodies without damping and gravity. The same seed gives the same impacts on every machine.

#include "support/energy_of_motion.h"
#include "support/explicit_material.h"
#include "support/test_world.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace pliant::test {

/// Random numbers that are the same on every machine (the standard's distributions are not).
class Random
{
public:
	explicit Random( unsigned seed ) : m_engine( seed ) {}
	btScalar between( double low, double high ) { return btScalar( low + ( high - low ) * double( m_engine() ) / 4294967296.0 ); }
	btVector3 within( double size ) { return { between( -size, size ), between( -size, size ), between( -size, size ) }; }
	btQuaternion turn() { return { within( 1 ).normalized(), between( 0, 3 ) }; }
	int upTo( int count ) { return int( m_engine() % unsigned( count ) ); }

private:
	std::mt19937 m_engine;
};

inline Material undamped( float youngsModulus, Elasticity elasticity )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = youngsModulus;
	material.damping = 0.0f;
	material.elasticity = elasticity;
	return material;
}

/// Of all bodies, fragments included.
inline double energyOfMotion( SoftWorld& world )
{
	double sum = 0.0;
	for ( int i = 0; i < world.world.softBodyCount(); ++i )
	{
		sum += energyOfMotion( *world.world.softBody( i ) );
	}
	for ( const auto& body : world.rigid )
	{
		sum += body->getInvMass() > 0 ? energyOfMotion( *body ) : 0.0;
	}
	return sum;
}

enum class Ground : int
{
	Floor,
	Box,
	Soft,
	SoftWithLevels
};
inline constexpr const char* kGroundNames[] = { "floor", "rigid box", "soft cube", "soft cube with levels" };

/// The striking cubes, of 6 and of 8 cells an edge: in the first, nodes of level 1 or 2 are half empty.
inline const std::shared_ptr<const BodyTemplate>& strikingCube( int size )
{
	static const std::shared_ptr<const BodyTemplate> cubes[] = { cubeTemplate( 0.6f, 6 ), cubeTemplate( 0.8f, 8 ) };
	return cubes[size];
}

/// Adds the body that is struck. Returns it if soft, else null.
inline SoftBody* addGround( SoftWorld& world, Ground ground, const btQuaternion& turn, const Material& material, const Adaptivity& levels )
{
	if ( ground == Ground::Floor )
	{
		world.addBoxFloor();
		return nullptr;
	}
	if ( ground == Ground::Box )
	{
		btRigidBody* const box = world.add(
			300, new btBoxShape( btVector3( btScalar( 0.5 ), btScalar( 0.2 ), btScalar( 0.5 ) ) ), btVector3( 0, btScalar( -0.2 ), 0 ) );
		box->setFriction( 1 );
		box->setRestitution( 1 );
		return nullptr;
	}
	return world.add(
		strikingCube( 1 ), btVector3( 0, btScalar( -0.7 ), 0 ), material, turn, ground == Ground::Soft ? Adaptivity{} : levels );
}

/// Adds a body that approaches at `speed` m/s; every other one spins.
inline SoftBody* addStriking(
	SoftWorld& world, Random& random, const Material& material, const Adaptivity& levels, double fastest, double slowest )
{
	const int size = random.upTo( 2 );
	const btScalar aside = random.between( -0.3, 0.3 );
	SoftBody* const body = world.add( strikingCube( size ), btVector3( aside, btScalar( 0.95 ), 0 ), material, random.turn(), levels );
	const btVector3 spin = random.upTo( 2 ) == 0 ? btVector3( 0, 0, 0 ) : random.within( 3 );
	static_cast<void>( body->setVelocities( btVector3( 0, random.between( fastest, slowest ), 0 ), spin ) );
	return body;
}

/// Gives all soft bodies random friction and restitution. Returns the maximum of the kinetic energy, as a ratio to the initial one.
inline double mostEnergy( SoftWorld& world, Random& random )
{
	const btScalar restitution = std::max( btScalar( 0 ), random.between( -1, 1 ) ), friction = random.between( 0, 1 );
	for ( const auto& each : world.soft )
	{
		each->setRestitution( restitution );
		each->setFriction( friction );
	}
	const double first = energyOfMotion( world );
	double most = 0.0;
	for ( int frame = 0; frame < 80; ++frame )
	{
		world.step( 1 );
		most = std::max( most, energyOfMotion( world ) / first );
	}
	return most;
}

/// Strikes with a cube of nodes of level 1 or 2. Returns the maximum energy as a ratio to the initial one. `strain`: if above 0, all nodes
/// split at this strain and for no other reason.
inline double strike( Ground ground, Elasticity elasticity, unsigned seed, float strain = 0.0f )
{
	Random random( seed );
	SoftWorld world;
	world.world.setGravity( btVector3( 0, 0, 0 ) );
	const float moduli[] = { 1e4f, 1e5f, 1e6f, 3e6f, 1e7f, 1e8f };
	const Material material = undamped( moduli[random.upTo( 6 )], elasticity );
	Adaptivity levels;
	levels.coarseLevels = 1 + random.upTo( 2 );
	levels.mergeDelay = 0.05f;
	levels.refinesOnContact = random.upTo( 2 ) == 0 && strain == 0.0f;
	levels.refineStrain = levels.refinesOnContact ? 0.0f : strain > 0.0f ? strain : 0.05f;
	addGround( world, ground, random.turn(), material, levels );
	addStriking( world, random, material, levels, -8, -1 );
	return mostEnergy( world, random );
}

struct Shattered
{
	double most = 0.0; ///< maximum kinetic energy, as a ratio to the initial one
	bool hasBroken = false;
};

/// The same with a cube that breaks at a strain of .02 to .3, with levels where `coarseLevels` is above 0: faster, and soft ground breaks
/// as well.
inline Shattered shatter( Ground ground, Elasticity elasticity, BreakRule rule, int coarseLevels, unsigned seed )
{
	Random random( seed );
	SoftWorld world;
	world.world.setGravity( btVector3( 0, 0, 0 ) );
	const float moduli[] = { 1e4f, 1e5f, 1e6f, 3e6f, 1e7f };
	const Material material = undamped( moduli[random.upTo( 5 )], elasticity );
	Adaptivity levels;
	levels.coarseLevels = coarseLevels;
	levels.mergeDelay = 0.05f;
	levels.refinesOnContact = random.upTo( 2 ) == 0 && coarseLevels > 0;
	levels.refineStrain = levels.refinesOnContact || coarseLevels == 0 ? 0.0f : 0.05f;
	Fracture fracture;
	fracture.rule = rule;
	fracture.breakStrain = float( random.between( 0.02, 0.3 ) );
	SoftBody* const under = addGround( world, ground, random.turn(), material, levels );
	SoftBody* const body = addStriking( world, random, material, levels, -12, -2 );
	for ( SoftBody* each : { body, under } )
	{
		if ( each )
		{
			static_cast<void>( each->setFracture( fracture ) );
		}
	}
	const int whole = world.world.softBodyCount();
	const double most = mostEnergy( world, random );
	return Shattered{ most, world.world.softBodyCount() > whole };
}

inline btVector3 spinOf( const SoftWorld& world )
{
	btVector3 spin( 0, 0, 0 );
	for ( const auto& body : world.soft )
	{
		spin += body->angularMomentum() + body->mass() * body->massCentre().cross( body->linearVelocity() );
	}
	return spin;
}

struct Rubbed
{
	double lost = 0.0; ///< lost angular momentum, as a ratio to the sum of the bodies' initial spins
	double most = 0.0; ///< maximum energy, as a ratio to the initial one
};

/// Two to four spinning cubes collide.
inline Rubbed rub( bool ( *isImplicit )( int body ), unsigned seed )
{
	static const auto cube = cubeTemplate( 0.4f, 4 );
	Random random( seed );
	SoftWorld world;
	world.world.setGravity( btVector3( 0, 0, 0 ) );
	const int count = 2 + random.upTo( 3 );
	const btScalar speed = random.between( 1, 5 ), friction = random.between( 0, 1 );
	for ( int k = 0; k < count; ++k )
	{
		const btScalar angle = SIMD_2_PI * btScalar( k ) / btScalar( count );
		const btVector3 at( btScalar( 0.7 ) * std::cos( angle ), random.between( -0.1, 0.1 ), btScalar( 0.7 ) * std::sin( angle ) );
		SoftBody* const body = world.add(
			cube, at, undamped( 1e5f, isImplicit( k ) ? Elasticity::Implicit : Elasticity::Explicit ), random.turn() );
		static_cast<void>( body->setVelocities( -speed * at.normalized(), random.within( 5 ) ) );
		body->setFriction( friction );
	}
	double own = 0.0;
	for ( const auto& body : world.soft )
	{
		own += double( body->angularMomentum().length() );
	}
	const btVector3 before = spinOf( world );
	const double first = energyOfMotion( world );
	Rubbed rubbed;
	for ( int frame = 0; frame < 60; ++frame )
	{
		world.step( 1 );
		rubbed.most = std::max( rubbed.most, energyOfMotion( world ) / first );
	}
	rubbed.lost = double( ( spinOf( world ) - before ).length() ) / own;
	return rubbed;
}

} // namespace pliant::test
