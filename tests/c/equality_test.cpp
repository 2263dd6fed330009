// A scene through the C face has the same bits as through C++; both faces can be used on one world.

#include "c/face.h"

#include "pliant/c/mix.h"
#include "pliant/pliant.h"

#include <btBulletDynamicsCommon.h>

namespace pliant {
namespace {

using namespace test;

Material stiff()
{
	Material material;
	material.youngsModulus = 1e5f;
	material.volumeKeeping = 0.5f;
	return material;
}

Fracture brittle()
{
	Fracture fracture;
	fracture.rule = BreakRule::Plane;
	fracture.breakStrain = 0.12f;
	return fracture;
}

/// Two cubes, one of which breaks under a ball, on a plane, next to a box: in C++.
struct CppScene
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	SoftBodyWorld world{ &dispatcher, &broadphase, &solver, &configuration };
	btStaticPlaneShape planeShape{ btVector3( 0, 1, 0 ), 0 };
	btSphereShape ballShape{ btScalar( 0.25 ) };
	btBoxShape boxShape{ btVector3( btScalar( 0.3 ), btScalar( 0.2 ), btScalar( 0.3 ) ) };
	std::vector<std::unique_ptr<btRigidBody>> rigid;
	std::shared_ptr<const BodyTemplate> cube;
	std::vector<std::unique_ptr<SoftBody>> soft;

	CppScene()
	{
		world.setGravity( btVector3( 0, btScalar( -9.81 ), 0 ) );
		const CubeMesh mesh;
		LatticeSettings settings;
		settings.cellSize = 0.25f;
		cube = BodyTemplate::build( MeshView{ mesh.positions.data(), 8, 3, mesh.indices.data(), 12 }, settings ).value;
	}
	~CppScene()
	{
		for ( auto& body : soft )
		{
			world.removeSoftBody( body.get() );
		}
		for ( auto& body : rigid )
		{
			world.removeRigidBody( body.get() );
		}
	}
	btRigidBody* add( btScalar mass, btCollisionShape& shape, const btVector3& at )
	{
		btVector3 inertia( 0, 0, 0 );
		if ( mass > 0 )
		{
			shape.calculateLocalInertia( mass, inertia );
		}
		rigid.push_back( std::make_unique<btRigidBody>( btRigidBody::btRigidBodyConstructionInfo( mass, nullptr, &shape, inertia ) ) );
		const btTransform transform( btQuaternion::getIdentity(), at );
		rigid.back()->setWorldTransform( transform );
		rigid.back()->setInterpolationWorldTransform( transform );
		world.addRigidBody( rigid.back().get() );
		return rigid.back().get();
	}
	SoftBody* add( const btVector3& at, const Fracture& fracture )
	{
		soft.push_back( SoftBody::create( cube, btTransform( btQuaternion::getIdentity(), at ), stiff() ).value );
		EXPECT_TRUE( soft.back()->setFracture( fracture ).ok() );
		world.addSoftBody( soft.back().get() );
		return soft.back().get();
	}
	void fill()
	{
		add( 0, planeShape, btVector3( 0, 0, 0 ) );
		add( btVector3( 0, btScalar( 0.5 ), 0 ), brittle() );
		add( btVector3( btScalar( 1.5 ), 1, 0 ), Fracture{} );
		add( 200, ballShape, btVector3( 0, btScalar( 1.5 ), 0 ) )->setLinearVelocity( btVector3( 0, -12, 0 ) );
		add( 5, boxShape, btVector3( btScalar( 1.5 ), 2, 0 ) );
	}
	std::vector<double> everything() const
	{
		std::vector<double> all;
		const auto append = [&]( const btVector3& v ) { all.insert( all.end(), { double( v.x() ), double( v.y() ), double( v.z() ) } ); };
		for ( int k = 0; k < world.softBodyCount(); ++k )
		{
			const SoftBody& body = *world.softBody( k );
			for ( int n = 0; n < body.nodeCount(); ++n )
			{
				append( body.nodePosition( n ) );
			}
			for ( int n = 0; n < body.nodeCount(); ++n )
			{
				append( body.nodeVelocity( n ) );
			}
		}
		for ( const auto& body : rigid )
		{
			append( body->getWorldTransform().getOrigin() );
			const btQuaternion q = body->getWorldTransform().getRotation();
			all.insert( all.end(), { double( q.x() ), double( q.y() ), double( q.z() ), double( q.w() ) } );
		}
		return all;
	}
};

/// The same in C.
void fill( CScene& scene )
{
	auto material = initial( pliant_material_init );
	material.youngs_modulus = 1e5f;
	material.volume_keeping = 0.5f;
	auto fracture = initial( pliant_fracture_init );
	fracture.rule = PLIANT_BREAK_PLANE;
	fracture.break_strain = 0.12f;
	auto settings = initial( pliant_body_settings_init );
	settings.material = &material;
	settings.fracture = &fracture;
	settings.pose.position = pliant_vec3{ 0, 0.5, 0 };
	pliant_id made = 0;
	ASSERT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &made ), PLIANT_OK );
	settings.fracture = nullptr;
	settings.pose.position = pliant_vec3{ 1.5, 1, 0 };
	ASSERT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &made ), PLIANT_OK );
	scene.addBall( pliant_vec3{ 0, 1.5, 0 }, 200, pliant_vec3{ 0, -12, 0 } );
	auto box = initial( pliant_rigid_settings_init );
	box.mass = 5;
	box.pose.position = pliant_vec3{ 1.5, 2, 0 };
	ASSERT_EQ( pliant_rigid_create_box( scene.world, pliant_vec3{ 0.3, 0.2, 0.3 }, &box, &made ), PLIANT_OK );
}

