#pragma once

// Soft cubes of .6 m that are created inside another object: whether and how fast they come out.

#include "support/energy_of_motion.h"
#include "support/explicit_material.h"
#include "support/test_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::test {

enum class Inside
{
	Floor,     ///< penetrating it by `depth`
	StaticBox, ///< of 1 m, at its centre
	Cube       ///< another soft cube at the distance `depth`
};

struct PutInside
{
	Inside what = Inside::Floor;
	double depth = 0.1; ///< m
	Elasticity elasticity = Elasticity::Explicit;
	double youngsModulus = 1e6;
	bool isRotated = false;
	int coarseLevels = 0;
};

struct CameOut
{
	double fastest = 0.0; ///< speed of a centre of mass, m/s, in 200 frames
	double highest = 0.0; ///< height of a centre of mass, m
	double nearest = 0.0; ///< after three seconds: least distance of node centres from the other object's surface or nodes, in node radii
	bool isHealthy = true;
};

/// Returns the least distance of the node centres from a floor at 0, a box around `centre` or the other body's nodes, in node radii.
inline double nearestOf( const SoftBody& body, const PutInside& how, const btVector3& centre, const SoftBody* other )
{
	btScalar least = SIMD_INFINITY;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		const btVector3 at = body.nodePosition( i ), off = ( at - centre ).absolute() - btVector3( 0.5, 0.5, 0.5 );
		const btScalar radius = body.nodeRadius( i );
		if ( how.what == Inside::Floor )
		{
			least = std::min( least, at.y() / radius );
		}
		else if ( how.what == Inside::StaticBox )
		{
			least = std::min( least, off[off.maxAxis()] / radius );
		}
		for ( int k = 0; other && k < other->nodeCount(); ++k )
		{
			least = std::min( least, ( other->nodePosition( k ) - at ).length() / ( radius + other->nodeRadius( k ) ) );
		}
	}
	return double( least );
}

inline CameOut putInside( const PutInside& how )
{
	SoftWorld t;
	t.addBoxFloor();
	Material material = test::explicitMaterial();
	material.elasticity = how.elasticity;
	material.youngsModulus = float( how.youngsModulus );
	Adaptivity adaptivity;
	adaptivity.coarseLevels = how.coarseLevels;
	const auto shape = cubeTemplate( 0.6f, 6 );
	const btQuaternion turn = how.isRotated ? btQuaternion( btVector3( 0, 1, 0 ), btScalar( 0.5 ) ) : btQuaternion::getIdentity();
	const btVector3 centre( 0, 1, 0 );
	std::vector<SoftBody*> bodies;
	if ( how.what == Inside::StaticBox )
	{
		t.add( 0, new btBoxShape( btVector3( 0.5, 0.5, 0.5 ) ), centre );
		bodies.push_back( t.add( shape, centre, material, turn, adaptivity ) );
	}
	else
	{
		bodies.push_back(
			t.add( shape, btVector3( 0, btScalar( how.what == Inside::Floor ? 0.3 - how.depth : 0.3 ), 0 ), material, turn, adaptivity ) );
	}
	if ( how.what == Inside::Cube )
	{
		bodies.push_back(
			t.add( shape, btVector3( btScalar( how.depth ), btScalar( 0.3 ), 0 ), material, btQuaternion::getIdentity(), adaptivity ) );
	}
	CameOut out;
	for ( int frame = 0; frame < 200; ++frame )
	{
		t.step( 1 );
		for ( const SoftBody* body : bodies )
		{
			// Afterwards the body falls off the box faster than it was pushed out.
			out.fastest = frame < 60 || how.what != Inside::StaticBox ? std::max( out.fastest, double( body->linearVelocity().length() ) )
																	  : out.fastest;
			out.highest = std::max( out.highest, double( body->massCentre().y() ) );
			out.isHealthy = out.isHealthy && body->isHealthy();
		}
		out.nearest = frame == 179 ? nearestOf( *bodies[0], how, centre, how.what == Inside::Cube ? bodies[1] : nullptr ) : out.nearest;
	}
	std::printf( "%s, %.2f m, %s, E %.0e, %s, %d levels: %.2f m/s at most, up to %.2f m; after 3 s %.2f radii apart\n",
		how.what == Inside::Floor      ? "sunk into a floor"
			: how.what == Inside::Cube ? "another cube"
									   : "a static box",
		how.depth, how.elasticity == Elasticity::Implicit ? "implicit" : "explicit", how.youngsModulus,
		how.isRotated ? "turned" : "aligned", how.coarseLevels, out.fastest, out.highest, out.nearest );
	return out;
}

} // namespace pliant::test
