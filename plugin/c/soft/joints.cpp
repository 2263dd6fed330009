// Attachments, and frames for joints.

#include "c/handles.h"
#include "c/numbers.h"
#include "c/settings.h"
#include "pliant/c/body.h"

namespace pliant::c {

namespace {

/// Calls `work( SoftBody&, btCollisionObject&, const AttachmentSettings& )`, which returns a Result<int>.
template <class F>
pliant_result attach(
	pliant_world* world, pliant_id body, pliant_id to, const pliant_attachment_settings* given, std::int32_t* made, F&& work )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		return withObject(
			world, to, [&]( btCollisionObject& other ) { return offer( work( soft, other, take<AttachmentSettings>( given ) ), made ); } );
	} );
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_attach_node(
	pliant_world* world, pliant_id body, int32_t node, pliant_id rigid, const pliant_attachment_settings* settings, int32_t* made )
{
	return attach( world, body, rigid, settings, made, [&]( SoftBody& soft, btCollisionObject& to, const AttachmentSettings& how ) {
		return world->host->attach( soft, node, to, how );
	} );
}

pliant_result pliant_attach_point(
	pliant_world* world, pliant_id body, pliant_vec3 point, pliant_id to, const pliant_attachment_settings* settings, int32_t* made )
{
	return attach( world, body, to, settings, made, [&]( SoftBody& soft, btCollisionObject& other, const AttachmentSettings& how ) {
		SoftBody* const otherSoft = SoftBody::upcast( &other );
		return otherSoft ? world->host->attach( soft, *otherSoft, vectorOf( point ), how )
						 : world->host->attach( soft, vectorOf( point ), other, how );
	} );
}

pliant_result pliant_weld(
	pliant_world* world, pliant_id body, pliant_id to, double distance, const pliant_attachment_settings* settings, int32_t* made )
{
	return attach( world, body, to, settings, made, [&]( SoftBody& soft, btCollisionObject& other, const AttachmentSettings& how ) {
		SoftBody* const otherSoft = SoftBody::upcast( &other );
		return otherSoft ? world->host->weld( soft, *otherSoft, btScalar( distance ), how )
						 : Result<int>::failure( ResultCode::BadArgument, "pliant_weld: the second object is no soft body." );
	} );
}

pliant_result pliant_detach( pliant_world* world, int32_t attachment )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		rejectIf( !host.detach( attachment ), PLIANT_NO_SUCH_OBJECT, "The world has no attachment of this number." );
	} );
}

pliant_result pliant_world_get_attachment_count( const pliant_world* world, int32_t* count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { give( std::int32_t( host.attachmentCount() ), count ); } );
}

pliant_result pliant_attachment_get_force( const pliant_world* world, int32_t attachment, pliant_vec3* force )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { give( vectorOf( host.attachmentForce( attachment ) ), force ); } );
}

pliant_result pliant_frame_create( pliant_world* world, pliant_id body, pliant_vec3 point, double radius, pliant_id* made )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requirePointers( made );
		const Result<btRigidBody*> frame = world->host->addFrame( soft, vectorOf( point ), btScalar( radius ) );
		if ( frame.ok() )
		{
			*made = identityOf( *world, frame.value );
		}
		return frame.status;
	} );
}

pliant_result pliant_frame_destroy( pliant_world* world, pliant_id frame )
{
	return withRigid( world, frame, [&]( btRigidBody& ) { destroyFrame( *world, frame ); } );
}

pliant_result pliant_frame_get_body( const pliant_world* world, pliant_id frame, pliant_id* body )
{
	return withRigid( world, frame, [&]( btRigidBody& rigid ) {
		const SoftBody* const owner = world->host->frameOwner( &rigid );
		give( owner ? identityOf( *owner ) : pliant_id( 0 ), body );
	} );
}
