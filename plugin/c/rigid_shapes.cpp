// Rigid bodies are made.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/rigid.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

namespace pliant::c {

namespace {

pliant_rigid_settings defaultRigid( std::int32_t kind )
{
	pliant_rigid_settings settings{};
	settings.kind = kind;
	settings.mass = 1;
	settings.pose = kOrigin;
	settings.friction = 0.5;
	return settings;
}

pliant_result refuseSettings( const char* sentence )
{
	return refuse( PLIANT_BAD_SETTINGS, sentence );
}

pliant_result checkRigid( const pliant_rigid_settings& settings )
{
	if ( settings.kind < PLIANT_RIGID_DYNAMIC || settings.kind > PLIANT_RIGID_KINEMATIC )
	{
		return refuseSettings( "pliant_rigid_settings::kind must be one of PLIANT_RIGID_..." );
	}
	if ( settings.kind == PLIANT_RIGID_DYNAMIC && !( settings.mass > 0 && settings.mass <= kMostMass && float( settings.mass ) > 0 ) )
	{
		return refuseSettings( "pliant_rigid_settings::mass must be above 0 and at most 1e12 kg." );
	}
	if ( !isWithin( settings.linear_velocity, kMostSpeed ) || !isWithin( settings.angular_velocity, kMostSpeed ) )
	{
		return refuseSettings( "pliant_rigid_settings: velocities must be at most 1e5 along each axis." );
	}
	if ( !isWithin( settings.friction, 0, kMostFriction ) || !isWithin( settings.rolling_friction, 0, kMostFriction ) )
	{
		return refuseSettings( "pliant_rigid_settings: frictions must lie in 0 to 1e6." );
	}
	if ( !isWithin( settings.restitution, 0, 1 ) || !isWithin( settings.linear_damping, 0, 1 ) ||
		!isWithin( settings.angular_damping, 0, 1 ) )
	{
		return refuseSettings( "pliant_rigid_settings: restitution and dampings must lie in 0 to 1." );
	}
	btTransform pose;
	return takePose( settings.pose, pose )
		? PLIANT_OK
		: refuseSettings( "pliant_rigid_settings::pose must be within 1e9 m, with a quaternion that is not zero." );
}

pliant_result takeRigid( const pliant_world* world, const pliant_rigid_settings* given, pliant_rigid_settings& full, const pliant_id* made )
{
	if ( !world || !made )
	{
		return refuseNull();
	}
	const pliant_result code = readSized( given, full );
	return code == PLIANT_OK ? checkRigid( full ) : code;
}

void setUp( btRigidBody& body, const pliant_rigid_settings& settings )
{
	btTransform pose;
	takePose( settings.pose, pose );
	body.setWorldTransform( pose );
	body.setInterpolationWorldTransform( pose );
	body.setFriction( btScalar( settings.friction ) );
	body.setRollingFriction( btScalar( settings.rolling_friction ) );
	body.setRestitution( btScalar( settings.restitution ) );
	body.setDamping( btScalar( settings.linear_damping ), btScalar( settings.angular_damping ) );
	if ( settings.kind == PLIANT_RIGID_DYNAMIC )
	{
		body.setLinearVelocity( vectorOf( settings.linear_velocity ) );
		body.setAngularVelocity( vectorOf( settings.angular_velocity ) );
		body.updateInertiaTensor();
	}
	if ( settings.kind == PLIANT_RIGID_KINEMATIC )
	{
		body.setCollisionFlags(
			( body.getCollisionFlags() & ~btCollisionObject::CF_STATIC_OBJECT ) | btCollisionObject::CF_KINEMATIC_OBJECT );
		body.setActivationState( DISABLE_DEACTIVATION ); // a sleeping one would not be seen to move
	}
}

// Takes a shape into a body, and that into the world.
pliant_result add( pliant_world& world, std::unique_ptr<RigidBody> made, const pliant_rigid_settings& settings, pliant_id* id )
{
	const bool isDynamic = settings.kind == PLIANT_RIGID_DYNAMIC;
	btVector3 inertia( 0, 0, 0 );
	if ( isDynamic )
	{
		made->shape->calculateLocalInertia( btScalar( settings.mass ), inertia );
		if ( !isNumber( inertia ) || inertia.x() <= 0 || inertia.y() <= 0 || inertia.z() <= 0 )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "The shape has no extent along an axis, or is too small or too large for its mass." );
		}
	}
	const btScalar mass = isDynamic ? btScalar( settings.mass ) : btScalar( 0 );
	made->body = std::make_unique<btRigidBody>( btRigidBody::btRigidBodyConstructionInfo( mass, nullptr, made->shape.get(), inertia ) );
	btRigidBody& body = *made->body;
	setUp( body, settings );
	const pliant_id next = world.lastOther + 2;
	world.idsOfOthers.reserve( world.idsOfOthers.size() + 1 );
	Other& other = world.others[next];
	other.object = &body;
	try
	{
		world.idsOfOthers.emplace( &body, next );
	}
	catch ( ... )
	{
		world.others.erase( next );
		throw;
	}
	other.made = std::move( made );
	world.lastOther = next;
	btDiscreteDynamicsWorld& bullet = world.host->bulletWorld();
	settings.group == 0 && settings.mask == 0 ? bullet.addRigidBody( &body ) : bullet.addRigidBody( &body, settings.group, settings.mask );
	*id = next;
	return PLIANT_OK;
}

