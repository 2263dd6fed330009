#pragma once

// Fourteen kinds of rigid scenes, built in any world.

#include "world/test_world.h"

#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/Vehicle/btRaycastVehicle.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace pliant::test {

/// A rigid scene in any world. Everything it holds is destroyed after the world has released it.
struct Scene
{
	explicit Scene( btDiscreteDynamicsWorld& w ) : world( w ) { world.setGravity( btVector3( 0, btScalar( -9.81 ), 0 ) ); }
	~Scene()
	{
		for ( const auto& action : actions )
		{
			world.removeAction( action.get() );
		}
		for ( const auto& joint : joints )
		{
			world.removeConstraint( joint.get() );
		}
		for ( const auto& object : objects )
		{
			world.removeCollisionObject( object.get() );
		}
	}

	template <class Shape>
	Shape* shape( Shape* made )
	{
		shapes.emplace_back( made );
		return made;
	}
	btRigidBody* add( btScalar mass, btCollisionShape* with, const btTransform& where )
	{
		btVector3 inertia( 0, 0, 0 );
		if ( mass > 0 )
		{
			with->calculateLocalInertia( mass, inertia );
		}
		btRigidBody::btRigidBodyConstructionInfo info( mass, nullptr, with, inertia );
		info.m_startWorldTransform = where;
		auto* body = new btRigidBody( info );
		objects.emplace_back( body );
		world.addRigidBody( body );
		return body;
	}
	btRigidBody* box( btScalar mass, const btVector3& half, const btTransform& where )
	{
		return add( mass, shape( new btBoxShape( half ) ), where );
	}
	void floor() { box( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) ); }
	void join( btTypedConstraint* joint )
	{
		joints.emplace_back( joint );
		world.addConstraint( joint, true );
	}

	btDiscreteDynamicsWorld& world;
	std::vector<std::unique_ptr<btCollisionShape>> shapes;
	std::vector<std::unique_ptr<btStridingMeshInterface>> meshes;
	std::vector<std::unique_ptr<btVehicleRaycaster>> casters;
	std::vector<float> heights;
	std::vector<std::unique_ptr<btCollisionObject>> objects;
	std::vector<std::unique_ptr<btTypedConstraint>> joints;
	std::vector<std::unique_ptr<btActionInterface>> actions;
	void ( *everyFrame )( Scene&, int frame ) = nullptr;
};

inline void stack( Scene& s )
{
	s.floor();
	for ( int k = 0; k < 12; ++k )
	{
		s.box( 1, btVector3( 0.5, 0.5, 0.5 ), at( btScalar( 0.03 ) * btScalar( k % 3 ), btScalar( 0.5 ) + btScalar( k ), 0 ) );
	}
}

inline void ramp( Scene& s )
{
	s.floor();
	btRigidBody* slope = s.box(
		0, btVector3( 5, 0.1f, 5 ), btTransform( btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.4 ) ), btVector3( 0, 2, 0 ) ) );
	slope->setFriction( btScalar( 0.3 ) );
	for ( int k = 0; k < 6; ++k )
	{
		s.box( 1, btVector3( 0.3f, 0.2f, 0.4f ), at( 2, 4, btScalar( k - 3 ) ) )->setFriction( btScalar( 0.2 ) * btScalar( k ) );
	}
}

inline void chain( Scene& s )
{
	btRigidBody* before = s.box( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 10, 0 ) );
	for ( int k = 1; k < 10; ++k )
	{
		btRigidBody* link = s.add( 1, s.shape( new btCapsuleShape( 0.1f, 0.6f ) ), at( btScalar( k ), 10, 0 ) );
		s.join( new btPoint2PointConstraint( *before, *link, btVector3( 0.5, 0, 0 ), btVector3( -0.5, 0, 0 ) ) );
		before = link;
	}
}

