// Rigid objects of a tenth to a third of a cell on the top and on the rim of a soft block.

#include "support/surface_queries.h"
#include "test_meshes.h"
#include "world/bodies/soft_body_impl.h"
#include "world/test_world.h"
#include "world/touch/node_touch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

constexpr double kBlockCell = 0.1;

/// A block of 12 x 5 x 12 cells that rests on the floor, its top face at 0.5 m.
SoftBody* addTestBlock( TestWorld& t, Elasticity elasticity )
{
	t.addPlane();
	LatticeSettings settings;
	settings.cellSize = float( kBlockCell );
	Material material = test::stiff( 5e5f );
	material.elasticity = elasticity;
	SoftBody* const block = t.addSoft(
		BodyTemplate::build( test::makeBox( { -0.6, -0.25, -0.6 }, { 0.6, 0.25, 0.6 }, 6 ).view(), settings ).value,
		at( 0, btScalar( 0.25 ), 0 ), material );
	t.run( 30 );
	return block;
}

/// An irregular octahedron of 0.3 cells. Bullet's box around a hull whose margin was changed after its points is wider by that change.
btCollisionShape* hull()
{
	auto* const shape = new btConvexHullShape();
	constexpr btScalar kHalf = btScalar( 0.15 * kBlockCell );
	for ( const btVector3& corner : { btVector3( 1, 0, 0 ), btVector3( -1, 0, 0 ), btVector3( 0, 1, 0 ), btVector3( 0, -1, 0 ),
			  btVector3( 0, 0, 1 ), btVector3( 0, 0, -1 ), btVector3( btScalar( 0.6 ), btScalar( 0.6 ), btScalar( 0.6 ) ) } )
	{
		shape->addPoint( corner * kHalf );
	}
	shape->setMargin( kHalf * btScalar( 0.1 ) );
	return shape;
}

// All nodes around a small box found the same corner of it and pushed that one out; by the next step it had tipped to the other side, and
// so on for ever, up to a tenth of a cell below the surface.
TEST( SmallObjects, BoxesLieOnTheSurface )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		TestWorld t;
		const SoftBody* const soft = addTestBlock( t, elasticity );
		std::vector<btRigidBody*> boxes;
		constexpr btScalar kHalf = btScalar( 0.07 * kBlockCell );
		for ( int k = 0; k < 36; ++k )
		{
			const btScalar x = btScalar( 0.153 ) * btScalar( k % 6 ) - btScalar( 0.4 ),
						   z = btScalar( 0.157 ) * btScalar( k / 6 ) - btScalar( 0.4 );
			boxes.push_back(
				t.addBox( btScalar( 0.003 ), btVector3( kHalf, kHalf * btScalar( 0.7 ), kHalf ), at( x, btScalar( 0.56 ), z ) ) );
			boxes.back()->setLinearVelocity( btVector3( 0, btScalar( -0.4 ) * btScalar( k % 7 ), 0 ) );
			boxes.back()->setAngularVelocity( btVector3( btScalar( k % 5 - 2 ), 0, btScalar( k % 3 - 1 ) ) );
		}
		t.run( 90 );
		const test::DrawnTriangles drawn( *soft );
		for ( const btRigidBody* const box : boxes )
		{
			EXPECT_FALSE( drawn.contains( box->getWorldTransform().getOrigin() ) )
				<< int( elasticity ) << ", " << drawn.distance( box->getWorldTransform().getOrigin() ) / kBlockCell << " cells";
		}
	}
}

// The nodes beside a capsule see it from aside, but press below its axis: without friction nothing makes it spin.
TEST( SmallObjects, CapsulesAreNotSpunByTheSurface )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		TestWorld t;
		addTestBlock( t, elasticity )->setFriction( 0 );
		std::vector<btRigidBody*> capsules;
		for ( int k = 0; k < 8; ++k )
		{
			const btScalar offset = btScalar( 0.012 ) * btScalar( k );
			capsules.push_back( t.add( btScalar( 0.2 ), new btCapsuleShapeX( btScalar( 0.03 ), btScalar( 0.04 ) ),
				at( btScalar( 0.13 ) * btScalar( k - 4 ), btScalar( 0.532 ), offset ) ) );
			capsules.back()->setFriction( 0 );
		}
		double fastest = 0.0;
		for ( int frame = 0; frame < 60; ++frame )
		{
			t.run( 1 );
			for ( const btRigidBody* const capsule : capsules )
			{
				fastest = std::max( fastest, std::abs( double( capsule->getAngularVelocity().x() ) ) );
			}
		}
		std::printf( "spins at %.4f rad/s at most\n", fastest );
		EXPECT_LT( fastest, 0.1 ) << int( elasticity );
	}
}

