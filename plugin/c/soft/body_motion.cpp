// Soft bodies are moved, pinned and released.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/body.h"

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_body_set_velocity( pliant_world* world, pliant_id body, pliant_vec3 linear, pliant_vec3 angular )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return soft.setVelocities( vectorOf( linear ), vectorOf( angular ) ); } );
}

pliant_result pliant_body_apply_impulse( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 impulse )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const btVector3 push = vectorOf( impulse );
		return node == -1 ? soft.applyCentralImpulse( push ) : soft.applyImpulse( push, node );
	} );
}

pliant_result pliant_body_apply_force( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 force )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const btVector3 push = vectorOf( force );
		return node == -1 ? soft.applyCentralForce( push ) : soft.applyForce( push, node );
	} );
}

pliant_result pliant_body_set_gravity( pliant_world* world, pliant_id body, const pliant_vec3* gravity )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		if ( gravity )
		{
			return soft.setGravity( vectorOf( *gravity ) );
		}
		soft.clearGravity();
		return Status{};
	} );
}

pliant_result pliant_body_teleport( pliant_world* world, pliant_id body, const pliant_pose* by )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return soft.teleport( readPose( by ) ); } );
}

pliant_result pliant_body_reset( pliant_world* world, pliant_id body, const pliant_pose* pose )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return soft.reset( readPose( pose ) ); } );
}

pliant_result pliant_body_set_scale( pliant_world* world, pliant_id body, double scale )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return soft.setScale( btScalar( scale ) ); } );
}

pliant_result pliant_body_pin( pliant_world* world, pliant_id body, int32_t node )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return soft.pinNode( node ); } );
}

pliant_result pliant_body_pin_to( pliant_world* world, pliant_id body, int32_t node, pliant_id rigid )
{
	return withSoft( world, body,
		[&]( SoftBody& soft ) { return withRigid( world, rigid, [&]( btRigidBody& to ) { return soft.pinNodeToBody( node, &to ); } ); } );
}

pliant_result pliant_body_drive( pliant_world* world, pliant_id body, int32_t node, pliant_vec3 position )
{
	return withSoft( world, body, [&]( SoftBody& soft ) { return soft.driveNode( node, vectorOf( position ) ); } );
}

pliant_result pliant_body_release( pliant_world* world, pliant_id body, int32_t node )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requireNode( soft, node );
		soft.releaseNode( node );
	} );
}

pliant_result pliant_body_pin_inside( pliant_world* world, pliant_id body, pliant_vec3 low, pliant_vec3 high, int32_t* pinned )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		const btVector3 from = vectorOf( low ), to = vectorOf( high );
		rejectIf( !isNumber( from ) || !isNumber( to ), PLIANT_BAD_ARGUMENT, "A corner of the box is not finite." );
		offer( soft.pinNodesInside( from, to ), pinned );
	} );
}
