#pragma once

// Plastic bodies at the limits of their settings, dropped or shaken in empty space: the energy they have afterwards.

#include "support/energy_of_motion.h"
#include "support/explicit_material.h"
#include "support/test_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

namespace pliant::test {

struct PlasticScene
{
	Material material = test::explicitMaterial();
	int coarseLevels = 0;
	bool isThin = false;   ///< a plate of one cell; else a cube of 4 cells
	bool isDropped = true; ///< from .3 m; else shaken: each node at its own random velocity
	double speed = 10.0;   ///< m/s, if shaken
	unsigned seed = 0;
};

/// Returns the scene of an index: a random corner of the ranges.
inline PlasticScene plasticScene( unsigned seed )
{
	std::mt19937 random( seed * 7919u + 1u );
	const auto pick = [&random]( std::initializer_list<float> of ) { return *( of.begin() + random() % of.size() ); };
	PlasticScene scene;
	Material& m = scene.material;
	m.yieldStrain = pick( { 0.001f, 0.02f, 0.2f } );
	m.plasticCreep = pick( { 0.1f, 10.0f, 1e3f, 1e4f } );
	m.plasticLimit = pick( { 0.05f, 0.5f, 1.9f, 2.0f } );
	m.beta = pick( { 0.0f, 0.5f, 0.95f } );
	m.volumeKeeping = pick( { 0.0f, 0.5f, 2.0f } );
	m.damping = pick( { 0.0f, 10.0f, 1e3f } );
	m.wobbleDamping = pick( { 0.0f, 0.15f, 1.0f } );
	m.youngsModulus = pick( { 1e3f, 2e4f, 1e6f, 1e7f } );
	m.regionHalfWidth = int( pick( { 1.0f, 1.0f, 2.0f, 4.0f } ) );
	m.elasticity = random() % 2 == 0 ? Elasticity::Explicit : Elasticity::Implicit;
	scene.coarseLevels = int( pick( { 0.0f, 0.0f, 1.0f, 2.0f } ) );
	scene.isThin = random() % 4 == 0;
	scene.isDropped = random() % 2 == 0;
	scene.speed = double( pick( { 2.0f, 10.0f, 30.0f } ) );
	scene.seed = seed;
	return scene;
}

struct PlasticEnergy
{
	double brought = 0.0;          ///< energy of the fall or of the shaking, J
	double most = 0.0, last = 0.0; ///< kinetic energy, J: maximum over all frames, and over the last second
	bool isHealthy = false;
};

inline PlasticEnergy run( const PlasticScene& scene, int seconds )
{
	SoftWorld t;
	if ( scene.isDropped )
	{
		t.addBoxFloor();
	}
	else
	{
		t.world.setGravity( btVector3( 0, 0, 0 ) );
	}
	Adaptivity adaptivity;
	adaptivity.coarseLevels = scene.coarseLevels;
	const auto shape = scene.isThin ? boxTemplate( { 0.6f, 0.6f, 0.15f }, 0.15f ) : cubeTemplate( 0.6f, 4 );
	SoftBody* const body = t.add(
		shape, btVector3( 0, btScalar( scene.isDropped ? 0.6 : 3.0 ), 0 ), scene.material, btQuaternion::getIdentity(), adaptivity );
	PlasticEnergy energy;
	if ( !body )
	{
		return energy;
	}
	body->setActivationState( DISABLE_DEACTIVATION );
	std::mt19937 random( scene.seed );
	std::uniform_real_distribution<double> fraction( -0.5, 0.5 );
	for ( int i = 0; i < body->nodeCount() && !scene.isDropped; ++i )
	{
		const btVector3 direction( btScalar( fraction( random ) ), btScalar( fraction( random ) ), btScalar( fraction( random ) ) );
		EXPECT_TRUE( body->applyImpulse( btScalar( scene.speed ) * body->nodeMass( i ) * direction, i ).ok() );
	}
	// From the floor to the lowest possible height of the centre.
	energy.brought = scene.isDropped ? double( body->mass() ) * 9.81 * 0.6 : energyOfMotion( *body );
	for ( int second = 0; second < seconds; ++second )
	{
		energy.last = 0.0;
		for ( int frame = 0; frame < 60; ++frame )
		{
			t.step( 1 );
			energy.last = std::max( energy.last, energyOfMotion( *body ) );
		}
		energy.most = std::max( energy.most, energy.last );
	}
	energy.isHealthy = body->isHealthy();
	return energy;
}

/// Returns the bound of the kinetic energy of a body without damping, as a ratio to its initial energy. Where the energy at half steps is
/// all kinetic, the ratio is 1 / ( 1 - alpha / 4 ) in the explicit step. The implicit one with numericalDamping 1 loses energy.
inline double mostFraction( const PlasticScene& scene )
{
	return scene.material.elasticity == Elasticity::Explicit && !scene.isDropped ? 4.0 / 3.0 : 1.001;
}

} // namespace pliant::test
