// Rays and swept balls from all sides compared with the drawn surface of whole, bent and cracked bodies.

#include "experiments/experiments.h"
#include "support/explicit_material.h"

#include "lattice/test_meshes.h"
#include "support/surface_queries.h"
#include "support/test_world.h"

#include <cstdio>

namespace pliant::experiment {

namespace {

constexpr float kCell = 0.1f;

SoftBodyResult bar( bool isCracked )
{
	LatticeSettings settings;
	settings.cellSize = kCell;
	Material material = test::explicitMaterial();
	material.youngsModulus = 3e4f;
	const test::Mesh mesh = test::makeBox( { -0.8, -0.2, -0.2 }, { 0.8, 0.2, 0.2 }, 8 );
	SoftBodyResult made = SoftBody::create( BodyTemplate::build( mesh.view(), settings ).value, btTransform::getIdentity(), material );
	if ( isCracked )
	{
		made.value->cutPlane( btVector3( btScalar( 0.03 ), btScalar( 0.2 ), 0 ), btVector3( 1, 0, 0 ), btScalar( 0.25 ) );
	}
	return made;
}

void print( const char* what, const char* how, const test::QueryTally& tally )
{
	std::printf( "%-8s %-6s %6d %6d %10d %14.4f %10.2f %6d\n", what, how, tally.asked, tally.hits, tally.different,
		tally.worstDistance / double( kCell ), tally.worstAngle, tally.wrongNodes );
}

} // namespace

void raysExperiment( int count )
{
	std::puts( "body     asked    of   meet  different  worst, cells  degrees  nodes" );
	for ( const char* const what : { "ball", "bent", "cracked" } )
	{
		test::WorldOf<SoftBodyWorld> t;
		LatticeSettings settings;
		settings.cellSize = kCell;
		const test::Mesh sphere = test::makeSphere( 0.5, 24, 48 );
		SoftBodyResult made = what[2] == 'l'
			? SoftBody::create( BodyTemplate::build( sphere.view(), settings ).value, btTransform::getIdentity() )
			: bar( what[0] == 'c' );
		t.shapes.push_back( std::make_unique<btBoxShape>( btVector3( btScalar( 0.1 ), btScalar( 0.5 ), 1 ) ) );
		btCollisionObject stand;
		stand.setCollisionShape( t.shapes.back().get() );
		stand.setWorldTransform(
			btTransform( btQuaternion::getIdentity(), btVector3( 0, what[2] == 'l' ? btScalar( -1.05 ) : btScalar( -0.75 ), 0 ) ) );
		t.world.addCollisionObject( &stand );
		t.world.addSoftBody( made.value.get() );
		for ( int frame = 0; frame < 40; ++frame )
		{
			t.world.stepSimulation( btScalar( 1 ) / 60, 0 );
		}
		print( what, "rays", test::castRays( t.world, *made.value, count, 1 ) );
		print( what, "balls", test::sweepBalls( t.world, *made.value, count, 2 ) );
		t.world.removeCollisionObject( &stand );
		made.value.reset();
	}
}

} // namespace pliant::experiment
