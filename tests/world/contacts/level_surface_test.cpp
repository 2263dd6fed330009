// Bodies with levels show their drawn surface too. Objects of up to a cell fell through the gaps between the spheres of coarse nodes.

#include "support/marbles.h"
#include "test_meshes.h"
#include "world/test_world.h"

#include <cmath>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

constexpr float kLevelCell = 0.1f; // m

struct LevelCase
{
	int coarseLevels;
	bool refines;
	Elasticity elasticity;
};

std::vector<LevelCase> levelCases()
{
	std::vector<LevelCase> all;
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		for ( const int levels : { 1, 2 } )
		{
			all.push_back( { levels, false, elasticity } );
			all.push_back( { levels, true, elasticity } );
		}
	}
	return all;
}

SoftBody* addWithLevels( TestWorld& t, const test::Mesh& mesh, const btVector3& centre, const LevelCase& what )
{
	LatticeSettings settings;
	settings.cellSize = kLevelCell;
	Material material = test::stiff( 5e5f );
	material.elasticity = what.elasticity;
	Adaptivity levels;
	levels.coarseLevels = what.coarseLevels;
	levels.refinesOnContact = what.refines;
	return t.addSoft(
		BodyTemplate::build( mesh.view(), settings ).value, btTransform( btQuaternion::getIdentity(), centre ), material, levels );
}

// Radii of a tenth of a cell to a cell, on a block whose coarse nodes are of 2 and of 4 cells.
TEST( LevelSurface, CarriesMarblesAndSmallBoxes )
{
	for ( const LevelCase& what : levelCases() )
	{
		for ( const btScalar radius : { btScalar( 0.01 ), btScalar( 0.02 ), btScalar( 0.05 ), btScalar( 0.1 ) } )
		{
			TestWorld t;
			t.addPlane();
			addWithLevels( t, test::makeBox( { -0.8, -0.4, -0.8 }, { 0.8, 0.4, 0.8 }, 6 ), btVector3( 0, btScalar( 0.4 ), 0 ), what );
			const test::MarblesAndBoxes things( radius, btScalar( 0.281 ), btScalar( 0.293 ), btScalar( 0.81 ),
				[&t]( btScalar mass, btCollisionShape* shape, const btVector3& position ) {
					return t.add( mass, shape, at( position.x(), position.y(), position.z() ) );
				} );
			t.run( 120 );
			int lying = 0;
			for ( int k = 0; k < things.count(); ++k )
			{
				const double most = things.isBox( k ) ? 0.15 : 0.1; // cells: a few boxes lie on an edge
				lying += std::abs( double( things.bottom( k ) ) - 0.8 ) < most * double( kLevelCell ) ? 1 : 0;
			}
			EXPECT_EQ( lying, 25 ) << "levels " << what.coarseLevels << ", refines " << what.refines << ", step " << int( what.elasticity )
								   << ", radius " << radius;
		}
	}
}

// A ball is curved everywhere: each coarse node has patches of several cells, which belong to one sphere.
TEST( LevelSurface, IsThatOfACurvedBody )
{
	constexpr double kRadius = 0.6, kMarble = 0.02;
	for ( const LevelCase& what : levelCases() )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* const soft = addWithLevels( t, test::makeSphere( kRadius, 40, 80 ), btVector3( 0, 0, 0 ), what );
		std::vector<btRigidBody*> marbles;
		for ( int k = 0; k < 12; ++k )
		{
			const double angle = 2.4 * k, aside = 0.045 * k;
			marbles.push_back( t.add( btScalar( 1e-3 ), new btSphereShape( btScalar( kMarble ) ),
				at( btScalar( aside * std::cos( angle ) ), btScalar( kRadius + 0.08 ), btScalar( aside * std::sin( angle ) ) ) ) );
			marbles.back()->setLinearFactor( btVector3( 0, 1, 0 ) );
			marbles.back()->setLinearVelocity( btVector3( 0, btScalar( -0.5 ), 0 ) );
			marbles.back()->setGravity( btVector3( 0, -5, 0 ) );
			marbles.back()->setFriction( 0 );
		}
		soft->setFriction( 0 );
		t.run( 120 );
		for ( const btRigidBody* const marble : marbles )
		{
			const double gap = double( ( marble->getWorldTransform().getOrigin() - soft->massCentre() ).length() ) - kRadius - kMarble;
			EXPECT_NEAR( gap, 0.0, 0.1 * double( kLevelCell ) )
				<< "levels " << what.coarseLevels << ", refines " << what.refines << ", step " << int( what.elasticity ) << ", "
				<< marble->getWorldTransform().getOrigin().x();
		}
	}
}

} // namespace
} // namespace pliant
