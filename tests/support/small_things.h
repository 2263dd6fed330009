#pragma once

// Small objects thrown at soft blocks: those that have sunk in a second later.

#include "lattice/test_meshes.h"
#include "support/explicit_material.h"
#include "support/surface_queries.h"
#include "support/test_world.h"

#include <pliant/soft_body_world.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace pliant::test {

enum class Struck : int
{
	Whole,
	Loaded,
	Cracked,
	Coarse,  ///< on two levels
	Refining ///< on two levels, and refined where something touches
};

struct ThrownThings
{
	int thrown = 0;
	int sunk = 0; ///< number of objects whose centre is below the drawn surface
	int lost = 0; ///< number of those that are more than a tenth of a cell below it
	int sick = 0;
	double deepest = 0.0; ///< largest depth of a centre below the drawn surface, in sizes of the object
};

/// One soft block with objects that fall on it; each has a size of .1 to 2 cells and falls at 0 to 20 m/s.
class ThingsOnABlock
{
public:
	ThingsOnABlock( Struck kind, Elasticity elasticity, unsigned seed ) : m_random( seed )
	{
		LatticeSettings settings;
		settings.cellSize = kCell;
		Material material = test::explicitMaterial();
		material.youngsModulus = 5e5f;
		material.elasticity = elasticity;
		static const std::shared_ptr<const BodyTemplate> shape =
			BodyTemplate::build( makeBox( { -0.6, -0.25, -0.6 }, { 0.6, 0.25, 0.6 }, 6 ).view(), settings ).value;
		Adaptivity levels;
		levels.coarseLevels = kind == Struck::Coarse || kind == Struck::Refining ? 2 : 0;
		levels.refinesOnContact = kind == Struck::Refining;
		m_soft = SoftBody::create( shape, at( 0, btScalar( 0.25 ), 0 ), material, levels ).value;
		m_world.world.addSoftBody( m_soft.get() );
		m_world.addFloor();
		if ( kind == Struck::Loaded )
		{
			const btVector3 half( btScalar( 0.15 ), btScalar( 0.15 ), btScalar( 0.15 ) );
			m_world.add( 1000, new btBoxShape( half ), btVector3( 0, btScalar( 0.66 ), 0 ) );
		}
		else if ( kind == Struck::Cracked )
		{
			m_soft->cutPlane( btVector3( btScalar( 0.02 ), btScalar( 0.5 ), 0 ), btVector3( 1, 0, btScalar( 0.3 ) ), btScalar( 0.35 ) );
			m_soft->cutPlane( btVector3( 0, btScalar( 0.5 ), btScalar( 0.03 ) ), btVector3( btScalar( -0.2 ), 0, 1 ), btScalar( 0.35 ) );
		}
		run( 20 );
	}

	/// Throws eight objects (at nine positions, one of which is the load's), waits for a second, and examines their positions.
	void throwThings( ThrownThings& tally )
	{
		struct Thing
		{
			btRigidBody* body;
			double size;
		};
		std::vector<Thing> things;
		for ( int k = 0; k < 9; ++k )
		{
			const double size = double( kCell ) * real( 0.1, 2.0 );
			const btScalar x = btScalar( ( k % 3 - 1 ) * 0.36 + real( -0.06, 0.06 ) ),
						   z = btScalar( ( k / 3 - 1 ) * 0.36 + real( -0.06, 0.06 ) );
			if ( k == 4 )
			{
				continue; // the position of the load
			}
			btRigidBody* const body = m_world.add( btScalar( 1000.0 * size * size * size ),
				shapeOf( int( m_random() % 4 ), btScalar( size ) ), btVector3( x, btScalar( 0.75 ), z ) );
			const btQuaternion turned(
				btVector3( btScalar( real( -1, 1 ) ), 1, btScalar( real( -1, 1 ) ) ).normalized(), btScalar( real( 0, 3 ) ) );
			body->setWorldTransform( btTransform( turned, body->getWorldTransform().getOrigin() ) );
			body->setInterpolationWorldTransform( body->getWorldTransform() );
			const double speed = real( 0, 20 );
			body->setLinearVelocity(
				btVector3( btScalar( real( -0.1, 0.1 ) * speed ), btScalar( -speed ), btScalar( real( -0.1, 0.1 ) * speed ) ) );
			body->setAngularVelocity( btVector3( btScalar( real( -3, 3 ) ), btScalar( real( -3, 3 ) ), btScalar( real( -3, 3 ) ) ) );
			things.push_back( Thing{ body, size } );
		}
		run( 60 );
		const DrawnTriangles drawn( *m_soft );
		for ( const Thing& thing : things )
		{
			const btVector3 centre = thing.body->getWorldTransform().getOrigin();
			const double depth = drawn.contains( centre ) ? drawn.distance( centre ) / thing.size : 0.0;
			++tally.thrown;
			tally.sunk += depth > 0.05 ? 1 : 0;
			tally.lost += depth * thing.size > 0.1 * double( kCell ) ? 1 : 0;
			tally.deepest = std::max( tally.deepest, depth );
		}
		tally.sick += m_soft->isHealthy() ? 0 : 1;
	}

private:
	static constexpr float kCell = 0.1f;

	static btTransform at( btScalar x, btScalar y, btScalar z ) { return btTransform( btQuaternion::getIdentity(), btVector3( x, y, z ) ); }
	double real( double low, double high ) { return low + ( high - low ) * double( m_random() % 100003U ) / 100003.0; }
	void run( int frames )
	{
		for ( int k = 0; k < frames; ++k )
		{
			m_world.world.stepSimulation( btScalar( 1 ) / 60, 0 );
		}
	}
	/// `size`: the diameter, or the longest edge.
	static btCollisionShape* shapeOf( int kind, btScalar size )
	{
		const btScalar half = size / 2;
		switch ( kind )
		{
			case 0: return new btSphereShape( half );
			case 1: return new btBoxShape( btVector3( half, half * btScalar( 0.7 ), half ) );
			case 2: return new btCapsuleShape( half / 2, half );
			default: {
				auto* const hull = new btConvexHullShape();
				for ( const btVector3& corner : { btVector3( 1, 0, 0 ), btVector3( -1, 0, 0 ), btVector3( 0, 1, 0 ), btVector3( 0, -1, 0 ),
						  btVector3( 0, 0, 1 ), btVector3( 0, 0, -1 ), btVector3( btScalar( 0.6 ), btScalar( 0.6 ), btScalar( 0.6 ) ) } )
				{
					hull->addPoint( corner * half );
				}
				hull->setMargin( half * btScalar( 0.1 ) );
				return hull;
			}
		}
	}
	std::mt19937 m_random;
	WorldOf<SoftBodyWorld> m_world;
	std::unique_ptr<SoftBody> m_soft;
};

/// Throws `count` objects or a few more.
inline ThrownThings throwThings( Struck kind, Elasticity elasticity, int count, unsigned seed )
{
	ThrownThings tally;
	for ( unsigned k = 0; tally.thrown < count; ++k )
	{
		ThingsOnABlock( kind, elasticity, seed + k ).throwThings( tally );
	}
	return tally;
}

} // namespace pliant::test