bool isLength( double length )
{
	return length > 0 && length <= kMostLength && float( length ) > 0;
}

pliant_result refuseLength()
{
	return refuse( PLIANT_BAD_ARGUMENT, "Lengths of a shape must be above 0 and at most 1e6 m." );
}

/// `makeShape`: returns the shape, null where it is refused already.
template <class F>
pliant_result create( pliant_world* world, std::int32_t kind, const pliant_rigid_settings* settings, pliant_id* id, F&& makeShape )
{
	return call( [&]() -> pliant_result {
		pliant_rigid_settings full = defaultRigid( kind );
		if ( const pliant_result code = takeRigid( world, settings, full, id ); code != PLIANT_OK )
		{
			return code;
		}
		auto made = std::make_unique<RigidBody>();
		const pliant_result code = makeShape( *made, full.kind );
		return code == PLIANT_OK ? add( *world, std::move( made ), full, id ) : code;
	} );
}

bool arePoints( const float* points, std::uint64_t count )
{
	for ( std::uint64_t k = 0; k < 3 * count; ++k )
	{
		if ( !( std::fabs( points[k] ) <= float( kMostLength ) ) )
		{
			return false;
		}
	}
	return true;
}

pliant_result refuseMoving()
{
	return refuse( PLIANT_BAD_SETTINGS, "A body of this shape cannot be of this kind: see pliant_rigid_settings::kind." );
}

pliant_result fillMesh(
	RigidBody& made, const float* positions, std::uint64_t vertices, const std::uint32_t* indices, std::uint64_t triangles )
{
	if ( !positions || !indices )
	{
		return refuseNull();
	}
	if ( vertices == 0 || triangles == 0 || vertices > kMostElements || triangles > kMostElements )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "A mesh must have 1 to 1e8 vertices and triangles." );
	}
	if ( !arePoints( positions, vertices ) )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "A vertex coordinate is not a number or beyond 1e6 m." );
	}
	for ( std::uint64_t k = 0; k < 3 * triangles; ++k )
	{
		if ( indices[k] >= vertices )
		{
			return refuse( PLIANT_INDEX_OUT_OF_RANGE, "A triangle refers to a vertex that does not exist." );
		}
	}
	made.positions.assign( positions, positions + 3 * vertices );
	made.indices.assign( indices, indices + 3 * triangles );
	made.triangles = std::make_unique<btTriangleIndexVertexArray>( int( triangles ), made.indices.data(), int( 3 * sizeof( int ) ),
		int( vertices ), made.positions.data(), int( 3 * sizeof( btScalar ) ) );
	return PLIANT_OK;
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_rigid_settings_init( pliant_rigid_settings* settings, uint32_t size )
{
	return writeSized( defaultRigid( PLIANT_RIGID_DYNAMIC ), settings, size );
}

