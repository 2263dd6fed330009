// Bullet's vehicle on soft ground, with a raycaster that sees soft bodies; Bullet's own sees rigid bodies only.

#include "world/test_world.h"

#include <pliant/vehicle_raycaster.h>

#include <BulletDynamics/Vehicle/btRaycastVehicle.h>

#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

/// A car of 400 kg whose wheels (radius .3 m) touch the ground at y 0 when it is created.
struct Car
{
	TestWorld& world;
	VehicleRaycaster caster{ world.world };
	btRaycastVehicle::btVehicleTuning tuning;
	btRigidBody* chassis;
	std::unique_ptr<btRaycastVehicle> vehicle;

	explicit Car( TestWorld& to, btScalar ground, btScalar z = 0 ) : world( to )
	{
		chassis = world.addBox( 400, btVector3( btScalar( 0.5 ), btScalar( 0.2 ), 1 ), at( 0, ground + btScalar( 0.75 ), z ) );
		chassis->setActivationState( DISABLE_DEACTIVATION );
		vehicle = std::make_unique<btRaycastVehicle>( tuning, chassis, &caster );
		vehicle->setCoordinateSystem( 0, 1, 2 );
		for ( int k = 0; k < 4; ++k )
		{
			btWheelInfo& wheel = vehicle->addWheel(
				btVector3( k % 2 ? btScalar( 0.45 ) : btScalar( -0.45 ), btScalar( -0.1 ), k < 2 ? btScalar( 0.8 ) : btScalar( -0.8 ) ),
				btVector3( 0, -1, 0 ), btVector3( -1, 0, 0 ), btScalar( 0.4 ), btScalar( 0.3 ), tuning, k < 2 );
			wheel.m_suspensionStiffness = 40;
			wheel.m_wheelsDampingRelaxation = btScalar( 4 );
			wheel.m_wheelsDampingCompression = btScalar( 4 );
		}
		world.world.addVehicle( vehicle.get() );
		caster.setVehicle( vehicle.get() );
		world.world.addAction( &caster );
	}
	~Car()
	{
		world.world.removeAction( &caster );
		world.world.removeVehicle( vehicle.get() );
	}
	btScalar height() const { return chassis->getWorldTransform().getOrigin().y(); }
};

TEST( Vehicle, StandsOnASoftBodyAsOnARigidOneAndPressesOnIt )
{
	constexpr btScalar kThick = btScalar( 0.6 ); // m, of the ground
	TestWorld rigid;
	rigid.addFloor( kThick );
	Car twin( rigid, kThick );
	rigid.run( 240 );
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		t.addFloor();
		Material material = test::stiff( 1e6f );
		material.elasticity = elasticity;
		SoftBody* ground = t.addSoft( block( 12, 4, 18, 0.15f ), at( 0, kThick / 2, 0 ), material );
		t.run( 120 );
		const btScalar alone = ground->massCentre().y();
		Car car( t, kThick );
		t.run( 240 );
		EXPECT_NEAR( car.height(), twin.height(), 0.075 ) << "half a cell";
		for ( int w = 0; w < 4; ++w )
		{
			const btWheelInfo::RaycastInfo& ray = car.vehicle->getWheelInfo( w ).m_raycastInfo;
			ASSERT_TRUE( ray.m_isInContact );
			EXPECT_EQ( car.caster.softBodyAt( ray.m_hardPointWS, ray.m_hardPointWS - btVector3( 0, 1, 0 ) ), ground );
			EXPECT_GT( ray.m_contactNormalWS.y(), btScalar( 0.99 ) );
		}
		// The ground carries the car as well: contact points hold the impulses of the step.
		btScalar borne = 0;
		for ( int k = 0; k < 60; ++k )
		{
			t.run( 1 );
			for ( int m = 0; m < t.parts.dispatcher.getNumManifolds(); ++m )
			{
				const btPersistentManifold* manifold = t.parts.dispatcher.getManifoldByIndexInternal( m );
				for ( int p = 0; p < manifold->getNumContacts(); ++p )
				{
					borne += manifold->getContactPoint( p ).getAppliedImpulse();
				}
			}
		}
		EXPECT_NEAR( borne / 10, ground->mass() + 400, 0.15 * ( ground->mass() + 400 ) ) << "the ground's mass is " << ground->mass();
		EXPECT_LT( ground->massCentre().y(), alone ) << "it yields";
	}
}

/// A hump across a road along z: .2 m high, 2.4 m long at its foot and .6 m on its top, 3 m wide; its foot at y 0.
constexpr float kHump[8][3] = { { -1.5f, 0, -1.2f }, { 1.5f, 0, -1.2f }, { -1.5f, 0.2f, -0.3f }, { 1.5f, 0.2f, -0.3f }, { -1.5f, 0, 1.2f },
	{ 1.5f, 0, 1.2f }, { -1.5f, 0.2f, 0.3f }, { 1.5f, 0.2f, 0.3f } };