inline void hingeMotor( Scene& s )
{
	s.floor();
	btRigidBody* post = s.box( 0, btVector3( 0.1f, 1, 0.1f ), at( 0, 1, 0 ) );
	btRigidBody* door = s.box( 5, btVector3( 0.8f, 0.9f, 0.05f ), at( 1, 1, 0 ) );
	auto* hinge = new btHingeConstraint(
		*post, *door, btVector3( 0.1f, 0, 0 ), btVector3( -0.9f, 0, 0 ), btVector3( 0, 1, 0 ), btVector3( 0, 1, 0 ) );
	hinge->enableAngularMotor( true, btScalar( 2 ), btScalar( 3 ) );
	s.join( hinge );
	s.box( 1, btVector3( 0.3f, 0.3f, 0.3f ), at( 1, btScalar( 0.3 ), 1 ) );
}

inline void springs( Scene& s )
{
	s.floor();
	btRigidBody* base = s.box( 0, btVector3( 0.5, 0.1f, 0.5 ), at( 0, 4, 0 ) );
	btRigidBody* weight = s.box( 2, btVector3( 0.3f, 0.3f, 0.3f ), at( 0, 3, 0 ) );
	auto* spring = new btGeneric6DofSpring2Constraint( *base, *weight, at( 0, btScalar( -0.5 ), 0 ), at( 0, btScalar( 0.5 ), 0 ) );
	spring->setLinearLowerLimit( btVector3( -1, -2, -1 ) );
	spring->setLinearUpperLimit( btVector3( 1, 1, 1 ) );
	spring->enableSpring( 1, true );
	spring->setStiffness( 1, btScalar( 60 ) );
	spring->setDamping( 1, btScalar( 0.5 ) );
	s.join( spring );
	weight->applyCentralImpulse( btVector3( 1, 2, 3 ) );
}

inline void compounds( Scene& s )
{
	s.floor();
	for ( int k = 0; k < 8; ++k )
	{
		auto* table = s.shape( new btCompoundShape );
		table->addChildShape( at( 0, btScalar( 0.3 ), 0 ), s.shape( new btBoxShape( btVector3( 0.6f, 0.1f, 0.6f ) ) ) );
		table->addChildShape( at( btScalar( 0.5 ), 0, btScalar( 0.5 ) ), s.shape( new btCylinderShape( btVector3( 0.1f, 0.3f, 0.1f ) ) ) );
		table->addChildShape( at( btScalar( -0.5 ), 0, btScalar( -0.5 ) ), s.shape( new btSphereShape( 0.15f ) ) );
		s.add( 2, table,
			btTransform( btQuaternion( btScalar( 0.3 ) * btScalar( k ), 1, 0 ),
				btVector3( btScalar( 0.2 ) * btScalar( k ), btScalar( 1 + k ), 0 ) ) );
	}
}

inline void landscape( Scene& s )
{
	constexpr int kSide = 17;
	for ( int k = 0; k < kSide * kSide; ++k )
	{
		s.heights.push_back( 0.5f * std::sin( 0.7f * float( k % kSide ) ) * std::cos( 0.5f * float( k / kSide ) ) );
	}
	auto* terrain = s.shape( new btHeightfieldTerrainShape( kSide, kSide, s.heights.data(), btScalar( -2 ), btScalar( 2 ), 1, false ) );
	s.add( 0, terrain, at( 0, -2, 0 ) );
	auto* mesh = new btTriangleMesh;
	s.meshes.emplace_back( mesh );
	mesh->addTriangle( btVector3( -9, 0, -9 ), btVector3( 9, 0, 9 ), btVector3( 9, 0, -9 ) );
	mesh->addTriangle( btVector3( -9, 0, -9 ), btVector3( -9, 0, 9 ), btVector3( 9, 0, 9 ) );
	s.add( 0, s.shape( new btBvhTriangleMeshShape( mesh, true ) ), at( 3, -1, 3 ) );
	for ( int k = 0; k < 9; ++k )
	{
		auto* hull = s.shape( new btConvexHullShape );
		for ( int c = 0; c < 6; ++c )
		{
			hull->addPoint( btVector3( c % 3 == 0 ? 0.4f : 0, c % 3 == 1 ? 0.3f : 0, c % 3 == 2 ? 0.5f : 0 ) * btScalar( c < 3 ? 1 : -1 ) );
		}
		btCollisionShape* kinds[] = { hull, s.shape( new btSphereShape( 0.3f ) ), s.shape( new btConeShape( 0.3f, 0.7f ) ) };
		s.add( 1, kinds[k % 3], at( btScalar( k % 3 ) * 2 - 2, 2, btScalar( k / 3 ) * 2 - 2 ) );
	}
}

