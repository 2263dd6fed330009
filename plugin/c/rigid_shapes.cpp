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

#include <initializer_list>

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

/// Rejects settings that are out of range; returns the pose.
btTransform takeRigid( const pliant_rigid_settings& settings )
{
	const auto require = []( bool isGood, const char* sentence ) { rejectIf( !isGood, PLIANT_BAD_SETTINGS, sentence ); };
	const bool isDynamic = settings.kind == PLIANT_RIGID_DYNAMIC;
	require( isWithin( settings.kind, PLIANT_RIGID_DYNAMIC, PLIANT_RIGID_KINEMATIC ),
		"pliant_rigid_settings::kind must be one of PLIANT_RIGID_..." );
	require( !isDynamic || ( settings.mass > 0 && settings.mass <= kMostMass && float( settings.mass ) > 0 ),
		"pliant_rigid_settings::mass must be above 0 and at most 1e12 kg." );
	require( isWithin( settings.linear_velocity, kMostSpeed ) && isWithin( settings.angular_velocity, kMostSpeed ),
		"pliant_rigid_settings: velocities must be at most 1e5 along each axis." );
	require( isWithin( settings.friction, 0, kMostFriction ) && isWithin( settings.rolling_friction, 0, kMostFriction ),
		"pliant_rigid_settings: frictions must lie in 0 to 1e6." );
	require(
		isWithin( settings.restitution, 0, 1 ) && isWithin( settings.linear_damping, 0, 1 ) && isWithin( settings.angular_damping, 0, 1 ),
		"pliant_rigid_settings: restitution and dampings must lie in 0 to 1." );
	return takePose(
		settings.pose, PLIANT_BAD_SETTINGS, "pliant_rigid_settings::pose must be within 1e9 m, with a quaternion that is not zero." );
}