pliant_result pliant_rigid_create_sphere( pliant_world* world, double radius, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_DYNAMIC, settings, made, [&]( RigidBody& rigid, std::int32_t ) -> pliant_result {
		if ( !isLength( radius ) )
		{
			return refuseLength();
		}
		rigid.shape = std::make_unique<btSphereShape>( btScalar( radius ) );
		return PLIANT_OK;
	} );
}

pliant_result pliant_rigid_create_box( pliant_world* world, pliant_vec3 half_edges, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_DYNAMIC, settings, made, [&]( RigidBody& rigid, std::int32_t ) -> pliant_result {
		if ( !isLength( half_edges.x ) || !isLength( half_edges.y ) || !isLength( half_edges.z ) )
		{
			return refuseLength();
		}
		rigid.shape = std::make_unique<btBoxShape>( vectorOf( half_edges ) );
		return PLIANT_OK;
	} );
}

pliant_result pliant_rigid_create_capsule(
	pliant_world* world, double radius, double height, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_DYNAMIC, settings, made, [&]( RigidBody& rigid, std::int32_t ) -> pliant_result {
		if ( !isLength( radius ) || !isLength( height ) )
		{
			return refuseLength();
		}
		rigid.shape = std::make_unique<btCapsuleShape>( btScalar( radius ), btScalar( height ) );
		return PLIANT_OK;
	} );
}

pliant_result pliant_rigid_create_hull(
	pliant_world* world, const float* points, uint64_t count, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_DYNAMIC, settings, made, [&]( RigidBody& rigid, std::int32_t ) -> pliant_result {
		if ( !points )
		{
			return refuseNull();
		}
		if ( count < 4 || count > kMostElements || !arePoints( points, count ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "A hull needs 4 to 1e8 points within 1e6 m." );
		}
		auto hull = std::make_unique<btConvexHullShape>();
		for ( std::uint64_t k = 0; k < count; ++k )
		{
			hull->addPoint( btVector3( btScalar( points[3 * k] ), btScalar( points[3 * k + 1] ), btScalar( points[3 * k + 2] ) ), false );
		}
		hull->recalcLocalAabb();
		rigid.shape = std::move( hull );
		return PLIANT_OK;
	} );
}

pliant_result pliant_rigid_create_plane( pliant_world* world, pliant_vec3 normal, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_STATIC, settings, made, [&]( RigidBody& rigid, std::int32_t kind ) -> pliant_result {
		const btVector3 direction = vectorOf( normal );
		if ( !isNumber( direction ) || !isWithin( double( direction.length2() ), 1e-12, 1e12 ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "The normal of the plane must have a length between 1e-6 and 1e6." );
		}
		rigid.shape = std::make_unique<btStaticPlaneShape>( direction.normalized(), btScalar( 0 ) );
		return kind == PLIANT_RIGID_STATIC ? PLIANT_OK : refuseMoving();
	} );
}

pliant_result pliant_rigid_create_mesh( pliant_world* world, const float* positions, uint64_t vertex_count, const uint32_t* indices,
	uint64_t triangle_count, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_STATIC, settings, made, [&]( RigidBody& rigid, std::int32_t kind ) -> pliant_result {
		if ( kind == PLIANT_RIGID_DYNAMIC )
		{
			return refuseMoving();
		}
		const pliant_result code = fillMesh( rigid, positions, vertex_count, indices, triangle_count );
		if ( code == PLIANT_OK )
		{
			rigid.shape = std::make_unique<btBvhTriangleMeshShape>( rigid.triangles.get(), true );
		}
		return code;
	} );
}
