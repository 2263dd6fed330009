#pragma once

// A soft cube of .6 m and 6 cells pressed flat by a plate, or in a slot between two walls closer than its width.

#include "support/energy_of_motion.h"
#include "support/explicit_material.h"
#include "support/strain_energy.h"
#include "support/test_world.h"

#include <algorithm>
#include <cstdio>

namespace pliant::test {

struct Squeeze
{
	bool isSlot = false;
	double gap = 0.09; ///< m
	Elasticity elasticity = Elasticity::Explicit;
	double youngsModulus = 5e4;
	int coarseLevels = 0;
	float yieldStrain = 0.0f;
	double seconds = 2.0; ///< duration of the squeeze
};

struct Squeezed
{
	double early = 0.0, late = 0.0; ///< largest impulse of all contacts in a step, N s: in the first half, and in the last second
	double strain = 0.0;            ///< elastic energy at the release, J; with levels or plasticity that of a cube of linear springs
	double out = 0.0;               ///< bound of the energy from pushing all nodes out at the maximum rate, J
	double motion = 0.0;            ///< maximum kinetic energy after the release, J
	double top = 0.0;               ///< greatest height of the centre, m
	bool isHealthy = false;
};

inline double impulses( btDispatcher& dispatcher )
{
	double sum = 0.0;
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			sum += double( manifold.getContactPoint( k ).getAppliedImpulse() );
		}
	}
	return sum;
}

/// Adds the walls of a slot, or a plate that has come down on a body `edge` m high.
inline std::vector<btRigidBody*> press( SoftWorld& t, const Squeeze& how, double edge )
{
	constexpr double kPressing = 0.5 / 60; // m per frame
	std::vector<btRigidBody*> pressing;
	if ( how.isSlot )
	{
		for ( const double side : { -1.0, 1.0 } )
		{
			pressing.push_back(
				t.add( 0, new btBoxShape( btVector3( 1, 1, 1 ) ), btVector3( btScalar( side * ( 1.0 + how.gap / 2 ) ), 1, 0 ) ) );
		}
	}
	else
	{
		btRigidBody* const plate = t.add(
			0, new btBoxShape( btVector3( 2, btScalar( 0.2 ), 2 ) ), btVector3( 0, btScalar( edge + 0.25 ), 0 ) );
		plate->setCollisionFlags( plate->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
		plate->setActivationState( DISABLE_DEACTIVATION );
		pressing.push_back( plate );
		for ( double y = edge + 0.05; y > how.gap; )
		{
			y = std::max( how.gap, y - kPressing );
			plate->setWorldTransform( btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( y + 0.2 ), 0 ) ) );
			t.step( 1 );
		}
	}
	return pressing;
}

inline Squeezed squeeze( const Squeeze& how )
{
	constexpr double kEdge = 0.6; // m
	SoftWorld t;
	t.addBoxFloor();
	t.world.setMaxSoftSubsteps( 64 ); // all elastic energy is then in the regions
	Material material = test::explicitMaterial();
	material.elasticity = how.elasticity;
	material.youngsModulus = float( how.youngsModulus );
	material.yieldStrain = how.yieldStrain;
	Adaptivity adaptivity;
	adaptivity.coarseLevels = how.coarseLevels;
	adaptivity.refinesOnContact = how.coarseLevels > 0;
	SoftBody* const body = t.add(
		cubeTemplate( float( kEdge ), 6 ), btVector3( 0, btScalar( kEdge / 2 ), 0 ), material, btQuaternion::getIdentity(), adaptivity );
	body->setActivationState( DISABLE_DEACTIVATION );
	const StrainEnergy rest( *body, kEdge / 6, 1.0 );
	const std::vector<btRigidBody*> pressing = press( t, how, kEdge );
	Squeezed result;
	const int frames = int( 60.0 * how.seconds );
	for ( int frame = 0; frame < frames; ++frame )
	{
		t.step( 1 );
		const double now = impulses( *t.world.getDispatcher() );
		result.early = frame < frames / 2 ? std::max( result.early, now ) : result.early;
		result.late = frame >= frames - 60 ? std::max( result.late, now ) : result.late;
	}
	const double reached = double( body->stiffnessPlan().reachedModulus ), cell = kEdge / 6,
				 fraction = 1.0 - std::max( 0.0, how.gap - cell ) / kEdge;
	// E = alpha rho d^2 mu / h^2, mu = 2 / 3, and k = alpha / h^2.
	result.strain = how.coarseLevels == 0 && how.yieldStrain == 0.0f
		? rest.at( StrainEnergy::positions( *body, 0.0 ) ) * reached / ( double( material.density ) * cell * cell * 2.0 / 3.0 )
		: 0.5 * reached * kEdge * kEdge * kEdge * fraction * fraction;
	result.out = 0.5 * double( body->mass() ) * 4.0;
	for ( btRigidBody* const each : pressing )
	{
		t.world.removeRigidBody( each );
	}
	for ( int frame = 0; frame < 120; ++frame )
	{
		t.step( 1 );
		result.motion = std::max( result.motion, energyOfMotion( *body ) );
		result.top = std::max( result.top, double( body->massCentre().y() ) );
	}
	result.isHealthy = body->isHealthy();
	for ( btRigidBody* const each : pressing )
	{
		t.world.addRigidBody( each );
	}
	std::printf(
		"%s of %.2f m, %s, E %.0e, %d levels, yield %.2f, %.0f s: impulse a step %.0f N s in the first half, %.0f at last; let go %.0f J "
		"of %.0f + %.0f, up to %.2f m\n",
		how.isSlot ? "slot" : "plate", how.gap, how.elasticity == Elasticity::Implicit ? "implicit" : "explicit", how.youngsModulus,
		how.coarseLevels, double( how.yieldStrain ), how.seconds, result.early, result.late, result.motion, result.strain, result.out,
		result.top );
	return result;
}

} // namespace pliant::test