std::shared_ptr<const BodyTemplate> softHump()
{
	static const std::uint32_t indices[36] = {
		0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	MeshView mesh;
	mesh.positions = kHump[0];
	mesh.vertexCount = 8;
	mesh.indices = indices;
	mesh.triangleCount = 12;
	LatticeSettings settings;
	settings.cellSize = 0.1f;
	return BodyTemplate::build( mesh, settings ).value;
}

/// A drive of three and a half seconds with 150 N on each wheel, from 4 m in front of the hump.
struct Drive
{
	btScalar distance = 0, highest = 0, sideways = 0; ///< m
};
Drive driveOver( TestWorld& t )
{
	Car car( t, 0, -4 );
	t.run( 60 );
	const btScalar from = car.chassis->getWorldTransform().getOrigin().z(), height = car.height();
	Drive drive;
	for ( int k = 0; k < 210; ++k )
	{
		for ( int w = 0; w < 4; ++w )
		{
			car.vehicle->applyEngineForce( 150, w );
		}
		t.run( 1 );
		drive.highest = btMax( drive.highest, car.height() - height );
	}
	drive.distance = car.chassis->getWorldTransform().getOrigin().z() - from;
	drive.sideways = car.chassis->getWorldTransform().getOrigin().x();
	return drive;
}

// The car must get over a hump that yields and springs back under each wheel as over a rigid one, neither caught nor thrown up. Slopes are
// of 13 degrees; wheels meet a soft edge rounded off by a cell, so that a kerb of 27 degrees decelerates the car by half as much as a rigid
// one.
TEST( Vehicle, DrivesOverASoftHumpAsOverARigidOne )
{
	TestWorld rigid;
	rigid.addFloor();
	auto* const hull = new btConvexHullShape();
	for ( const float* corner : kHump )
	{
		hull->addPoint( btVector3( btScalar( corner[0] ), btScalar( corner[1] ), btScalar( corner[2] ) ) );
	}
	hull->setMargin( btScalar( 0.005 ) );
	rigid.add( 0, hull, at( 0, 0, 0 ) );
	const Drive twin = driveOver( rigid );
	EXPECT_GT( twin.distance, 6 );
	EXPECT_GT( twin.highest, btScalar( 0.1 ) );
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const float youngsModulus : { 3e5f, 1e6f } )
		{
			TestWorld t;
			t.addFloor()->setFriction( 1 );
			Material material = test::stiff( youngsModulus );
			material.elasticity = elasticity;
			SoftBody* const hump = t.addSoft( softHump(), at( 0, 0, 0 ), material );
			hump->setFriction( 1 );
			const Drive found = driveOver( t );
			std::printf( "%s, E %.0e: %.2f m (rigid %.2f), up by %.3f (%.3f), aside by %.3f; hump at z %.3f\n",
				elasticity == Elasticity::Explicit ? "explicit" : "implicit", double( youngsModulus ), double( found.distance ),
				double( twin.distance ), double( found.highest ), double( twin.highest ), double( found.sideways ),
				double( hump->massCentre().z() ) );
			EXPECT_NEAR( found.distance, twin.distance, btScalar( 0.1 ) * twin.distance );
			EXPECT_NEAR( found.highest, twin.highest, 0.1 ) << "a cell";
			EXPECT_NEAR( found.sideways, 0, 0.1 );
			EXPECT_NEAR( hump->massCentre().z(), 0, 0.1 ) << "it stays in place";
			EXPECT_NEAR( hump->massCentre().y(), 0.09, 0.03 );
		}
	}
}

TEST( Vehicle, RigidBodiesAreSeenAsByBulletsRaycaster )
{
	TestWorld t;
	btRigidBody* floor = t.addFloor( 1 );
	SoftBody* below = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, btScalar( -0.5 ), 0 ) );
	VehicleRaycaster ours( t.world );
	btDefaultVehicleRaycaster bullets( &t.world );
	btVehicleRaycaster::btVehicleRaycasterResult a, b;
	EXPECT_EQ( ours.castRay( btVector3( 1, 3, 0 ), btVector3( 1, -3, 0 ), a ), floor );
	EXPECT_EQ( bullets.castRay( btVector3( 1, 3, 0 ), btVector3( 1, -3, 0 ), b ), floor );
	EXPECT_EQ( a.m_distFraction, b.m_distFraction );
	EXPECT_EQ( ( a.m_hitPointInWorld - b.m_hitPointInWorld ).length() + ( a.m_hitNormalInWorld - b.m_hitNormalInWorld ).length(), 0 );
	EXPECT_EQ( ours.castRay( btVector3( 30, 3, 0 ), btVector3( 30, -3, 0 ), a ), nullptr );
	EXPECT_EQ( ours.softBodyAt( btVector3( 0, 3, 0 ), btVector3( 0, -3, 0 ) ), nullptr ) << "the floor is nearer";
	t.world.removeRigidBody( floor );
	EXPECT_EQ( ours.softBodyAt( btVector3( 0, 3, 0 ), btVector3( 0, -3, 0 ) ), below );
	auto* const ground = static_cast<btRigidBody*>( ours.castRay( btVector3( 0, 3, 0 ), btVector3( 0, -3, 0 ), a ) );
	ASSERT_NE( ground, nullptr );
	EXPECT_EQ( ground->getInvMass(), 0 ) << "callers may cast it to a rigid body";
	// Between four nodes too, where a ray meets no sphere.
	for ( int k = 0; k < 100; ++k )
	{
		const btScalar x = btScalar( 0.0037 ) * btScalar( k ) - btScalar( 0.18 ), z = btScalar( 0.0023 ) * btScalar( k ) - btScalar( 0.15 );
		ASSERT_NE( ours.castRay( btVector3( x, 1, z ), btVector3( x, -3, z ), a ), nullptr );
		ASSERT_NEAR( a.m_hitPointInWorld.y(), -0.3, 0.005 );
		ASSERT_GT( a.m_hitNormalInWorld.y(), btScalar( 0.98 ) );
	}
	t.world.addRigidBody( floor );
}

} // namespace
} // namespace pliant