inline void kinematic( Scene& s )
{
	s.floor();
	btRigidBody* lift = s.box( 0, btVector3( 2, 0.2f, 2 ), at( 0, 1, 0 ) );
	lift->setCollisionFlags( lift->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
	lift->setActivationState( DISABLE_DEACTIVATION );
	s.box( 1, btVector3( 0.3f, 0.3f, 0.3f ), at( 0, 2, 0 ) );
	s.box( 1, btVector3( 0.3f, 0.3f, 0.3f ), at( 1, 2, btScalar( 0.5 ) ) );
	s.everyFrame = []( Scene& scene, int frame ) {
		scene.objects[1]->setWorldTransform( at( btSin( btScalar( frame ) / 40 ), 1 + btSin( btScalar( frame ) / 60 ) / 2, 0 ) );
	};
}

inline void ghosts( Scene& s )
{
	s.floor();
	auto* ghost = new btPairCachingGhostObject;
	s.objects.emplace_back( ghost );
	ghost->setCollisionShape( s.shape( new btBoxShape( btVector3( 1, 1, 1 ) ) ) );
	ghost->setWorldTransform( at( 0, 1, 0 ) );
	ghost->setCollisionFlags( ghost->getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE );
	s.world.addCollisionObject( ghost, btBroadphaseProxy::SensorTrigger, btBroadphaseProxy::AllFilter );
	for ( int k = 0; k < 5; ++k )
	{
		s.add( 1, s.shape( new btSphereShape( 0.4f ) ), at( btScalar( 0.1 ) * btScalar( k ), btScalar( 1 + k ), 0 ) );
	}
}

inline void bullets( Scene& s )
{
	s.floor();
	s.box( 0, btVector3( 0.02f, 2, 2 ), at( 5, 2, 0 ) );
	for ( int k = 0; k < 4; ++k )
	{
		btRigidBody* shot = s.add( btScalar( 0.1 ), s.shape( new btSphereShape( 0.05f ) ), at( -5, 1, btScalar( k ) - btScalar( 1.5 ) ) );
		shot->setLinearVelocity( btVector3( btScalar( 50 + 80 * k ), 1, 0 ) );
		shot->setCcdMotionThreshold( btScalar( 0.05 ) );
		shot->setCcdSweptSphereRadius( btScalar( 0.04 ) );
	}
}

inline void vehicle( Scene& s )
{
	s.floor();
	auto* body = s.shape( new btCompoundShape );
	body->addChildShape( at( 0, btScalar( 0.5 ), 0 ), s.shape( new btBoxShape( btVector3( 1, 0.5f, 2 ) ) ) );
	btRigidBody* chassis = s.add( 800, body, at( 0, 2, 0 ) );
	chassis->setActivationState( DISABLE_DEACTIVATION );
	s.casters.push_back( std::make_unique<btDefaultVehicleRaycaster>( &s.world ) );
	btRaycastVehicle::btVehicleTuning tuning;
	auto* car = new btRaycastVehicle( tuning, chassis, s.casters.back().get() );
	s.actions.emplace_back( car );
	s.world.addVehicle( car );
	car->setCoordinateSystem( 0, 1, 2 );
	for ( int k = 0; k < 4; ++k )
	{
		const btVector3 hub( btScalar( k % 2 ? 1 : -1 ), btScalar( 0.6 ), btScalar( k / 2 ? 1.5 : -1.5 ) );
		car->addWheel( hub, btVector3( 0, -1, 0 ), btVector3( -1, 0, 0 ), btScalar( 0.6 ), btScalar( 0.5 ), tuning, k / 2 != 0 );
	}
	s.everyFrame = []( Scene& scene, int frame ) {
		auto& driven = static_cast<btRaycastVehicle&>( *scene.actions[0] );
		driven.applyEngineForce( 800, 0 );
		driven.applyEngineForce( 800, 1 );
		driven.setSteeringValue( btScalar( 0.3 ) * btSin( btScalar( frame ) / 50 ), 2 );
	};
}

inline void slider( Scene& s )
{
	s.floor();
	btRigidBody* rail = s.box( 0, btVector3( 2, 0.1f, 0.1f ), at( 0, 3, 0 ) );
	btRigidBody* sled = s.box( 3, btVector3( 0.3f, 0.3f, 0.3f ), at( 0, 2, 0 ) );
	auto* joint = new btSliderConstraint( *rail, *sled, at( 0, btScalar( -0.5 ), 0 ), at( 0, btScalar( 0.5 ), 0 ), true );
	joint->setLowerLinLimit( -1 );
	joint->setUpperLinLimit( 1 );
	joint->setPoweredLinMotor( true );
	joint->setTargetLinMotorVelocity( btScalar( 0.7 ) );
	joint->setMaxLinMotorForce( 40 );
	s.join( joint );
	s.box( 1, btVector3( 0.3f, 0.3f, 0.3f ), at( 1, btScalar( 0.3 ), 0 ) );
}

inline void ragdoll( Scene& s )
{
	s.floor();
	btRigidBody* trunk = s.add( 5, s.shape( new btCapsuleShape( 0.2f, 0.5f ) ), at( 0, 3, 0 ) );
	for ( int side = -1; side <= 1; side += 2 )
	{
		const btScalar x = btScalar( side );
		btRigidBody* arm = s.add( 1, s.shape( new btCapsuleShape( 0.1f, 0.4f ) ), at( x * btScalar( 0.6 ), btScalar( 3.3 ), 0 ) );
		auto* shoulder = new btConeTwistConstraint(
			*trunk, *arm, at( x * btScalar( 0.3 ), btScalar( 0.3 ), 0 ), at( x * btScalar( -0.3 ), 0, 0 ) );
		shoulder->setLimit( btScalar( 0.8 ), btScalar( 0.8 ), btScalar( 0.3 ) );
		s.join( shoulder );
		btRigidBody* leg = s.add( 2, s.shape( new btCapsuleShape( 0.1f, 0.5f ) ), at( x * btScalar( 0.2 ), btScalar( 2.2 ), 0 ) );
		s.join( new btHingeConstraint( *trunk, *leg, btVector3( x * btScalar( 0.2 ), btScalar( -0.4 ), 0 ),
			btVector3( 0, btScalar( 0.4 ), 0 ), btVector3( 1, 0, 0 ), btVector3( 1, 0, 0 ) ) );
	}
	trunk->setAngularVelocity( btVector3( 1, 0, 2 ) );
}

inline void bouncing( Scene& s )
{
	s.floor();
	s.objects[0]->setRestitution( 1 );
	for ( int k = 0; k < 5; ++k )
	{
		btRigidBody* ball = s.add( 1, s.shape( new btSphereShape( 0.3f ) ), at( btScalar( k ), 3, 0 ) );
		ball->setRestitution( btScalar( 0.2 ) * btScalar( k ) );
		ball->setRollingFriction( btScalar( 0.05 ) );
		ball->setAngularVelocity( btVector3( btScalar( k ), 0, 3 ) );
	}
}

struct Kind
{
	const char* name;
	void ( *build )( Scene& );
};

inline constexpr Kind kRigidKinds[] = { { "Stack", stack }, { "Ramp", ramp }, { "Chain", chain }, { "HingeMotor", hingeMotor },
	{ "Springs", springs }, { "Compounds", compounds }, { "Landscape", landscape }, { "Kinematic", kinematic }, { "Ghosts", ghosts },
	{ "Bullets", bullets }, { "Vehicle", vehicle }, { "Slider", slider }, { "Ragdoll", ragdoll }, { "Bouncing", bouncing } };

} // namespace pliant::test
