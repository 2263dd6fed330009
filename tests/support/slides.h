#pragma once

// Boxes that slide along a soft track, which is pinned at its lower side.

#include "lattice/test_meshes.h"
#include "support/explicit_material.h"
#include "support/test_world.h"

#include <algorithm>
#include <cmath>

namespace pliant::test {

struct SlidingBox
{
	Elasticity elasticity = Elasticity::Implicit; ///< of the track and of a soft box
	double cells = 1.0;                           ///< edge of the box, in cells of the track, .1 m; it is .7 times as high
	double speed = 2.0;                           ///< m/s
	double friction = 0.3;                        ///< combined
	bool isFloorRigid = false;                    ///< on a rigid box instead
	double ownCell = 0.0;                         ///< cell size of a soft box, m; 0: a rigid box
	int coarseLevels = 0;                         ///< of the track
	bool refines = false;                         ///< the track, where the box touches it: borders of levels move with the box
};

/// One such box, which has come to rest at the beginning of a track.
class SlidingTrack
{
public:
	static constexpr double kFall = 9.81; // m/s^2

	/// `farthest`: distance that the box will slide at most, m.
	SlidingTrack( const SlidingBox& what, double farthest ) : m_half( 0.5 * what.cells * double( kCell ) )
	{
		m_scene.world.setGravity( btVector3( 0, btScalar( -kFall ), 0 ) );
		btCollisionObject* const floor = what.isFloorRigid ? addFloor() : addTrack( what, farthest );
		btCollisionObject* const box = what.ownCell > 0.0 ? addSoftBox( what ) : addRigidBox();
		for ( btCollisionObject* const object : { floor, box } )
		{
			object->setFriction( btScalar( std::sqrt( what.friction ) ) );
		}
		box->setActivationState( DISABLE_DEACTIVATION );
		run( 0.7 );
	}

	void setSpeed( double speed )
	{
		const btVector3 velocity( btScalar( speed ), 0, 0 );
		if ( m_rigid )
		{
			m_rigid->setLinearVelocity( velocity );
			return;
		}
		static_cast<void>( m_soft->setVelocities( velocity, btVector3( 0, 0, 0 ) ) );
	}

	double position() const { return double( m_rigid ? m_rigid->getWorldTransform().getOrigin().x() : m_soft->massCentre().x() ); }

	/// Tilts the track by `angle`, rad, downwards in the direction of motion.
	void tilt( double angle )
	{
		m_scene.world.setGravity( btVector3( btScalar( kFall * std::sin( angle ) ), btScalar( -kFall * std::cos( angle ) ), 0 ) );
	}

	void run( double seconds )
	{
		for ( int frame = 0; frame < int( 60.0 * seconds ); ++frame )
		{
			m_scene.world.stepSimulation( btScalar( 1 ) / 60, 0 );
		}
	}

private:
	static constexpr float kCell = 0.1f;

	btCollisionObject* addFloor() { return m_scene.add( 0, new btBoxShape( btVector3( 20, 1, 20 ) ), btVector3( 10, -1, 0 ) ); }

	btCollisionObject* addTrack( const SlidingBox& what, double farthest )
	{
		constexpr double kMostLength = 12.0; // m
		const auto length = float( std::min( farthest + 4.0 * m_half + 1.0, kMostLength ) );
		const auto width = float( std::max( { 0.2, 1.5 * m_half, std::ldexp( double( kCell ), what.coarseLevels ) } ) );
		LatticeSettings settings;
		settings.cellSize = kCell;
		Adaptivity levels;
		levels.coarseLevels = what.coarseLevels;
		levels.refinesOnContact = what.refines;
		// Two rows and two layers of the coarsest nodes, of which the lower one is pinned.
		const float depth = what.coarseLevels > 0 ? std::ldexp( 2.0f * kCell, what.coarseLevels ) : 3.0f * kCell;
		Material material = explicitMaterial( 5e5f );
		material.elasticity = what.elasticity;
		SoftBody* const track = m_scene.add(
			BodyTemplate::build( makeBox( { 0, -depth, -width }, { length, 0, width }, 6 ).view(), settings ).value, btVector3( 0, 0, 0 ),
			material, btQuaternion::getIdentity(), levels );
		for ( int node = 0; node < track->nodeCount(); ++node )
		{
			if ( track->nodePosition( node ).y() < -0.5f * depth )
			{
				static_cast<void>( track->pinNode( node ) );
			}
		}
		return track;
	}

	btCollisionObject* addRigidBox()
	{
		const btVector3 halves( btScalar( m_half ), btScalar( 0.7 * m_half ), btScalar( m_half ) );
		m_rigid = m_scene.add( btScalar( 300.0 * 0.7 * 8.0 * m_half * m_half * m_half ), new btBoxShape( halves ), start() );
		return m_rigid;
	}

	btCollisionObject* addSoftBox( const SlidingBox& what )
	{
		LatticeSettings settings;
		settings.cellSize = float( what.ownCell );
		Material material = explicitMaterial( 5e5f );
		material.elasticity = what.elasticity;
		material.density = 300.0f;
		const auto half = float( m_half );
		m_soft = m_scene.add(
			BodyTemplate::build( makeBox( { -half, -0.7f * half, -half }, { half, 0.7f * half, half }, 6 ).view(), settings ).value,
			start(), material );
		return m_soft;
	}

	btVector3 start() const { return btVector3( btScalar( 0.3 + m_half ), btScalar( 0.7 * m_half + 0.002 ), 0 ); }

	SoftWorld m_scene;
	double m_half;
	btRigidBody* m_rigid = nullptr;
	SoftBody* m_soft = nullptr;
};

/// Returns the distance that the box slides until it stops, over that by theory, v^2 / ( 2 mu g ); without friction the distance of a
/// second over v.
inline double slideOnATrack( const SlidingBox& what )
{
	const double braking = what.friction * SlidingTrack::kFall;
	const double theory = what.friction > 0.0 ? what.speed * what.speed / ( 2.0 * braking ) : what.speed;
	SlidingTrack track( what, 1.15 * theory );
	const double from = track.position();
	track.setSpeed( what.speed );
	track.run( what.friction > 0.0 ? 1.3 * what.speed / braking + 0.3 : 1.0 );
	return ( track.position() - from ) / theory;
}

/// Returns how far a box that was at rest slides in two seconds on a track that is steeper than the angle of friction by `degrees` (or,
/// below 0, less steep), over the distance by theory at one degree above, g ( sin a - mu cos a ) t^2 / 2.
inline double slideOnASlope( const SlidingBox& what, double degrees )
{
	constexpr double kDegree = 3.14159265358979 / 180.0, kSeconds = 2.0;
	const double limit = std::atan( what.friction ), above = limit + kDegree;
	const double theory = 0.5 * SlidingTrack::kFall * ( std::sin( above ) - what.friction * std::cos( above ) ) * kSeconds * kSeconds;
	SlidingTrack track( what, 2.0 * theory );
	const double from = track.position();
	track.tilt( limit + degrees * kDegree );
	track.run( kSeconds );
	return ( track.position() - from ) / theory;
}

} // namespace pliant::test
