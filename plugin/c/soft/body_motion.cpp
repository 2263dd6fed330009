// Soft bodies are moved, pinned and released.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/body.h"

namespace pliant::c {

namespace {

pliant_result refuseNode()
{
	return refuse( PLIANT_BAD_ARGUMENT, "The body has no node of this index." );
}

/// Calls `work( SoftBody&, const btTransform& )`.
template <class F>
pliant_result withPose( pliant_world* world, pliant_id body, const pliant_pose* pose, F&& work )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		btTransform transform;
		if ( const pliant_result code = readPose( pose, transform ); code != PLIANT_OK )
		{
			return code;
		}
		return resultOf( work( soft, transform ) );
	} );
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_body_set_velocity( pliant_world* world, pliant_id body, pliant_vec3 linear, pliant_vec3 angular )
{
	return withSoft(
		world, body, [&]( SoftBody& soft ) { return resultOf( soft.setVelocities( vectorOf( linear ), vectorOf( angular ) ) ); } );
}

pliant_result pliant_body_apply_impulse( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 impulse )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const btVector3 push = vectorOf( impulse );
		return resultOf( node == -1 ? soft.applyCentralImpulse( push ) : soft.applyImpulse( push, node ) );
	} );
}

pliant_result pliant_body_apply_force( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 force )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const btVector3 push = vectorOf( force );
		return resultOf( node == -1 ? soft.applyCentralForce( push ) : soft.applyForce( push, node ) );
	} );
}

pliant_result pliant_body_set_gravity( pliant_world* world, pliant_id body, const pliant_vec3* gravity )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		if ( gravity )
		{
			return resultOf( soft.setGravity( vectorOf( *gravity ) ) );
		}
		soft.clearGravity();
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_body_teleport( pliant_world* world, pliant_id body, const pliant_pose* by )
{
	return withPose( world, body, by, []( SoftBody& soft, const btTransform& transform ) { return soft.teleport( transform ); } );
}

pliant_result pliant_body_reset( pliant_world* world, pliant_id body, const pliant_pose* pose )
{
	return withPose( world, body, pose, []( SoftBody& soft, const btTransform& transform ) { return soft.reset( transform ); } );
}

pliant_result pliant_body_set_scale( pliant_world* world, pliant_id body, double scale )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return resultOf( soft.setScale( btScalar( scale ) ) ); } );
}

pliant_result pliant_body_pin( pliant_world* world, pliant_id body, int32_t node )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return resultOf( soft.pinNode( node ) ); } );
}

pliant_result pliant_body_pin_to( pliant_world* world, pliant_id body, int32_t node, pliant_id rigid )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		return withRigid( world, rigid, [&]( btRigidBody& to ) { return resultOf( soft.pinNodeToBody( node, &to ) ); } );
	} );
}

pliant_result pliant_body_drive( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 position )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return resultOf( soft.driveNode( node, vectorOf( position ) ) ); } );
}

pliant_result pliant_body_release( pliant_world* world, pliant_id body, int32_t node )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		if ( node < 0 || node >= soft.nodeCount() )
		{
			return refuseNode();
		}
		soft.releaseNode( node );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_body_pin_inside( pliant_world* world, pliant_id body, pliant_vec3 low, pliant_vec3 high, int32_t* pinned )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const btVector3 from = vectorOf( low ), to = vectorOf( high );
		if ( !isNumber( from ) || !isNumber( to ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "A corner of the box is not finite." );
		}
		const int count = soft.pinNodesInside( from, to );
		pinned ? void( *pinned = count ) : void();
		return pliant_result( PLIANT_OK );
	} );
}
