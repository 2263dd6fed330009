// Sheets one cell thick show objects the surface on either side. Marbles of less than .4 cells fell between the nodes' spheres.

#include "support/marbles.h"
#include "test_meshes.h"
#include "world/test_world.h"

#include <cmath>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

constexpr float kSheetCell = 0.1f; // m

/// A horizontal sheet, its upper side at 0, with a pinned rim and a pinned middle.
SoftBody* addSheet( TestWorld& t, double thickness, Elasticity elasticity )
{
	LatticeSettings settings;
	settings.cellSize = kSheetCell;
	Material material = test::stiff( 2e6f );
	material.elasticity = elasticity;
	SoftBody* const sheet = t.addSoft(
		BodyTemplate::build( test::makeBox( { -0.8, -thickness, -0.8 }, { 0.8, 0, 0.8 }, 6 ).view(), settings ).value, at( 0, 0, 0 ),
		material );
	for ( int node = 0; node < sheet->nodeCount(); ++node )
	{
		const btVector3 aside = sheet->nodePosition( node ).absolute();
		const btScalar farthest = btMax( aside.x(), aside.z() );
		if ( farthest > btScalar( 0.7 ) || farthest < btScalar( 0.1 ) )
		{
			EXPECT_TRUE( sheet->pinNode( node ).ok() );
		}
	}
	return sheet;
}

TEST( ThinSurface, CarriesMarblesAndSmallBoxes )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		for ( const double thickness : { 0.05, 0.1 } )
		{
			for ( const btScalar radius : { btScalar( 0.01 ), btScalar( 0.02 ), btScalar( 0.05 ) } )
			{
				TestWorld t;
				const SoftBody* const sheet = addSheet( t, thickness, elasticity );
				const test::MarblesAndBoxes things( radius, btScalar( 0.221 ), btScalar( 0.233 ), btScalar( 0.01 ),
					[&t]( btScalar mass, btCollisionShape* shape, const btVector3& position ) {
						return t.add( mass, shape, at( position.x(), position.y(), position.z() ) );
					} );
				t.run( 90 );
				int lying = 0;
				for ( int k = 0; k < things.count(); ++k )
				{
					const btScalar surface = sheet->nodePosition( sheet->nearestNode( things.centre( k ) ) ).y() +
						btScalar( 0.5 * thickness );
					lying += std::abs( double( things.bottom( k ) - surface ) ) < 0.15 * double( kSheetCell ) ? 1 : 0; // it is curved there
				}
				EXPECT_EQ( lying, 25 ) << "step " << int( elasticity ) << ", thickness " << thickness << ", radius " << radius;
			}
		}
	}
}

// What hits a sheet from below stays below: the face on the object's side counts.
TEST( ThinSurface, IsOnTheObjectsSide )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		for ( const btScalar speed : { btScalar( 1 ), btScalar( 5 ), btScalar( 10 ) } )
		{
			TestWorld t;
			addSheet( t, 0.1, elasticity );
			btRigidBody* const marble = t.add(
				btScalar( 0.01 ), new btSphereShape( btScalar( 0.015 ) ), at( btScalar( 0.36 ), -1, btScalar( 0.33 ) ) );
			marble->setGravity( btVector3( 0, 0, 0 ) );
			marble->setLinearVelocity( btVector3( 0, speed, 0 ) );
			btScalar highest = -1;
			for ( int frame = 0; frame < 120; ++frame )
			{
				t.run( 1 );
				highest = btMax( highest, marble->getWorldTransform().getOrigin().y() );
			}
			EXPECT_LT( highest, btScalar( -0.05 ) ) << int( elasticity ) << " " << speed;
			EXPECT_GT( highest, btScalar( -0.2 ) ) << int( elasticity ) << " " << speed;
		}
	}
}

} // namespace
} // namespace pliant