// At a rim nodes have no patch, and a hull that was turned so that Bullet's box around it was larger than a cell and a half came to rest in
// the groove between two of their spheres.
TEST( SmallObjects, HullsSinkIntoNoGrooveAtARim )
{
	for ( const Elasticity elasticity : { Elasticity::Implicit, Elasticity::Explicit } )
	{
		TestWorld t;
		const SoftBody* const soft = addTestBlock( t, elasticity );
		std::vector<btRigidBody*> hulls;
		for ( int k = 0; k < 10; ++k )
		{
			const btScalar z = btScalar( 0.1 ) * btScalar( k - 5 );
			hulls.push_back( t.add( btScalar( 0.01 ), hull(), at( btScalar( 0.552 ) + btScalar( 0.002 ) * k, btScalar( 0.53 ), z ) ) );
			btTransform turned = hulls.back()->getWorldTransform();
			turned.setRotation( btQuaternion( btVector3( 1, 1, 1 ).normalized(), btScalar( 0.3 ) * k ) );
			hulls.back()->setWorldTransform( turned );
		}
		t.run( 60 );
		const test::DrawnTriangles drawn( *soft );
		for ( const btRigidBody* const thing : hulls )
		{
			const btVector3 centre = thing->getWorldTransform().getOrigin();
			EXPECT_TRUE( !drawn.contains( centre ) || drawn.distance( centre ) < 0.02 * kBlockCell )
				<< int( elasticity ) << ", " << drawn.distance( centre ) / kBlockCell << " cells";
		}
	}
}

/// The farthest position of a default cube of .6 m, cells of .1 m, that slides at 4 m/s towards something static at x = 0.
double farthestAgainst( btCollisionShape* shape, double aside, double yaw )
{
	TestWorld t;
	t.addPlane()->setFriction( btScalar( 0.3 ) );
	t.add( 0, shape, at( 0, 1, 0 ) );
	LatticeSettings settings;
	settings.cellSize = 0.1f;
	const btTransform start(
		btQuaternion( btVector3( 0, 1, 0 ), btScalar( yaw ) ), btVector3( btScalar( -1.2 ), btScalar( 0.3 ), btScalar( aside ) ) );
	SoftBody* const cube = t.addSoft(
		BodyTemplate::build( test::makeBox( { -0.3, -0.3, -0.3 }, { 0.3, 0.3, 0.3 } ).view(), settings ).value, start, Material{} );
	EXPECT_TRUE( cube->setVelocities( btVector3( 4, 0, 0 ), btVector3( 0, 0, 0 ) ).ok() );
	double farthest = -2.0;
	for ( int frame = 0; frame < 90; ++frame )
	{
		t.run( 1 );
		farthest = std::max( farthest, double( cube->massCentre().x() ) );
	}
	return farthest;
}

// Static objects of 3 cells and more met one sphere a cell: the cube passed through a post of 4 cm, and stopped half a body behind the end
// of a wall of 2 cm.
TEST( SmallObjects, PostsAndEdgesOfWallsStopABody )
{
	for ( const double yaw : { 0.0, 0.3 } )
	{
		for ( const double aside : { 0.0, 0.03, 0.05 } )
		{
			for ( const double radius : { 0.01, 0.02, 0.03 } )
			{
				const btVector3 half( btScalar( radius ), 1, btScalar( radius ) );
				EXPECT_LT( farthestAgainst( new btCylinderShape( half ), aside, yaw ), -0.15 ) << "post of radius " << radius;
			}
			EXPECT_LT( farthestAgainst( new btBoxShape( btVector3( 1, 1, btScalar( 0.01 ) ) ), aside, yaw ), -1.1 ) << "end of a wall";
		}
	}
}

// Bullet takes corners within a centimetre for one. Of a hull of a centimetre the wrong corner was found as the nearest, a centimetre from
// the right one: it lost its contacts, and fell into the surface on which it lay.
TEST( SmallObjects, HullsOfMillimetresHaveAllTheirCorners )
{
	const btVector3 corners[] = { btVector3( 1, 0, 0 ), btVector3( -1, 0, 0 ), btVector3( 0, 1, 0 ), btVector3( 0, -1, 0 ),
		btVector3( 0, 0, 1 ), btVector3( 0, 0, -1 ), btVector3( btScalar( 0.6 ), btScalar( 0.6 ), btScalar( 0.6 ) ) };
	btSphereShape sphere( btScalar( 0.05 ) );
	for ( const double half : { 0.5, 0.05, 0.005, 0.001 } )
	{
		btConvexHullShape hull;
		for ( const btVector3& corner : corners )
		{
			hull.addPoint( corner * btScalar( half ) );
		}
		hull.setMargin( btScalar( 0.1 * half ) );
		Obstacle obstacle;
		obstacle.shape = &hull;
		MovingSphere from;
		from.shape = &sphere;
		from.radius = double( sphere.getRadius() );
		from.centre = Vec3d( 0.0, -0.85, 0.0 ); // as far as a patch's sphere is behind the surface
		for ( int k = 0; k < 500; ++k )
		{
			const btQuaternion turn(
				btVector3( std::sin( btScalar( k ) ), std::cos( btScalar( 3 * k ) ), std::sin( btScalar( 7 * k ) ) ).normalized(),
				btScalar( 0.1 * k ) );
			obstacle.basis = toMatrix3d( btMatrix3x3( turn ) );
			double nearest = 1e9;
			for ( const btVector3& corner : corners )
			{
				nearest = std::min( nearest, ( half * obstacle.basis * toVec3d( corner ) - from.centre ).norm() - 0.1 * half );
			}
			Touch touch;
			ASSERT_TRUE( findNearest( obstacle, from, touch ) );
			EXPECT_LT( touch.distance, nearest + 0.01 * half + 1e-5 ) << half << " " << k;
		}
	}
}

} // namespace
} // namespace pliant