void setUp( btRigidBody& body, const pliant_rigid_settings& settings, const btTransform& pose )
{
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
pliant_id add( pliant_world& world, std::unique_ptr<RigidBody> made, const pliant_rigid_settings& settings, const btTransform& pose )
{
	const bool isDynamic = settings.kind == PLIANT_RIGID_DYNAMIC;
	btVector3 inertia( 0, 0, 0 );
	if ( isDynamic )
	{
		made->shape->calculateLocalInertia( btScalar( settings.mass ), inertia );
		rejectIf( !isNumber( inertia ) || inertia.x() <= 0 || inertia.y() <= 0 || inertia.z() <= 0, PLIANT_BAD_ARGUMENT,
			"The shape has no extent along an axis, or is too small or too large for its mass." );
	}
	const btScalar mass = isDynamic ? btScalar( settings.mass ) : btScalar( 0 );
	made->body = std::make_unique<btRigidBody>( btRigidBody::btRigidBodyConstructionInfo( mass, nullptr, made->shape.get(), inertia ) );
	btRigidBody& body = *made->body;
	setUp( body, settings, pose );
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
	return next;
}

void requireLengths( std::initializer_list<double> lengths )
{
	for ( const double length : lengths )
	{
		rejectIf( !( length > 0 && length <= kMostLength && float( length ) > 0 ), PLIANT_BAD_ARGUMENT,
			"Lengths of a shape must be above 0 and at most 1e6 m." );
	}
}

/// `makeShape`: gives the body its shape, for a kind PLIANT_RIGID_...
template <class F>
pliant_result create( pliant_world* world, std::int32_t kind, const pliant_rigid_settings* settings, pliant_id* id, F&& makeShape )
{
	return call( [&]() {
		requirePointers( world, id );
		pliant_rigid_settings full = defaultRigid( kind );
		readSized( settings, full );
		const btTransform pose = takeRigid( full );
		auto made = std::make_unique<RigidBody>();
		makeShape( *made, full.kind );
		*id = add( *world, std::move( made ), full, pose );
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

void requireKind( bool canBe )
{
	rejectIf( !canBe, PLIANT_BAD_SETTINGS, "A body of this shape cannot be of this kind: see pliant_rigid_settings::kind." );
}

void fillMesh( RigidBody& made, const float* positions, std::uint64_t vertices, const std::uint32_t* indices, std::uint64_t triangles )
{
	requirePointers( positions, indices );
	rejectIf( vertices == 0 || triangles == 0 || vertices > kMostElements || triangles > kMostElements, PLIANT_BAD_ARGUMENT,
		"A mesh must have 1 to 1e8 vertices and triangles." );
	rejectIf( !arePoints( positions, vertices ), PLIANT_BAD_ARGUMENT, "A vertex coordinate is not a number or beyond 1e6 m." );
	for ( std::uint64_t k = 0; k < 3 * triangles; ++k )
	{
		rejectIf( indices[k] >= vertices, PLIANT_INDEX_OUT_OF_RANGE, "A triangle refers to a vertex that does not exist." );
	}
	made.positions.assign( positions, positions + 3 * vertices );
	made.indices.assign( indices, indices + 3 * triangles );
	made.triangles = std::make_unique<btTriangleIndexVertexArray>( int( triangles ), made.indices.data(), int( 3 * sizeof( int ) ),
		int( vertices ), made.positions.data(), int( 3 * sizeof( btScalar ) ) );
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_rigid_settings_init( pliant_rigid_settings* settings, uint32_t size )
{
	return initSized( defaultRigid( PLIANT_RIGID_DYNAMIC ), settings, size );
}

pliant_result pliant_rigid_create_sphere( pliant_world* world, double radius, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_DYNAMIC, settings, made, [&]( RigidBody& rigid, std::int32_t ) {
		requireLengths( { radius } );
		rigid.shape = std::make_unique<btSphereShape>( btScalar( radius ) );
	} );
}

pliant_result pliant_rigid_create_box( pliant_world* world, pliant_vec3 half_edges, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_DYNAMIC, settings, made, [&]( RigidBody& rigid, std::int32_t ) {
		requireLengths( { half_edges.x, half_edges.y, half_edges.z } );
		rigid.shape = std::make_unique<btBoxShape>( vectorOf( half_edges ) );
	} );
}

pliant_result pliant_rigid_create_capsule(
	pliant_world* world, double radius, double height, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_DYNAMIC, settings, made, [&]( RigidBody& rigid, std::int32_t ) {
		requireLengths( { radius, height } );
		rigid.shape = std::make_unique<btCapsuleShape>( btScalar( radius ), btScalar( height ) );
	} );
}

pliant_result pliant_rigid_create_hull(
	pliant_world* world, const float* points, uint64_t count, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_DYNAMIC, settings, made, [&]( RigidBody& rigid, std::int32_t ) {
		requirePointers( points );
		rejectIf( count < 4 || count > kMostElements || !arePoints( points, count ), PLIANT_BAD_ARGUMENT,
			"A hull needs 4 to 1e8 points within 1e6 m." );
		auto hull = std::make_unique<btConvexHullShape>();
		for ( std::uint64_t k = 0; k < count; ++k )
		{
			hull->addPoint( btVector3( btScalar( points[3 * k] ), btScalar( points[3 * k + 1] ), btScalar( points[3 * k + 2] ) ), false );
		}
		hull->recalcLocalAabb();
		rigid.shape = std::move( hull );
	} );
}

pliant_result pliant_rigid_create_plane( pliant_world* world, pliant_vec3 normal, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_STATIC, settings, made, [&]( RigidBody& rigid, std::int32_t kind ) {
		const btVector3 direction = vectorOf( normal );
		rejectIf( !isNumber( direction ) || !isWithin( double( direction.length2() ), 1e-12, 1e12 ), PLIANT_BAD_ARGUMENT,
			"The normal of the plane must have a length between 1e-6 and 1e6." );
		requireKind( kind == PLIANT_RIGID_STATIC );
		rigid.shape = std::make_unique<btStaticPlaneShape>( direction.normalized(), btScalar( 0 ) );
	} );
}

pliant_result pliant_rigid_create_mesh( pliant_world* world, const float* positions, uint64_t vertex_count, const uint32_t* indices,
	uint64_t triangle_count, const pliant_rigid_settings* settings, pliant_id* made )
{
	return create( world, PLIANT_RIGID_STATIC, settings, made, [&]( RigidBody& rigid, std::int32_t kind ) {
		requireKind( kind != PLIANT_RIGID_DYNAMIC );
		fillMesh( rigid, positions, vertex_count, indices, triangle_count );
		rigid.shape = std::make_unique<btBvhTriangleMeshShape>( rigid.triangles.get(), true );
	} );
}
