#pragma once

// Rigid boxes that slide along a soft track, which is pinned at its lower side.

#include "lattice/test_meshes.h"
#include "support/explicit_material.h"
#include "support/test_world.h"

#include <algorithm>
#include <cmath>

namespace pliant::test {

struct SlidingBox
{
	Elasticity elasticity = Elasticity::Implicit;
	double cells = 1.0;        ///< edge of the box, in cells of .1 m; it is .7 times as high
	double speed = 2.0;        ///< m/s
	double friction = 0.3;     ///< combined
	bool isFloorRigid = false; ///< on a rigid box instead
};

/// Returns the distance that the box slides until it stops, over that by theory, v^2 / ( 2 mu g ); without friction the distance of a
/// second over v.
inline double slideOnATrack( const SlidingBox& what )
{
	constexpr float kCell = 0.1f;
	constexpr double kFall = 9.81, kMostLength = 12.0; // m/s^2, m
	const double half = 0.5 * what.cells * double( kCell ), braking = what.friction * kFall;
	const double theory = what.friction > 0.0 ? what.speed * what.speed / ( 2.0 * braking ) : what.speed;
	const auto length = float( std::min( 1.15 * theory + 4.0 * half + 1.0, kMostLength ) );
	const auto width = float( std::max( 0.2, 1.5 * half ) );

	SoftWorld t;
	t.world.setGravity( btVector3( 0, btScalar( -kFall ), 0 ) );
	LatticeSettings settings;
	settings.cellSize = kCell;
	Material material = explicitMaterial( 5e5f );
	material.elasticity = what.elasticity;
	const auto shape = BodyTemplate::build( makeBox( { 0, -0.3f, -width }, { length, 0, width }, 6 ).view(), settings ).value;
	btCollisionObject* floor = nullptr;
	if ( what.isFloorRigid )
	{
		floor = t.add( 0, new btBoxShape( btVector3( 20, 1, 20 ) ), btVector3( 10, -1, 0 ) );
	}
	else
	{
		SoftBody* const track = t.add( shape, btVector3( 0, 0, 0 ), material );
		for ( int node = 0; node < track->nodeCount(); ++node )
		{
			if ( track->nodePosition( node ).y() < btScalar( -0.2 ) && !track->pinNode( node ).ok() )
			{
				return 0.0;
			}
		}
		floor = track;
	}
	floor->setFriction( btScalar( std::sqrt( what.friction ) ) );
	const btVector3 halves( btScalar( half ), btScalar( 0.7 * half ), btScalar( half ) );
	btRigidBody* const box = t.add( btScalar( 300.0 * 0.7 * 8.0 * half * half * half ), new btBoxShape( halves ),
		btVector3( btScalar( 0.3 + half ), btScalar( 0.7 * half + 0.002 ), 0 ) );
	box->setFriction( btScalar( std::sqrt( what.friction ) ) );
	box->setActivationState( DISABLE_DEACTIVATION );
	const auto run = [&t]( double seconds ) {
		for ( int frame = 0; frame < int( 60.0 * seconds ); ++frame )
		{
			t.world.stepSimulation( btScalar( 1 ) / 60, 0 );
		}
	};
	run( 0.7 );
	const btScalar from = box->getWorldTransform().getOrigin().x();
	box->setLinearVelocity( btVector3( btScalar( what.speed ), 0, 0 ) );
	run( what.friction > 0.0 ? 1.3 * what.speed / braking + 0.3 : 1.0 );
	return double( box->getWorldTransform().getOrigin().x() - from ) / theory;
}

} // namespace pliant::test