TEST( CFace, ASceneHasTheBitsOfTheSameSceneInCpp )
{
	CppScene cpp;
	cpp.fill();
	CScene c;
	fill( c );
	for ( int step = 0; step < 90; ++step )
	{
		cpp.world.stepSimulation( btScalar( kFrame ), 0 );
		c.step();
	}
	EXPECT_GT( cpp.world.softBodyCount(), 2 ) << "something is to break";
	EXPECT_EQ( int( c.bodies().size() ), cpp.world.softBodyCount() );
	EXPECT_EQ( c.everything(), cpp.everything() );
}

TEST( CFace, AWrappedWorldIsBothFaces )
{
	CppScene cpp;
	cpp.fill();
	CppScene alone;
	alone.fill();
	pliant_world* world = nullptr;
	ASSERT_EQ( wrapWorld( cpp.world, &world ), PLIANT_OK );
	ASSERT_EQ( hostOf( world ), &cpp.world );
	std::uint64_t count = 0;
	pliant_id ids[8];
	ASSERT_EQ( pliant_world_get_bodies( world, ids, 8, &count ), PLIANT_OK );
	ASSERT_EQ( count, 2u );
	EXPECT_EQ( objectOf( world, ids[1] ), cpp.soft[1].get() );
	EXPECT_EQ( idOf( world, cpp.soft[1].get() ), ids[1] );
	ASSERT_EQ( pliant_world_get_rigids( world, ids, 8, &count ), PLIANT_OK );
	ASSERT_EQ( count, 3u );
	const pliant_id ball = idOf( world, cpp.rigid[1].get() );
	EXPECT_EQ( ball, ids[1] );
	for ( int step = 0; step < 30; ++step )
	{
		cpp.world.stepSimulation( btScalar( kFrame ), 0 );
		ASSERT_EQ( pliant_world_step( world, kFrame, 0, kFrame, nullptr ), PLIANT_OK );
		alone.world.stepSimulation( btScalar( kFrame ), 0 );
		alone.world.stepSimulation( btScalar( kFrame ), 0 );
	}
	EXPECT_EQ( cpp.everything(), alone.everything() ) << "a handle changes nothing";

	// Objects made through C++ cannot be destroyed through C; objects made through C are destroyed with the handle.
	EXPECT_EQ( pliant_object_destroy( world, ball ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_object_destroy( world, idOf( world, cpp.soft[0].get() ) ), PLIANT_BAD_ARGUMENT );
	pliant_id made = 0;
	ASSERT_EQ( pliant_rigid_create_sphere( world, 0.1, nullptr, &made ), PLIANT_OK );
	pliant_template* shared = nullptr;
	ASSERT_EQ( wrapTemplate( cpp.cube, &shared ), PLIANT_OK );
	ASSERT_EQ( pliant_body_create( world, shared, nullptr, &made ), PLIANT_OK );
	pliant_template_release( shared );
	const int objects = cpp.world.getNumCollisionObjects();
	cpp.world.removeRigidBody( cpp.rigid.back().get() ); // through C++
	const pliant_id gone = idOf( world, cpp.rigid.back().get() );
	cpp.rigid.pop_back();
	EXPECT_EQ( gone, 0u );
	EXPECT_EQ( pliant_object_wake( world, ids[2] ), PLIANT_NO_SUCH_OBJECT );
	pliant_world_destroy( world );
	EXPECT_EQ( cpp.world.getNumCollisionObjects(), objects - 3 );
}

} // namespace
} // namespace pliant
