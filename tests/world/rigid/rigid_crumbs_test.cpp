// Small bodies in their rigid state.

#include "body/rigid_state.h"
#include "support/mesh_of_boxes.h"
#include "world/bodies/soft_body_impl.h"
#include "world/test_world.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

// Crumbs of a vase spun at 13 000 rad/s on the floor: their nodes, which are mass points, were nearly collinear, and contacts at the
// material around them had a hundred times their lever arm.
TEST( RigidCrumbs, HaveTheInertiaOfTheirMaterial )
{
	TestWorld test;
	test.addFloor();
	test::MeshOfBoxes mesh;
	mesh.add( btVector3( 0, 0, 0 ), btVector3( 0.25f, 0.05f, 0.05f ) );
	mesh.add( btVector3( 0.3f, 0.01f, 0.01f ), btVector3( 0.05f, 0.04f, 0.04f ) ); // its cell's centre is off the line
	const std::shared_ptr<const BodyTemplate> shape = mesh.build( 0.1f );
	ASSERT_TRUE( shape );
	Material material = test::stiff( 1e7f );
	material.rigidStrain = 0.01f;
	SoftBody* const body = test.addSoft( shape, at( 0, 0.3f, 0 ), material );
	EXPECT_TRUE( body->setVelocities( btVector3( 2, 0, 1 ), btVector3( 5, 3, 0 ) ).ok() );
	double fastest = 0.0;
	for ( int frame = 0; frame < 240; ++frame )
	{
		test.run( 1 );
		fastest = body->isRigid() ? std::max( fastest, double( body->angularVelocity().length() ) ) : fastest;
	}
	ASSERT_TRUE( body->isRigid() );
	const Vec3d moments = body->impl().body->rigidState()->moments;
	EXPECT_TRUE( moments.minCoeff() == 0.0 || moments.minCoeff() > 0.09 * double( body->mass() ) * 0.01 ) << moments.transpose();
	EXPECT_GT( moments.minCoeff(), 0.0 );
	EXPECT_LT( fastest, 60.0 );
}

/// Crumbs of three to six cells of 2 cm that fall spinning on a floor.
void addCrumbs( TestWorld& test, int count )
{
	Material material = test::stiff( 5e7f );
	material.rigidStrain = 0.1f;
	std::vector<std::shared_ptr<const BodyTemplate>> shapes;
	for ( const btVector3& half : { btVector3( 0.03f, 0.01f, 0.01f ), btVector3( 0.03f, 0.02f, 0.01f ), btVector3( 0.02f, 0.02f, 0.01f ) } )
	{
		test::MeshOfBoxes mesh;
		mesh.add( btVector3( 0, 0, 0 ), half );
		mesh.add( half, btVector3( 0.01f, 0.01f, 0.01f ) ); // a corner on which it can spin like a top
		shapes.push_back( mesh.build( 0.02f ) );
		ASSERT_TRUE( shapes.back() );
	}
	for ( int k = 0; k < count; ++k )
	{
		const btQuaternion turn( btVector3( 1, btScalar( k % 5 ), btScalar( k % 3 ) - 1 ).normalized(), btScalar( k ) );
		SoftBody* const body = test.addSoft( shapes[std::size_t( k ) % shapes.size()],
			btTransform( turn, btVector3( btScalar( k % 4 ) * 0.1f, 0.1f + 0.03f * btScalar( k ), btScalar( k / 4 ) * 0.1f ) ), material );
		EXPECT_TRUE( body->setVelocities( btVector3( 0.3f, 0, 0.1f ), btVector3( 5, btScalar( 20 * ( k % 3 ) ), 3 ) ).ok() );
		body->setFriction( btScalar( 0.6 ) );
	}
}

// Their contacts were lost within a step: they rolled from corner to corner at 10 rad/s, half sunk into the floor, or spun on a corner.
TEST( RigidCrumbs, FallAsleep )
{
	TestWorld test;
	test.addPlane();
	addCrumbs( test, 16 );
	test.run( 5 * 60 );
	for ( const std::unique_ptr<SoftBody>& body : test.soft )
	{
		EXPECT_TRUE( body->isRigid() );
		EXPECT_FALSE( body->isActive() ) << body->nodeCount() << " nodes, " << body->linearVelocity().length() << " m/s, "
										 << body->angularVelocity().length() << " rad/s, at height " << body->massCentre().y();
	}
}

} // namespace
} // namespace pliant
